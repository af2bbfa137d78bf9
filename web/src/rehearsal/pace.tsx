// SPDX-License-Identifier: Apache-2.0
// The bar with pace and pause of a rehearsal, which is always visible.
import { mayRehearse } from '../access/model';
import { changeReplayPace, playOrHold } from '../replay/model';
import { control } from '../run/connection';
import { modeNow, replay, runNow, store } from '../run/shown';
import { fromEntry } from '../run/time';
import { PACES, attainedText, nextPace, paceText } from './model';
import './style.css';

export function changePace(direction: 1 | -1): void {
  const run = store.value;
  if (replay.value) changeReplayPace(direction);
  else if (run && modeNow() === 'rehearsal' && mayRehearse())
    control({ action: 'pace', pace: nextPace(run.run.pace, direction) });
}
export function togglePause(): void {
  const run = store.value;
  if (replay.value) playOrHold();
  else if (run && modeNow() === 'rehearsal' && mayRehearse())
    control({ action: 'pause', pause: run.run.state !== 'paused' });
}

export function PaceBar() {
  const run = runNow();
  if (!run?.going || modeNow() !== 'rehearsal') return null;
  const paused = run.run.state === 'paused';
  const { jumpsToES: jumps } = run.run;
  const attained = (
    <span class="attained" data-testid="attained">
      {paused
        ? 'paused'
        : jumps !== undefined
          ? `jumps to ${fromEntry(jumps)}`
          : attainedText(run.run.pace, run.run.attainedPace)}
    </span>
  );
  if (!mayRehearse())
    return (
      <div class="pace-bar" data-testid="pace-bar">
        <span>{paceText(run.run.pace)}</span>
        {attained}
      </div>
    );
  return (
    <div class="pace-bar" role="group" aria-label="pace of the rehearsal" data-testid="pace-bar">
      <button type="button" onClick={togglePause} data-testid="pause" title="key p">
        {paused ? '▶ go on' : '❚❚ pause'}
      </button>
      <button type="button" onClick={() => changePace(-1)} aria-label="slower" title="key −">
        −
      </button>
      <select
        aria-label="pace"
        data-testid="pace"
        value={String(run.run.pace)}
        onChange={(event) => control({ action: 'pace', pace: Number(event.currentTarget.value) })}
      >
        {[...new Set([...PACES, run.run.pace])].map((pace) => (
          <option key={pace} value={String(pace)}>
            {paceText(pace)}
          </option>
        ))}
      </select>
      <button type="button" onClick={() => changePace(1)} aria-label="faster" title="key +">
        +
      </button>
      {attained}
    </div>
  );
}
