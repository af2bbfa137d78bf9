// SPDX-License-Identifier: Apache-2.0
// The bar of a replay: position, pace, and the way back.
import { backToLive } from '../run/session';
import { cutoff, pastRange, replay, runNow, withRecording } from '../run/shown';
import { fromEntry } from '../run/time';
import { boundsOf, changeReplayPace, playOrHold, seek, toggleRecording } from './model';
import './style.css';

/** The choice between the two readings of the past. */
export function Reading() {
  const notTold = withRecording.value ? [] : (runNow()?.notTold(cutoff.value) ?? []);
  return (
    <span class="reading-of-past">
      <span data-testid="reading-of-past">
        {withRecording.value ? 'With the recording: what happened, known then or not.' : 'As it was heard then.'}
      </span>
      {notTold.length > 0 && (
        <span data-testid="not-told">
          ▲ Too much came late to tell it all apart:{' '}
          {notTold.map(({ packet, packets }) => `${packets} packets of ${packet}`).join(', ')} may be shown before they
          were heard.
        </span>
      )}
      <button type="button" onClick={toggleRecording}>
        {withRecording.value ? 'as heard then' : 'with the recording'} <kbd>w</kbd>
      </button>
    </span>
  );
}

export function ReplayBar() {
  const run = runNow();
  const now = replay.value;
  const past = pastRange.value;
  if (!run || !now || !past) return null;
  const { from, to } = boundsOf(run);
  return (
    <div class="replay-bar" role="region" aria-label="replay" data-testid="replay-bar">
      <b>
        REPLAY {now.playing ? `${now.pace}×` : 'held'}. Nothing here is live{run.going ? '; the run goes on' : ''}.
      </b>
      <Reading />
      <button type="button" onClick={playOrHold} data-testid="replay-play" title="key p">
        {now.playing ? '❚❚ hold' : '▶ play'}
      </button>
      <button type="button" onClick={() => changeReplayPace(-1)} aria-label="replay slower" title="key −">
        −
      </button>
      <button type="button" onClick={() => changeReplayPace(1)} aria-label="replay faster" title="key +">
        +
      </button>
      <output>at {fromEntry(past.to)}</output>
      <small>{fromEntry(from)}</small>
      <input
        type="range"
        aria-label="where the replay is, in seconds from entry"
        min={Math.floor(from)}
        max={Math.ceil(to)}
        step={1}
        value={Math.round(past.to)}
        aria-valuetext={fromEntry(past.to)}
        onInput={(event) => seek(Number(event.currentTarget.value))}
      />
      <small>{fromEntry(to)}</small>
      <button type="button" onClick={backToLive}>
        leave <kbd>Esc</kbd>
      </button>
    </div>
  );
}
