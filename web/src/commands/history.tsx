// SPDX-License-Identifier: Apache-2.0
// Waiting commands with the actions on them, and all commands of the run, each stage with its evidence.
import { signal } from '@preact/signals';
import { openedLater } from '../design/opened_later';
import { STAGE_LOOKS } from '../design/status';
import { cutoff, runNow, signalOfRun, takesCommands } from '../run/shown';
import { act, uplink } from './line';
import { newestEvidence, stageCells, waitingCommands } from './model';

const HISTORY_SHOWN = 12; // chosen: each has eight stages; as many more are shown at each request
/** The number of commands shown, and of which run. */
const shown = signal({ run: 0, commands: HISTORY_SHOWN });

export function Queue() {
  const run = runNow();
  if (!run || !takesCommands()) return null;
  const waiting = waitingCommands(run);
  if (waiting.length === 0) return null;
  return (
    <section class="queue" data-testid="command-queue" aria-label="commands that wait">
      <h3>{waiting.length === 1 ? 'One command waits' : `${waiting.length} commands wait`} on the ground</h3>
      <ol>
        {waiting.map(({ row, evidence, held, asker }) => (
          <li key={row.command} data-waiting={row.command}>
            <div>
              <b>
                {row.name} #{row.command}
              </b>{' '}
              <small>{evidence}</small>
            </div>
            {asker !== undefined && (
              <>
                <label>
                  I am{' '}
                  <input
                    class="name"
                    data-testid="approver"
                    maxLength={64}
                    placeholder={`not ${asker}`}
                    value={uplink.value.controller}
                    onInput={(event) => (uplink.value = { ...uplink.value, controller: event.currentTarget.value })}
                  />
                </label>
                <button
                  type="button"
                  data-testid="approve"
                  disabled={uplink.value.controller.trim() === ''}
                  onClick={() => void act(row.command, 'approve')}
                >
                  approve
                </button>
              </>
            )}
            <button type="button" onClick={() => void act(row.command, held ? 'release' : 'hold')}>
              {held ? 'release' : 'hold'}
            </button>
            <button type="button" onClick={() => void act(row.command, 'cancel')}>
              cancel
            </button>
          </li>
        ))}
      </ol>
    </section>
  );
}

const opened = signalOfRun<number | undefined>(undefined);
const Details = openedLater(async () => (await import('./details')).Details);

export function History() {
  const run = runNow();
  if (!run) return null;
  const known = (ert_s: number) => !(run.sclkSeenAt(ert_s) > cutoff.value);
  const rows = [...run.commands.values()]
    .sort((a, b) => b.command - a.command)
    .map((row) => ({ row, cells: stageCells(row, known) }))
    .filter(({ cells }) => cells.some((cell) => cell.look !== 'none'));
  const most = shown.value.run === run.id ? shown.value.commands : HISTORY_SHOWN;
  return (
    <ol class="history" data-testid="command-history">
      {rows.slice(0, most).map(({ row, cells }) => (
        <li key={row.command} data-command={row.name}>
          <div>
            <button
              type="button"
              class="link-button"
              aria-expanded={opened.value === row.command}
              onClick={() => (opened.value = opened.value === row.command ? undefined : row.command)}
            >
              {row.name} #{row.command}
            </button>{' '}
            <small title={newestEvidence(cells)}>{newestEvidence(cells)}</small>
          </div>
          <ol class="stages">
            {cells.map((cell) => (
              <li
                key={cell.stage}
                class={`stage stage-${cell.look}`}
                data-stage={cell.stage}
                data-look={cell.look}
                title={`${cell.stage}: ${STAGE_LOOKS[cell.look].word}. ${cell.evidence} ${cell.at}`}
              >
                <i>{STAGE_LOOKS[cell.look].shape}</i>
                <span>{cell.look === 'absent' ? 'no check' : cell.stage}</span>
              </li>
            ))}
          </ol>
          {opened.value === row.command && <Details row={row} cells={cells} run={run} known={known} />}
        </li>
      ))}
      {rows.length > most && (
        <li class="none">
          <button
            type="button"
            data-testid="older-commands"
            onClick={() => (shown.value = { run: run.id, commands: most + HISTORY_SHOWN })}
          >
            {rows.length - most} older: show{' '}
            {rows.length - most > HISTORY_SHOWN ? `${HISTORY_SHOWN} of them` : rows.length - most > 1 ? 'them' : 'it'}
          </button>
        </li>
      )}
      {rows.length === 0 && <li class="none">no command in this run yet</li>}
    </ol>
  );
}
