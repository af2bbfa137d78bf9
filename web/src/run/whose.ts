// SPDX-License-Identifier: Apache-2.0
// The owner of a value: after touchdown some channels belong to the descent stage. The screen says so, or it would
// contradict itself.
import { LAYOUT } from '../layout';
import type { RunStore } from './store';

/** SCLK of touchdown as the vehicle reported it; Infinity before. */
export function landedSclk(run: RunStore | undefined): number {
  for (const pair of run?.firings.values() ?? []) {
    if (pair.name === LAYOUT.landed) return (pair.live ?? pair.recorded)?.firedSclk ?? Infinity;
  }
  return Infinity;
}

/** The owner of the value of `channel` at `sclk`; undefined: the whole vehicle. */
export function whoseAt(run: RunStore | undefined, channel: string, sclk: number): string | undefined {
  return (LAYOUT.afterLanding.channels as readonly string[]).includes(channel) && sclk > landedSclk(run)
    ? LAYOUT.afterLanding.whose
    : undefined;
}
