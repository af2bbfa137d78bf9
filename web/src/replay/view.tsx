// The bar of a replay: where it is, how fast, and the way back.
import { backToLive, pastRange, replay, runNow } from '../run/session';
import { fromEntry } from '../run/time';
import { boundsOf, changeReplayPace, playOrHold, seek } from './model';
import './style.css';

export function ReplayBar() {
  const run = runNow();
  const now = replay.value;
  const past = pastRange.value;
  if (!run || !now || !past) return null;
  const { from, to } = boundsOf(run);
  return (
    <div class="replay-bar" role="region" aria-label="replay" data-testid="replay-bar">
      <b>REPLAY {now.pace}×. Nothing here is live{run.going ? '; the run goes on' : ''}.</b>
      <button type="button" onClick={playOrHold} data-testid="replay-play" title="key p">{now.playing ? '❚❚ hold' : '▶ play'}</button>
      <button type="button" onClick={() => changeReplayPace(-1)} aria-label="replay slower" title="key −">−</button>
      <button type="button" onClick={() => changeReplayPace(1)} aria-label="replay faster" title="key +">+</button>
      <input type="range" aria-label="where the replay is, in seconds from entry" min={Math.floor(from)} max={Math.ceil(to)} step={1} value={Math.round(past.to)}
        aria-valuetext={fromEntry(past.to)} onInput={(event) => seek(Number(event.currentTarget.value))} />
      <output>{fromEntry(past.to)} of {fromEntry(to)}</output>
      <button type="button" onClick={backToLive}>leave <kbd>Esc</kbd></button>
    </div>
  );
}
