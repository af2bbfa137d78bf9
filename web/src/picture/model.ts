// SPDX-License-Identifier: Apache-2.0
// The picture that the page shows, as a link: its address follows what is shown, and an address opens the same.
import { effect } from '@preact/signals';
import { showView, viewNow } from '../places/model';
import { boundsOf } from '../replay/model';
import { opened, queryOf } from '../run/address';
import type { Picture } from '../run/address';
import { cursor } from '../run/cursor';
import { stream } from '../run/connection';
import { asked, dictionary, laidOver, lookAtPast, notify, pastRange, replay, store, withRecording } from '../run/shown';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { choice, look, zoomedTo } from '../run/window';

const { panel } = opened.picture;

function spanShown(): Picture['span'] {
  const [past, zoomed] = [pastRange.value, zoomedTo()];
  if (past && !replay.value) return zoomed && (zoomed.from !== past.from || zoomed.to !== past.to) ? zoomed : undefined;
  return choice.value === 'landing' ? undefined : choice.value;
}

/** What is shown, but for the cursor. `run`: its number, 0 where the address names none. */
function shown(run: number): Picture {
  const past = pastRange.value;
  return {
    ...viewNow(),
    panel,
    run,
    past: past && { ...past, recorded: withRecording.value },
    span: spanShown(),
    over: laidOver.value,
  };
}

/** All of what is shown. A run that goes on is named too: a link is about one run. */
export const pictureNow = (): Picture => ({ ...shown(store.value?.id ?? 0), cursor: cursor.value });

export function linkNow(): string {
  const { origin, pathname } = location;
  return `${origin}${pathname}?${queryOf(pictureNow())}`;
}

/** What of a picture a run does not have: instants before its beginning, or that have not come. */
export function timesMissing(run: RunStore, { past, cursor: at }: Picture): { past?: string; cursor?: string } {
  const { from, to } = boundsOf(run);
  const begin = from - run.run.lightTimeS;
  const words = run.entryKnown
    ? `run ${run.id} is known from ${fromEntry(begin)} to ${fromEntry(to)}`
    : `the time of entry of run ${run.id} is not known`;
  const isOutside = (first: number, last: number) => !run.entryKnown || last < begin || first > to;
  return {
    ...(past &&
      isOutside(past.from, past.to) && {
        past: `${fromEntry(past.from)} to ${fromEntry(past.to)} is not shown: ${words}`,
      }),
    ...(at !== undefined && isOutside(at, at) && { cursor: `${fromEntry(at)} is not shown: ${words}` }),
  };
}

function showTimes({ past, span, cursor: at }: Picture): void {
  if (past) lookAtPast({ from: past.from, to: past.to }, past.recorded);
  const stretch = typeof span === 'object' ? span : past;
  if (stretch)
    look(stretch.from, stretch.to); // asks for the archive's detail
  else if (typeof span === 'string') choice.value = span;
  if (at !== undefined) cursor.value = at;
}

/** Takes back what the run does not have, and says so. */
function takeBackTimes(run: RunStore, picture: Picture): void {
  const missing = timesMissing(run, picture);
  if (missing.past) pastRange.value = undefined;
  if (missing.cursor) cursor.value = undefined;
  for (const words of Object.values(missing)) notify(words);
}

/** Shows the picture that the page was opened with, as far as it can be shown; a line says what cannot. */
export function openPicture({ picture, problems } = opened): void {
  once(
    () => dictionary.value,
    () => {
      for (const words of [...problems, ...showView(picture)]) notify(words);
    },
  );
  once(
    () => store.value,
    (run) => {
      if (picture.run !== 0 && picture.run !== run.id) return; // the notice of a run that is not there says so
      showTimes(picture);
      once(
        () => stream.value.state === 'live' || undefined, // all of the run is here
        () => {
          if (store.value === run) takeBackTimes(run, picture);
        },
      );
    },
  );
}

/** Acts once on the first value. */
function once<T>(value: () => T | undefined, act: (value: T) => void): void {
  const stop = effect(() => {
    const found = value();
    if (found === undefined) return;
    queueMicrotask(() => {
      stop();
      act(found);
    });
  });
}

const WRITE_MS = 300; // chosen: a browser refuses an address that changes with every step of a zoom

/** Lets the address follow what is shown, but for the cursor. A run that is followed as the current one is not named. */
export function keepAddress(): void {
  let waiting: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    if (!store.value || replay.value?.playing) return; // what was asked for stands until it is shown; a replay moves on
    const query = queryOf(shown(asked.value || (pastRange.value ? store.value.id : 0)));
    clearTimeout(waiting);
    waiting = setTimeout(
      () => history.replaceState(null, '', query === '' ? location.pathname : `?${query}`),
      WRITE_MS,
    );
  });
}
