// SPDX-License-Identifier: Apache-2.0
// The instant that is pointed at, one for plots, tones and timeline. By mouse where it is drawn, by key anywhere.
import { effect, signal } from '@preact/signals';
import { cutoff, shownRun, store } from './shown';
import { plotSpan } from './window';

/** Seconds from entry; undefined: none. */
export const cursor = signal<number | undefined>(undefined);

// Of another run it is another instant.
effect(() => {
  void store.value;
  cursor.value = undefined;
});

const STEPS = 100; // ours: a held key crosses what is shown in a few seconds

/** From nothing it begins at the newest that is shown. */
export function stepCursor(direction: 1 | -1): void {
  const run = shownRun();
  if (!run) return;
  const { from, to } = plotSpan(run);
  const newest = Math.min(to, run.seenE, cutoff.value - run.entrySclk);
  cursor.value = Math.max(from, Math.min(newest, (cursor.value ?? newest) + (direction * (to - from)) / STEPS));
}

export function closeCursor(): boolean {
  const open = cursor.value !== undefined;
  cursor.value = undefined;
  return open;
}
