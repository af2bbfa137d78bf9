// SPDX-License-Identifier: Apache-2.0
// Once the rover stands on the ground, some channels are of the other half of the vehicle. The screen says so, or it would contradict itself.
import { LAYOUT } from '../layout';
import type { RunStore } from './store';

/** SCLK of touchdown, as the vehicle told it; Infinity before. */
export function landedSclk(run: RunStore | undefined): number {
  for (const pair of run?.firings.values() ?? []) {
    if (pair.name === LAYOUT.landed) return (pair.live ?? pair.recorded)?.firedSclk ?? Infinity;
  }
  return Infinity;
}

/** Whose value of `channel` that at `sclk` is; undefined: the vehicle's. */
export function whoseAt(run: RunStore | undefined, channel: string, sclk: number): string | undefined {
  return (LAYOUT.afterLanding.channels as readonly string[]).includes(channel) && sclk > landedSclk(run)
    ? LAYOUT.afterLanding.whose
    : undefined;
}
