// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { traceOf } from './trace';

const every = (step_s: number, count: number) => Array.from({ length: count }, (_, i) => 1000 + i * step_s);
const breaks = (sclk: number[], rate_hz: number) =>
  traceOf({ name: 'x', sclk, value: sclk.map(() => 1) }, 1000, rate_hz).value.filter(Number.isNaN).length;

test('a trace is broken where samples are missing, and not where they come as rarely as promised', () => {
  expect(breaks(every(1, 100), 1)).toBe(0);
  expect(breaks([...every(1, 50), ...every(1, 50).map((at) => at + 80)], 1)).toBe(1);
  expect(breaks(every(30, 20), 1 / 30)).toBe(0);
  expect(breaks(every(30, 20), 1)).toBe(19);
});

test('the points of a run of six hours are one line', () => expect(breaks(every(21.6, 1000), 1)).toBe(0));

test('samples are by time from entry, of both sources in order, without the undefined ones', () => {
  const { e_s, value } = traceOf({ name: 'x', sclk: [1002, 1000, 1001], value: [3, 1, null] }, 1000, 1);
  expect([e_s, value]).toEqual([
    [0, 2],
    [1, 3],
  ]);
});
