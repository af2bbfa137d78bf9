// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  FIGURES,
  assumed,
  basisWords,
  eventName,
  laterBy,
  partText,
  stateText,
  timeIn,
  valuesText,
} from './what_if_model';
import type { Forecast } from './what_if_model';

const forecast = (more: Partial<Forecast>): Forecast => ({
  run: '7',
  forecast: '1',
  state: 'queued',
  at_e_s: 190,
  request: {},
  asked: '2026-11-28T03:00:00Z',
  ...more,
});

describe('a difference between two runs', () => {
  it('says by how much an event came later, or in which run it did not come', () => {
    expect(laterBy({ name: 'a', occurrence: 1, e_s: 100.5, other_e_s: 100 })).toBe('+0.50 s');
    expect(laterBy({ name: 'a', occurrence: 1, e_s: 100, other_e_s: 102 })).toBe('−2.00 s');
    expect(laterBy({ name: 'a', occurrence: 1, e_s: 100, other_e_s: 100 })).toBe('other words');
    expect(laterBy({ name: 'a', occurrence: 1, e_s: 100 })).toBe('');
    expect([timeIn(100.5), timeIn(undefined)]).toEqual(['E+1:40.5', 'not in it']);
    expect([eventName({ name: 'a', occurrence: 1 }), eventName({ name: 'a', occurrence: 2 })]).toEqual(['a', 'a (2)']);
  });
});

describe('a forecast', () => {
  it('says from what it is flown: the truth, what ground heard and when, or its solution alone', () => {
    const side = { cases: 1, within_limits: { part: 1, of: 1, low_99: 0.01, high_99: 1 } };
    expect(
      [
        { from: 'truth' as const },
        { from: 'telemetry' as const, heard_e_s: 298.5 },
        { from: 'telemetry' as const },
      ].map((result) => basisWords({ ...result, without: side, apart_e_s: 0 })),
    ).toEqual([
      'from the truth',
      'from what ground heard, last at E+4:58.5',
      'from ground’s solution alone: nothing was heard of where it is',
    ]);
  });
  it('gives a part of cases with its confidence, never as certain', () => {
    expect(partText({ part: 32, of: 32, low_99: 0.847, high_99: 1 })).toBe('32 of 32 (85 … 100 %)');
  });
  it('gives median, least and most of a figure in its unit, and says nothing of cases that have none', () => {
    const [miss] = FIGURES;
    expect(valuesText({ count: 3, least: 500, median: 1200, most: 9000 }, miss)).toBe('1.20 (0.50 … 9.00)');
    expect([valuesText({ count: 0 }, miss), valuesText(undefined, miss)]).toEqual(['—', '—']);
  });
  it('says what it assumes', () => {
    expect(assumed(forecast({}), () => '')).toBe('nothing');
    const request = { commands: [{ command: 'DO_EDL' }], faults: [{ computer_reset: true }] };
    expect(assumed(forecast({ request }), () => 'a reset')).toBe('DO_EDL, a reset');
  });
  it('says how far it is, and why it came to nothing', () => {
    expect(stateText(forecast({}))).toBe('waits for its turn');
    expect(stateText(forecast({ state: 'flying' }))).toBe('flies the run again up to there');
    expect(
      stateText(
        forecast({
          state: 'flying',
          done: '12',
          of: '64',
          without: '6',
          within_without: '6',
          with: '6',
          within_with: '5',
        }),
      ),
    ).toBe('12 of 64 flown; within limits 6 of 6, with it 5 of 6');
    expect(stateText(forecast({ state: 'failed', reason: 'DO_EDL is refused' }))).toBe('✖ DO_EDL is refused');
    expect(stateText(forecast({ state: 'abandoned' }))).toBe('the server ended before it was ready');
  });
});
