// SPDX-License-Identifier: Apache-2.0
// What the picture needs of the past. The page holds few points of a channel that is not plotted, and thins each
// channel by itself, so that the parts of an attitude would be of different instants. While the panel is shown it asks
// for whole samples: of what was heard live, over the run; of the recording, around the instant that is shown.
import { useEffect } from 'preact/hooks';
import { seriesPath } from '../recorded/model';
import { ask } from '../run/connection';
import { asHeard, dictionary, plottedChannels, runNow, store } from '../run/shown';
import type { RunStore } from '../run/store';
import { columnsOf } from '../stream/series_answer';
import type { SeriesAnswer } from '../stream/series_answer';
import { VEHICLE } from './layout';

const POINTS = 6000; // chosen: live navigation of 50 minutes
const WINDOW_S = 20; // of the recording: 64 samples a second, within the 2048 that such a channel may hold
const AT_ONCE = 8; // channels a question

/** The channels of which the picture is made, besides height and speed. */
export const NAMES: readonly string[] = [
  ...VEHICLE.attitude,
  ...VEHICLE.position,
  ...VEHICLE.velocity,
  ...VEHICLE.bank,
  ...VEHICLE.mode,
  ...VEHICLE.thrust,
  ...VEHICLE.throttles,
  ...VEHICLE.bridle,
  ...Object.values(VEHICLE.happenings).flatMap((each) => [
    ...('flag' in each ? [each.flag] : []),
    ...('pyros' in each ? each.pyros : []),
  ]),
];

/** Asks for samples of these channels; true once they are in the store. */
export async function fetchSamples(
  run: RunStore,
  names: readonly string[],
  from: number,
  to: number,
  live: boolean,
): Promise<void> {
  const drawn = plottedChannels();
  const wanted = names.filter((name) => dictionary.value?.pick([name]) && !drawn.includes(name));
  const parts = Array.from({ length: Math.ceil(wanted.length / AT_ONCE) }, (_, i) =>
    wanted.slice(i * AT_ONCE, (i + 1) * AT_ONCE),
  );
  for (const some of parts) {
    const list = await ask<SeriesAnswer[]>('series', seriesPath(run.id, some, from, to, POINTS, live));
    if (store.peek() !== run) return;
    for (const column of columnsOf(list)) run.addRange([column], from, Math.min(to, column.sclk.at(-1) ?? to));
  }
}

const asked = new WeakMap<RunStore, Set<string>>();

/** Once a run and stretch; a failed question may be asked again. */
export function once(run: RunStore, key: string, what: () => Promise<void>): void {
  const known = asked.get(run) ?? new Set();
  asked.set(run, known);
  if (known.has(key)) return;
  known.add(key);
  what().catch(() => known.delete(key)); // the header says that there is no connection
}

/** Whether the parts of attitude and position are of different instants: thinned channel by channel. */
export function isTorn(run: RunStore): boolean {
  const all = [...VEHICLE.attitude, ...VEHICLE.position].map((name) => {
    const channel = dictionary.value?.pick([name]);
    return channel && run.live.get(channel.id);
  });
  const first = all[0];
  return all.some(
    (each) =>
      each?.length !== first?.length ||
      LOOKED_AT.some((part) => each?.sclk[index(each, part)] !== first?.sclk[index(first, part)]),
  );
}
const LOOKED_AT = [0.5, 0.7, 0.9, 0.97];
const index = (series: { length: number } | undefined, part: number) => Math.floor((series?.length ?? 0) * part);

const AGAIN_MS = 2000; // chosen: the page's own history may come later and thin it anew; not more often than this
let lastLive_ms = -Infinity;

/** For the view: keeps what is shown at `sclk` in the store. `past`: the instant is not the newest of a running run. */
export function useHistory(sclk: number, past: boolean): void {
  const run = runNow() && store.value;
  const part = Math.floor(sclk / WINDOW_S);
  const heard = asHeard.value;
  useEffect(() => {
    const now_ms = performance.now();
    if (!run || now_ms - lastLive_ms < AGAIN_MS || !isTorn(run)) return;
    lastLive_ms = now_ms;
    void fetchSamples(run, NAMES, run.run.startSclk, run.seenSclk, true).catch(() => undefined); // asked again
  });
  useEffect(() => {
    if (!run || !past || heard || !Number.isFinite(part)) return;
    for (const each of [part - 1, part, part + 1])
      once(run, `recorded ${each}`, () => fetchSamples(run, NAMES, each * WINDOW_S, (each + 1) * WINDOW_S, false));
  }, [run, past, heard, part]);
}
