// SPDX-License-Identifier: Apache-2.0
// Countdowns in words, the same in banner, phases and conditions.
import { fromEntry } from '../run/time';

/** Within half a second the words would be "in ≈ 0 s". */
export const DUE_S = 0.5;

/** "23 s", "1 m 20 s", "2 h 03 m": whole seconds, as a prediction deserves. */
export function roughly(seconds: number): string {
  const all = Math.max(0, Math.round(seconds));
  const two = (value: number) => String(value).padStart(2, '0');
  if (all < 60) return `${all} s`;
  if (all < 3600) return `${Math.floor(all / 60)} m ${two(all % 60)} s`;
  return `${Math.floor(all / 3600)} h ${two(Math.floor(all / 60) % 60)} m`;
}

/**
 * A countdown never counts to what is past. `now_e_s`: NaN where time stands still. `overdue`: the server's word;
 * undefined: it has not judged this one, so what is past is told with its time and nothing else.
 */
export function countdownWords(awaited: string, at_e_s: number, now_e_s: number, overdue: boolean | undefined): string {
  if (awaited === '') return '';
  if (overdue) return `${awaited} overdue since ${fromEntry(at_e_s)}`;
  if (Number.isNaN(now_e_s)) return `${awaited} predicted ${fromEntry(at_e_s)}`;
  const left = at_e_s - now_e_s;
  if (left >= DUE_S) return `${awaited} in ≈ ${roughly(left)}`;
  return overdue === undefined && left <= -DUE_S
    ? `${awaited} was predicted for ${fromEntry(at_e_s)}`
    : `${awaited} is due`;
}
