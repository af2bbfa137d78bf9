// SPDX-License-Identifier: Apache-2.0
import { STATUS, held } from '../design/status';
import { useEffect } from 'preact/hooks';
import { chosen, lineFocused, openCommandLine, previewNow, step } from '../commands/line';
import { mayRehearse, whyNotRehearse } from '../access/model';
import { EndRun } from '../rehearsal/end_run';
import { isLost, stream } from '../run/connection';
import type { Dictionary } from '../run/dictionary';
import { cutoff, dictionary, modeNow, runNow, takesCommands, timepoints } from '../run/shown';
import { ModeMark } from '../mode/view';
import { focusPanel } from '../shortcuts/model';
import { predicted } from '../timeline/now';
import { waitingFor } from './model';
import type { Neighbour as NeighbourOf } from './model';
import { told } from './told';
import './style.css';

/** What is to be done next of the first command: what has been done is not asked for again. */
function toDo(title: string): string {
  if (chosen.value && step.value === 'armed') return `Type ${chosen.value.name} and press Enter`;
  if (chosen.value && step.value === 'review')
    return previewNow.value?.accepted === false ? 'It would be refused now' : 'Read it, then press Enter';
  return lineFocused.value ? title.replace(/^Press \/ and type/, 'Type') : title;
}

/**
 * A run that waits for its first command has the command line in focus, so that who types words at once types them
 * there; not before all of the run has come, since until then its commands are not known. The button opens it for who
 * has left it.
 */
function LineFor({ command, run, isWhole }: { command: string; run: number; isWhole: boolean }) {
  useEffect(() => {
    if (isWhole && document.activeElement === document.body && step.value === 'type') openCommandLine();
  }, [command, run, isWhole]);
  if (step.value !== 'type') return null;
  return (
    <button
      type="button"
      class={`primary ${lineFocused.value ? 'unseen' : ''}`}
      onClick={() => openCommandLine(command)}
    >
      Open the command line <kbd>/</kbd>
    </button>
  );
}

/** What comes before or after the step that is awaited. */
const Neighbour = ({ word, of }: { word: string; of: NeighbourOf }) => (
  <p class="before" data-testid={`waiting-${word.toLowerCase()}`}>
    {word} <b>{of.name}</b>
    {of.words && `, ${of.words}`}: <output>{of.value}</output>
  </p>
);

/** The menu of a condition: of the channel that it is about, if it has the name of one. */
const menuOf = (words: Dictionary, quantity = ''): string | undefined =>
  words.pick([quantity]) && `channel ${quantity}`;

export function WaitingFor() {
  const run = runNow();
  const words = dictionary.value;
  if (!words) return null;
  if (!run) {
    return (
      <section class="panel waiting" data-testid="waiting">
        <h2>No run yet</h2>
        {mayRehearse() ? (
          <>
            <p>Start a rehearsal: choose a scenario below and press start.</p>
            <button type="button" onClick={() => focusPanel('rehearsal')}>
              Go to rehearsals
            </button>
          </>
        ) : (
          <p>Nothing is flown now: {whyNotRehearse('starting a rehearsal')}</p>
        )}
      </section>
    );
  }
  const isWhole = stream.value.state === 'live';
  const waiting = waitingFor(run, words, timepoints.value, cutoff.value, predicted.value, told.value);
  // the clocks stand still, so the conditions are old
  const isOld = isLost.value && cutoff.value === Infinity && waiting.kind === 'waiting';
  return (
    <section
      class={`panel waiting waiting-${waiting.kind} ${waiting.late || waiting.type !== undefined ? 'waiting-said' : ''}`}
      data-testid="waiting"
      data-panel="waiting"
    >
      <ModeMark />
      <h2 aria-live="polite" data-room={waiting.title}>
        <span>{waiting.type === undefined ? waiting.title : toDo(waiting.title)}</span>
      </h2>
      {waiting.words !== '' && <p>{waiting.words}</p>}
      <ul>
        {waiting.lines.map((line) => {
          const look = held(isOld ? undefined : line.holds);
          return (
            <li key={line.words} class={look} data-menu={menuOf(words, line.quantity)}>
              <span title={STATUS[look].word}>{STATUS[look].shape}</span>
              <span>{line.words}</span>
              <output>{line.value}</output>
            </li>
          );
        })}
      </ul>
      {waiting.before && <Neighbour word="First" of={waiting.before} />}
      {waiting.after && <Neighbour word="Then" of={waiting.after} />}
      {waiting.byTone && (
        <p class="by-tone" data-testid="waiting-by-tone">
          ■ by tone, the last that was heard of: {waiting.byTone}
        </p>
      )}
      {waiting.coming !== undefined && (
        <p>
          <progress max={1} value={waiting.coming} aria-label="of the recording" />{' '}
          {modeNow() === 'rehearsal' && mayRehearse() && (
            <EndRun run={run.id} name="stop-downlink" words="stop here, with what has come" />
          )}
        </p>
      )}
      {waiting.late && modeNow() === 'rehearsal' && mayRehearse() && (
        <button type="button" class="primary" onClick={() => focusPanel('rehearsal')}>
          Go to the runs <kbd>s</kbd>
        </button>
      )}
      {waiting.type !== undefined && takesCommands() && (
        <LineFor command={waiting.type} run={run.id} isWhole={isWhole} />
      )}
    </section>
  );
}
