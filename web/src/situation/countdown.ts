// SPDX-License-Identifier: Apache-2.0
// Countdowns in words, the same in banner, phases and conditions.
import { fromEntry } from '../run/time';

/** "23 s", "1 m 20 s", "2 h 03 m": whole seconds, as a prediction deserves. */
export function roughly(seconds: number): string {
  const all = Math.max(0, Math.round(seconds));
  const two = (value: number) => String(value).padStart(2, '0');
  if (all < 60) return `${all} s`;
  if (all < 3600) return `${Math.floor(all / 60)} m ${two(all % 60)} s`;
  return `${Math.floor(all / 3600)} h ${two(Math.floor(all / 60) % 60)} m`;
}

/** A countdown never counts to what is past. `now_e_s`: NaN where time stands still. */
export function countdownWords(awaited: string, at_e_s: number, now_e_s: number, overdue: boolean): string {
  if (awaited === '') return '';
  if (overdue) return `${awaited} overdue since ${fromEntry(at_e_s)}`;
  if (Number.isNaN(now_e_s)) return `${awaited} predicted ${fromEntry(at_e_s)}`;
  const left = at_e_s - now_e_s;
  return left >= 0.5 ? `${awaited} in ≈ ${roughly(left)}` : `${awaited} is due`;
}
