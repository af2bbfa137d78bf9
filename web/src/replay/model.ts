// SPDX-License-Identifier: Apache-2.0
// A replay: the run's past played again at a pace. Every panel shows what had been heard by then and nothing later, or, where that is
// asked for, what had happened by then with all that the recording tells of it.
import { LAYOUT } from '../layout';
import { backToLive } from '../run/session';
import { pastRange, replay, store, withRecording } from '../run/shown';
import type { RunStore } from '../run/store';

const REPLAY_PACES = [1, 2, 5, 10, 20, 50] as const;

interface Bounds {
  from: number;
  to: number;
}

/** From where a replay can go to where: the run's beginning, and what has been seen of it. Seconds from entry. */
export function boundsOf(run: RunStore): Bounds {
  return { from: run.run.startSclk - run.entrySclk, to: run.seenE };
}

/** Where it is `seconds` later; it stops at the end. */
export function advanced(
  at_e_s: number,
  seconds: number,
  pace: number,
  end_e_s: number,
): { at: number; ended: boolean } {
  const at = Math.min(end_e_s, at_e_s + seconds * pace);
  return { at, ended: at >= end_e_s };
}

export function seek(to_e_s: number): void {
  const run = store.value;
  if (!run || !replay.value) return;
  const { from, to } = boundsOf(run);
  pastRange.value = { from, to: Math.min(to, Math.max(from, to_e_s)) };
}

/** Begins where the timeline of a landing begins, or at the beginning of the run. */
export function startReplay(): void {
  const run = store.value;
  if (!run) return;
  const { from, to } = boundsOf(run);
  replay.value = { pace: 10, playing: true };
  withRecording.value = false;
  seek(to > LAYOUT.window.from ? LAYOUT.window.from : from);
}

/** In any past view. */
export function toggleRecording(): void {
  if (pastRange.value) withRecording.value = !withRecording.value;
}

export function toggleReplay(): void {
  if (replay.value || pastRange.value) backToLive();
  else startReplay();
}

export function playOrHold(): void {
  const now = replay.value;
  const run = store.value;
  if (!now || !run || !pastRange.value) return;
  if (!now.playing && pastRange.value.to >= boundsOf(run).to) seek(LAYOUT.window.from);
  replay.value = { ...now, playing: !now.playing };
}

export function changeReplayPace(direction: 1 | -1): void {
  const now = replay.value;
  if (!now) return;
  const pace =
    direction > 0 ? REPLAY_PACES.find((each) => each > now.pace) : REPLAY_PACES.findLast((each) => each < now.pace);
  if (pace !== undefined) replay.value = { ...now, pace };
}

/** Called by the animation loop with the seconds since the last call. */
export function step(seconds: number): void {
  const now = replay.value;
  const run = store.value;
  if (!now?.playing || !run || !pastRange.value) return;
  const next = advanced(pastRange.value.to, seconds, now.pace, boundsOf(run).to);
  seek(next.at);
  if (next.ended) replay.value = { ...now, playing: false };
}
