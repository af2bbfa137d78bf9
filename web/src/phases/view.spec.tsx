// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { aDictionary, aPlan, aRun, aStore, samples, tone } from '../testing/fixtures';
import { create } from '@bufbuild/protobuf';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { predictForTest } from '../prediction/model';
import { nextWords, phaseSteps } from './model';

describe('the strip of phases', () => {
  it('follows what the vehicle said last', () => {
    const store = aStore([samples(700, { 1: 0, 2: 1, 5: 1 }), samples(800, { 1: 4, 2: 1, 5: 1 })]);
    const steps = phaseSteps(store, aDictionary, aPlan, Infinity);
    expect(steps.slice(0, 3).map((step) => step.state)).toEqual(['done', 'now', 'ahead']);
    expect(steps[1]).toMatchObject({ title: 'Entry', detail: 'range control', since_e_s: -200 });
    expect(phaseSteps(store, aDictionary, aPlan, 750)[0]?.state).toBe('now');
  });
  it('goes on by tone where UHF is silent, says so, and is not held back by an older word of UHF', () => {
    const plan = aPlan.map((row) => ({ ...row, tone: row.name }));
    const store = aStore(
      [samples(700, { 1: 0, 2: 1, 5: 1 }), tone({ sclk: 1255, tone: 41, name: 'parachute_deploy' })],
      aRun({ clocks: undefined as never, startSclk: 1300 }),
    );
    const steps = phaseSteps(store, aDictionary, plan, Infinity);
    expect(steps.find((step) => step.state === 'now')).toMatchObject({
      title: 'Parachute',
      detail: '■ by tone',
      since_e_s: 255,
    });
  });
  it('is predicted as timeline and “waiting for” are, so that what a command moved is moved here, too; without a plan as the nominal flight has it', () => {
    const store = aStore([samples(1000, { 1: 4 })], aRun({ clocks: undefined as never, startSclk: 1100 }));
    const steps = (...predicted: [name: string, e_s: number][]) =>
      phaseSteps(
        store,
        aDictionary,
        aPlan,
        Infinity,
        predicted.map(([name, e_s], id) => ({ id, name, e_s, fired: false })),
      );
    expect(steps().map((step) => step.predicted_e_s)).toEqual(Array(5).fill(undefined));
    const events = Object.entries({
      entry_interface: 0,
      parachute_deploy: 255,
      powered_approach: 378,
      touchdown: 431.5,
    });
    predictForTest(
      create(PredictionSchema, { state: 'ready', events: events.map(([name, eS]) => ({ name, eS, timepoint: true })) }),
    );
    expect(steps().map((step) => step.predicted_e_s)).toEqual([undefined, 0, 255, 378, 431.5]);
    const moved = steps(['parachute_deploy', 400], ['powered_approach', 522]);
    expect(moved.map((step) => step.predicted_e_s)).toEqual([undefined, 0, 400, 522, 431.5]);
    expect(moved[1]?.part, 'of what is going on').toBeCloseTo(0.25);
    expect([100, 400, 400.4, 405].map((seen_e_s) => nextWords(moved, seen_e_s))).toEqual([
      'parachute in ≈ 5 m 00 s',
      'parachute is due',
      'parachute is due',
      'parachute was predicted for E+6:40',
    ]);
    const judged = (overdue: boolean) => moved.map((step) => ({ ...step, overdue }));
    expect(
      [false, true].map((overdue) => nextWords(judged(overdue), 405)),
      'as the server says',
    ).toEqual(['parachute is due', 'parachute overdue since E+6:40']);
    expect(nextWords(moved, NaN), 'while the clock stands still').toBe('parachute predicted E+6:40');
  });
  it('claims no phase before the vehicle has spoken', () => {
    expect(phaseSteps(aStore(), aDictionary, aPlan, Infinity).every((step) => step.state === 'ahead')).toBe(true);
  });
});
