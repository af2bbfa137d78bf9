// Rehearsals: pace and pause in one bar that is always there; which run is looked at, and new ones, in a panel.
import { signal } from '@preact/signals';
import { outcomeWords } from '../clocks/model';
import { changeReplayPace, playOrHold } from '../replay/model';
import { control, modeNow, pastRange, replay, runNow, runs, scenarios, store, watch } from '../run/session';
import { PACES, attainedText, nextPace, paceText } from './model';
import './style.css';

export function changePace(direction: 1 | -1): void {
  if (replay.value) return changeReplayPace(direction);
  const run = store.value;
  if (run?.going && !pastRange.value) control({ action: 'pace', pace: nextPace(run.run.pace, direction) });
}
export function togglePause(): void {
  if (replay.value) return playOrHold();
  const run = store.value;
  if (run?.going && !pastRange.value) control({ action: 'pause', pause: run.run.state !== 'paused' });
}

export function PaceBar() {
  const run = runNow();
  if (!run?.going || modeNow() !== 'rehearsal') return null;
  const paused = run.run.state === 'paused';
  return (
    <div class="pace-bar" role="group" aria-label="pace of the rehearsal" data-testid="pace-bar">
      <button type="button" onClick={togglePause} data-testid="pause" title="key p">{paused ? '▶ go on' : '❚❚ pause'}</button>
      <button type="button" onClick={() => changePace(-1)} aria-label="slower" title="key −">−</button>
      <select aria-label="pace" data-testid="pace" value={String(run.run.pace)}
        onChange={(event) => control({ action: 'pace', pace: Number(event.currentTarget.value) })}>
        {[...new Set([...PACES, run.run.pace])].map((pace) => <option key={pace} value={String(pace)}>{paceText(pace)}</option>)}
      </select>
      <button type="button" onClick={() => changePace(1)} aria-label="faster" title="key +">+</button>
      <span class="attained">{paused ? 'paused' : attainedText(run.run.pace, run.run.attainedPace)}</span>
    </div>
  );
}

const scenario = signal('nominal');
const seed = signal('1');

function start(): void {
  const number = Number(seed.value);
  control({ action: 'start', scenario: scenario.value, seed: Number.isInteger(number) && number >= 0 ? number : 1, pace: 1 });
}

export function Rehearsal() {
  const run = runNow();
  const going = runs.value.find((other) => ['waiting', 'running', 'paused'].includes(other.state));
  const names = scenarios.value.length > 0 ? scenarios.value : [{ name: 'nominal', title: '' }];
  const badSeed = !/^\d{1,15}$/.test(seed.value);
  return (
    <div class="table-box" data-testid="rehearsal">
      <form class="table-tools" onSubmit={(event) => {
        event.preventDefault();
        if (!badSeed) start();
      }}>
        <label>scenario <select value={scenario.value} data-testid="scenario" onChange={(event) => (scenario.value = event.currentTarget.value)}>
          {names.map((each) => <option key={each.name} value={each.name} title={each.title}>{each.name}</option>)}
        </select></label>
        <label>seed <input class="seed" value={seed.value} inputMode="numeric" aria-invalid={badSeed} onInput={(event) => (seed.value = event.currentTarget.value)} /></label>
        <button type="submit" disabled={badSeed || going !== undefined} data-testid="start-rehearsal">start a rehearsal</button>
        {going && <button type="button" onClick={() => control({ action: 'stop' })} data-testid="stop-rehearsal">end run {String(going.run)}</button>}
        <span>{badSeed ? '✖ a seed is a whole number' : going ? 'one is going on; end it to start another' : names.find((each) => each.name === scenario.value)?.title}</span>
      </form>
      <div class="table-scroll" tabIndex={0} aria-label="runs">
        <table data-testid="run-list">
          <thead><tr><th>run</th><th>scenario</th><th class="number">seed</th><th>state</th><th>outcome</th><th>started</th><th class="number">items</th><th>show</th></tr></thead>
          <tbody>
            {runs.value.map((each) => {
              const shown = run?.id === Number(each.run);
              const live = shown && run ? run.run : each;
              return (
                <tr key={String(each.run)} class={shown ? 'shown' : ''} data-run={String(each.run)} data-state={live.state}>
                  <td class="number">{String(each.run)}</td><td>{each.scenario}</td><td class="number">{String(each.seed)}</td>
                  <td>{live.state === 'interrupted' ? '▲ ' : ''}{live.state}</td><td>{outcomeWords(live.outcome, live.state)}</td>
                  <td>{each.started}</td><td class="number">{String(live.lastSeq)}</td>
                  <td>
                    {shown ? '◀ shown ' : (
                      <button type="button" onClick={() => watch(['waiting', 'running', 'paused'].includes(each.state) ? 0 : Number(each.run))}>show</button>
                    )}
                    {live.state === 'interrupted' && (
                      <button type="button" disabled={going !== undefined} data-testid={`continue-${String(each.run)}`}
                        title="flown again up to its last item, each held against the archive; then it goes on"
                        onClick={() => control({ action: 'continue', run: Number(each.run), pace: 1 })}>continue</button>
                    )}
                  </td>
                </tr>
              );
            })}
          </tbody>
        </table>
        {runs.value.length === 0 && <p class="none">no run in the archive yet</p>}
      </div>
    </div>
  );
}
