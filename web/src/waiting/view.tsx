import { STATUS, held } from '../design/status';
import { LAYOUT } from '../layout';
import { openCommandLine } from '../commands/line';
import { cutoff, dictionary, runNow, store, takesCommands, timepoints } from '../run/session';
import { ModeMark } from '../mode/view';
import { focusPanel } from '../shortcuts/model';
import { inWords } from '../run/dictionary';
import { thenNamed, waitingFor } from './model';
import './style.css';


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
  const then = waiting.kind === 'waiting' ? thenNamed(run, timepoints.value, cutoff.value) : undefined;
  return (
    <section class={`panel waiting waiting-${waiting.kind}`} data-testid="waiting" aria-live="polite">
      <ModeMark />
      <h2>{waiting.title}</h2>
      <p>{waiting.words}{then && <> Then <b>{inWords(then)}</b>.</>}</p>
      <ul>
        {waiting.lines.map((line) => (
          <li key={line.words} class={held(line.holds)}>
            <span title={STATUS[held(line.holds)].word}>{STATUS[held(line.holds)].shape}</span>
            <span>{line.words}</span>
            <output>{line.value}</output>
          </li>
        ))}
      </ul>
      {waiting.kind === 'begin' && takesCommands() && (
        <button type="button" class="primary" onClick={() => openCommandLine(firstMissing())}>Open the command line <kbd>/</kbd></button>
      )}
    </section>
  );
}

function firstMissing(): string {
  const run = store.value;
  const step = LAYOUT.firstSteps.find((each) => run && ![...run.commands.values()].some((row) => row.name === each.command));
  return step?.words ?? '';
}
