// SPDX-License-Identifier: Apache-2.0
// A channel's samples of another run as a line by time from entry.
import { GAP_PERIODS, gapOf } from './model';

/** Asked for of a channel; chosen: more than a plot has pixels. */
export const POINTS = 1000;

/** Samples by time from entry; NaN breaks the line. */
export interface Trace {
  e_s: number[];
  value: number[];
}
export interface Series {
  name: string;
  sclk?: number[];
  value?: (number | string | null)[];
}

/**
 * The samples of both sources in the order of time, without those that are undefined. A time without any is a gap when
 * it is longer than the channel's rate lets expect, or the distance between the points of a run that has more.
 */
export function traceOf({ sclk = [], value = [] }: Series, entry_sclk: number, expected_rate_hz: number): Trace {
  const all = sclk
    .map((at, i) => [at - entry_sclk, value[i]] as const)
    .filter((each): each is readonly [number, number] => typeof each[1] === 'number')
    .sort(([one], [other]) => one - other);
  const [first = 0, last = 0] = [all[0]?.[0], all.at(-1)?.[0]];
  const spacing_s = all.length > POINTS / 2 ? (last - first) / (POINTS / 2) : 0; // least and largest of each stretch
  const gap_s = Math.max(gapOf(expected_rate_hz), GAP_PERIODS * spacing_s);
  const trace: Trace = { e_s: [], value: [] };
  for (const [at, now] of all) {
    if (at - (trace.e_s.at(-1) ?? at) > gap_s) {
      trace.e_s.push(at);
      trace.value.push(NaN);
    }
    trace.e_s.push(at);
    trace.value.push(now);
  }
  return trace;
}
