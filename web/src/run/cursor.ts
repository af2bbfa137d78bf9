// SPDX-License-Identifier: Apache-2.0
// The instant pointed at, shared by plots, tones and timeline; by mouse where it is drawn, by key anywhere.
import { effect, signal } from '@preact/signals';
import { isPredicted } from '../prediction/model';
import { cutoff, shownRun, store } from './shown';
import { plotSpan } from './window';

/** Seconds from entry; undefined: none. */
export const cursor = signal<number | undefined>(undefined);

// In another run it would be another instant.
effect(() => {
  void store.value;
  cursor.value = undefined;
});

const STEPS = 100; // chosen: a held key crosses the shown range in a few seconds

/** Without a cursor it starts at the newest instant shown. */
export function stepCursor(direction: 1 | -1): void {
  const run = shownRun();
  if (!run) return;
  const { from, to } = plotSpan(run, isPredicted());
  const newest = Math.min(to, run.seenE, cutoff.value - run.entrySclk);
  const last = isPredicted() ? to : newest;
  cursor.value = Math.max(from, Math.min(last, (cursor.value ?? newest) + (direction * (to - from)) / STEPS));
}

export function closeCursor(): boolean {
  const open = cursor.value !== undefined;
  cursor.value = undefined;
  return open;
}
