// SPDX-License-Identifier: Apache-2.0
// A replay: the run's past played again at a pace. Every panel shows only what had been heard by then or, on request,
// what had happened by then by the recording.
import { LAYOUT } from '../layout';
import { backToLive } from '../run/session';
import { pastRange, replay, store, withRecording } from '../run/shown';
import type { RunStore } from '../run/store';

const REPLAY_PACES = [1, 2, 5, 10, 20, 50] as const;

interface Bounds {
  from: number;
  to: number;
}

/** The limits of a replay in seconds from entry: the beginning of the run and the newest reception. */
export function boundsOf(run: RunStore): Bounds {
  return { from: run.run.startSclk - run.entrySclk, to: run.seenE };
}

/** The position `seconds` later; it stops at the end. */
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

/** Begins a replay at the start of the landing's timeline, or at the beginning of the run. */
export function startReplay(): void {
  const run = store.value;
  if (!run) return;
  const { from, to } = boundsOf(run);
  replay.value = { pace: 10, playing: true };
  withRecording.value = false;
  seek(to > LAYOUT.window.from ? LAYOUT.window.from : from);
}

/** Switches the reading of any past view. */
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

/** Advances the replay; the animation loop calls it with the seconds since the last call. */
export function step(seconds: number): void {
  const now = replay.value;
  const run = store.value;
  if (!now?.playing || !run || !pastRange.value) return;
  const next = advanced(pastRange.value.to, seconds, now.pace, boundsOf(run).to);
  seek(next.at);
  if (next.ended) replay.value = { ...now, playing: false };
}
