import { signal } from '@preact/signals';
import { LAYOUT } from '../layout';
import { openCommandLine } from '../commands/line';
import { cutoff, dictionary, modeNow, runNow, store, timepoints } from '../run/session';
import { focusPanel } from '../shortcuts/model';
import { waitingFor } from './model';
import './style.css';

const hintShown = signal(sessionStorage.getItem('aeolis-hint') !== 'dismissed');

function dismiss(): void {
  hintShown.value = false;
  sessionStorage.setItem('aeolis-hint', 'dismissed');
}

const look = (holds: boolean | undefined) => (holds === undefined ? 'unknown' : holds ? 'holds' : 'missing');
const SHAPES = { holds: '✓', missing: '○', unknown: '?' } as const;
const WORDS = { holds: 'holds', missing: 'is missing', unknown: 'is not known' } as const;

export function WaitingFor() {
  const run = runNow();
  const words = dictionary.value;
  if (!words) return null;
  if (!run) {
    return (
      <section class="panel waiting" data-testid="waiting">
        <h2>No run yet</h2>
        <p>Start a rehearsal: choose a scenario below and press start.</p>
        <button type="button" onClick={() => focusPanel('rehearsal')}>Go to rehearsals</button>
      </section>
    );
  }
  const waiting = waitingFor(run, words, timepoints.value, cutoff.value);
  return (
    <section class={`panel waiting waiting-${waiting.kind}`} data-testid="waiting" aria-live="polite">
      {modeNow() === 'past' && <span class="past-mark">past</span>}
      <h2>{waiting.title}</h2>
      <p>{waiting.words}</p>
      <ul>
        {waiting.lines.map((line) => (
          <li key={line.words} class={look(line.holds)}>
            <span title={WORDS[look(line.holds)]}>{SHAPES[look(line.holds)]}</span>
            <span>{line.words}</span>
            <output>{line.value}</output>
          </li>
        ))}
      </ul>
      {waiting.kind === 'begin' && modeNow() === 'rehearsal' && (
        <button type="button" class="primary" onClick={() => openCommandLine(firstMissing())}>Open the command line <kbd>/</kbd></button>
      )}
      {hintShown.value && run.going && (
        <p class="hint" data-testid="hint">
          {waiting.kind === 'begin'
            ? <>New here? Both commands must reach the vehicle in time. Enter goes one step on, Esc one back. <kbd>?</kbd> shows all keys.</>
            : <>Nothing more to press. <kbd>+</kbd> and <kbd>−</kbd> change the pace, <kbd>p</kbd> pauses; the landing takes seven minutes from entry.</>}
          <button type="button" class="quiet" onClick={dismiss} aria-label="dismiss the hint">×</button>
        </p>
      )}
      {waiting.kind === 'ended' && hintShown.value && (
        <p class="hint">Everything is kept. <kbd>r</kbd> asks for a recorded range; start another landing under Rehearsal.</p>
      )}
    </section>
  );
}

function firstMissing(): string {
  const run = store.value;
  const step = LAYOUT.firstSteps.find((each) => run && ![...run.commands.values()].some((row) => row.name === each.command));
  return step?.words ?? '';
}
