// SPDX-License-Identifier: Apache-2.0
// Which of the modes the page is in, and what it says of it. Two things are told apart: how the run is looked at (now, a
// replay, a fixed range, after its end), and where it happens (a rehearsal can never be taken for the real thing).
import type { RunState } from '../gen/aeolis/v1/run_pb';
import { fromEntry } from '../run/time';

export type Mode = 'none' | 'live' | 'rehearsal' | 'ended' | 'range' | 'replay';

interface ModeWords {
  badge: string; // in the header
  mark: string; // in each panel
  shape: string;
  words: string; // what it means, for who asks
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

/** Only what follows a real downlink is the real thing; whatever else a venue is called is a rehearsal. */
export function isReal(run: RunState): boolean {
  return run.venue === 'downlink';
}

/** The server flies a rehearsal that was cut off again as far as it had come; a real landing goes on without us. */
export function canContinue(run: RunState): boolean {
  return run.state === 'interrupted' && !isReal(run);
}

export function modeOf(store: { run: RunState; going: boolean } | undefined, past: boolean, replayed: boolean): Mode {
  if (!store) return 'none';
  if (replayed) return 'replay';
  if (past) return 'range';
  if (!store.going) return 'ended';
  return isReal(store.run) ? 'live' : 'rehearsal';
}

/** What each panel carries: of a rehearsal's past both words, so that neither can be missed. */
export function panelMark(mode: Mode, run: RunState | undefined): string {
  const { mark } = MODES[mode];
  if (!run || mode === 'rehearsal' || mode === 'live' || mode === 'none') return mark;
  return isReal(run) ? `${mark}, real venue` : `${mark}, rehearsal`;
}

/** After a break: since when, what was filled in, and whether the run went on without us. */
export function resumedWords(
  break_: { after: number; through: number; attempts: number },
  run: RunState,
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
