import { describe, expect, it } from 'vitest';
import { aDictionary, aPlan, aRun, aStore, samples, tone } from '../testing/fixtures';
import { phaseSteps } from './model';

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
    const store = aStore([samples(700, { 1: 0, 2: 1, 5: 1 }), tone({ sclk: 1255, tone: 41, name: 'parachute_deploy' })], aRun({ clocks: undefined as never, startSclk: 1300 }));
    const steps = phaseSteps(store, aDictionary, plan, Infinity);
    expect(steps.find((step) => step.state === 'now')).toMatchObject({ title: 'Parachute', detail: '■ by tone', since_e_s: 255 });
  });
  it('claims no phase before the vehicle has spoken', () => {
    expect(phaseSteps(aStore(), aDictionary, aPlan, Infinity).every((step) => step.state === 'ahead')).toBe(true);
  });
});
