// SPDX-License-Identifier: Apache-2.0
// The display of the mode: a tape along the top of a rehearsal, a bar over every past view, a mark in each panel.
import { backToLive } from '../run/session';
import { modeNow, pastRange, replay, runNow } from '../run/shown';
import { fromEntry } from '../run/time';
import { Reading } from '../replay/view';
import { MODES, isReal, panelMark } from './model';
import './style.css';

/** The striped tape of a rehearsal, in every kind of view; absent from a real landing. */
export function Tape() {
  const run = runNow();
  if (!run || isReal(run.run)) return null;
  return (
    <div class="tape" data-testid="tape" role="region" aria-label="This is a rehearsal">
      <span>rehearsal</span>
      <span>rehearsal</span>
      <span>rehearsal</span>
      <span>rehearsal</span>
      <span>rehearsal</span>
    </div>
  );
}

export function PastBar() {
  const past = pastRange.value;
  const run = runNow();
  if (!past || replay.value) return null;
  return (
    <div class="past-bar" role="alert" data-testid="past-bar">
      THE PAST: {fromEntry(past.from)} to {fromEntry(past.to)}. Nothing here is live
      {run?.going ? '; the run goes on' : ''}.
      <Reading />
      <button type="button" onClick={backToLive}>
        leave <kbd>Esc</kbd>
      </button>
    </div>
  );
}

export function ModeMark() {
  const mode = modeNow();
  return (
    <span class="mode-mark" data-testid="mode-mark" title={MODES[mode].words}>
      <span aria-hidden="true">{MODES[mode].shape}</span> {panelMark(mode, runNow()?.run)}
    </span>
  );
}
