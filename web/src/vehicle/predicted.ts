// SPDX-License-Identifier: Apache-2.0
// The vehicle as it is predicted: the samples of the nominal flight, read as telemetry is.
import { LAYOUT } from '../layout';
import { isPredicted, predictedEvent, predictedSeries, predictedVersion } from '../prediction/model';
import { RunStore } from '../run/store';
import { NAMES } from './history';
import { pathOf } from './model';
import type { Look } from './model';

let kept: { key: string; run: RunStore } | undefined;

/** SCLK of the touchdown in the nominal flight; before everything where there is none. */
export const predictedTouchdown = ({ run }: Look): number =>
  run.entrySclk + (predictedEvent(LAYOUT.landed) ?? -Infinity);

/** What would be seen now if the landing went as predicted; undefined where nothing is, and after the touchdown. */
export function predictedLook(look: Look): Look | undefined {
  const cutoff = Math.min(look.run.seenSclk, look.cutoff);
  if (!isPredicted() || cutoff > predictedTouchdown(look)) return undefined;
  const channels = [...NAMES, ...LAYOUT.altitude, ...LAYOUT.speed].flatMap((name) => look.words.pick([name]) ?? []);
  const series = channels.map((channel) => predictedSeries(channel)); // asks for what is missing
  const key = `${look.run.id} ${predictedVersion.value}`;
  if (kept?.key !== key) {
    kept = { key, run: new RunStore(look.run.run) };
    for (const [i, channel] of channels.entries()) {
      const each = series[i];
      if (each) kept.run.live.set(channel.id, each);
    }
  }
  return { run: kept.run, words: look.words, plan: [], cutoff, lost: false };
}

let path: { of: RunStore; points: ReturnType<typeof pathOf> } | undefined;

/** The whole path that is predicted, computed once: it stays while the vehicle moves along it. */
export function predictedPath(look: Look, expected: Look): ReturnType<typeof pathOf> {
  if (path?.of !== expected.run)
    path = { of: expected.run, points: pathOf({ ...expected, cutoff: predictedTouchdown(look) }) };
  return path.points;
}
