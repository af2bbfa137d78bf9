// SPDX-License-Identifier: Apache-2.0
// The mode of the page and its words. It combines how the run is viewed (live, replay, fixed range, after its end) with
// where it happens, so that a rehearsal is never taken for a real landing.
import type { NamedRun } from '../stream/names';
import { fromEntry } from '../run/time';

export type Mode = 'none' | 'live' | 'rehearsal' | 'ended' | 'range' | 'replay';

interface ModeWords {
  badge: string; // in the header
  mark: string; // in each panel
  shape: string;
  words: string; // its meaning, for the tooltip
}

export const MODES: Record<Mode, ModeWords> = {
  none: { badge: 'NO RUN', mark: 'no run', shape: '○', words: 'no run is shown' },
  live: { badge: 'LIVE', mark: 'live', shape: '●', words: 'a real vehicle, as it is heard now' },
  rehearsal: { badge: 'REHEARSAL', mark: 'rehearsal', shape: '◪', words: 'a simulated vehicle, as it is heard now' },
  ended: { badge: 'ENDED RUN', mark: 'ended', shape: '■', words: 'a run that is over, with all that is known of it' },
  range: {
    badge: 'PAST, NOT LIVE',
    mark: 'past',
    shape: '◧',
    words: 'a fixed range of the past; nothing here is live',
  },
  replay: {
    badge: 'REPLAY, NOT LIVE',
    mark: 'replay',
    shape: '↻',
    words: 'the past, played again at a pace; nothing here is live',
  },
};

/** Only a run that follows a real downlink is real; every other venue is a rehearsal. */
export function isReal(run: NamedRun): boolean {
  return run.venue === 'downlink';
}

/** Whether the server can continue a cut-off run. A real landing goes on without it. */
export function canContinue(run: NamedRun): boolean {
  return run.state === 'interrupted' && !isReal(run);
}

export function modeOf(store: { run: NamedRun; going: boolean } | undefined, past: boolean, replayed: boolean): Mode {
  if (!store) return 'none';
  if (replayed) return 'replay';
  if (past) return 'range';
  if (!store.going) return 'ended';
  return isReal(store.run) ? 'live' : 'rehearsal';
}

/** The mark in each panel. For the past of a rehearsal it has both words, so that neither can be missed. */
export function panelMark(mode: Mode, run: NamedRun | undefined): string {
  const { mark } = MODES[mode];
  if (!run || mode === 'rehearsal' || mode === 'live' || mode === 'none') return mark;
  return isReal(run) ? `${mark}, real venue` : `${mark}, rehearsal`;
}

/** The notice after a break: its beginning, the items filled in, and whether the run went on meanwhile. */
export function resumedWords(
  break_: { after: number; through: number; attempts: number },
  run: NamedRun,
  lost_e_s: number,
): string {
  const count = break_.through - break_.after;
  const filled =
    count > 0
      ? `numbers ${break_.after + 1} to ${break_.through}, which came meanwhile, were filled in from the archive, none is missing`
      : 'nothing had come meanwhile';
  const begin = `The connection was lost at ${fromEntry(lost_e_s)} and is back at attempt ${break_.attempts}: ${filled}.`;
  if (run.state !== 'interrupted') return begin;
  const cutOff = `${begin} The server had stopped and was started again: this run was cut off at number ${break_.through}`;
  return canContinue(run)
    ? `${cutOff}; continue it under Runs, or start another.`
    : `${cutOff}, and cannot be continued: what is followed after it is another run.`;
}
