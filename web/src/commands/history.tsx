// SPDX-License-Identifier: Apache-2.0
// Waiting commands with the actions on them, and all commands of the run, each stage with its evidence.
import { signal } from '@preact/signals';
import { STAGE_LOOKS } from '../design/status';
import type { CommandList } from '../gen/aeolis/v1/run_pb';
import { ask } from '../run/connection';
import { cutoff, dictionary, runNow, signalOfRun, store, takesCommands } from '../run/shown';
import type { CommandRow, RunStore } from '../run/store';
import { dayOfYear, fromEntry } from '../run/time';
import { act, uplink } from './line';
import { newestEvidence, readBackOf, stageCells, waitingCommands } from './model';
import type { StageCell } from './model';
import { argumentsInWords, rowsNow } from './names';

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
/** Asks for the octets of a command, which the stream does not carry. */
const octets = signal<{ run: number; of: Map<number, string> } | undefined>(undefined);

async function toggle(command: number): Promise<void> {
  opened.value = opened.value === command ? undefined : command;
  const run = store.value;
  if (opened.value === undefined || !run) return;
  octets.value = undefined;
  try {
    const list = await ask<CommandList>('commands', `/runs/${run.id}/commands?after=${command - 1}&limit=1`);
    octets.value = { run: run.id, of: new Map(list.commands.map((each) => [Number(each.command), each.octets])) };
  } catch {
    octets.value = { run: run.id, of: new Map() };
  }
}

function ReadBack({ row }: { row: CommandRow }) {
  const run = runNow();
  const words = dictionary.value;
  const back = run && words && readBackOf(row, words, run, cutoff.value);
  if (!back) return null;
  const differ = back.lines.filter((line) => line.equal === false).length;
  return (
    <section data-testid="read-back">
      <h3>
        {back.sclk === undefined ? (
          '? The vehicle has not reported yet what it holds'
        ) : (
          <>
            {differ > 0 ? (
              <span class="status-alarm">
                ✖ {differ} of {back.lines.length} differ
              </span>
            ) : (
              <span class="status-good">
                ✓ {back.lines.length} of {back.lines.length} are held as sent
              </span>
            )}{' '}
            by its report of {fromEntry(back.sclk - run.entrySclk, { tenths: true })}
          </>
        )}
      </h3>
      <table>
        <thead>
          <tr>
            <th>argument</th>
            <th class="number">sent</th>
            <th class="number">held</th>
            <th>equal</th>
          </tr>
        </thead>
        <tbody>
          {back.lines.map((line) => (
            <tr key={line.name} class={line.equal === false ? 'status-alarm' : ''}>
              <td>{line.name}</td>
              <td class="number">{line.sent}</td>
              <td class="number">
                {line.held === undefined
                  ? '—'
                  : line.equal
                    ? line.sent
                    : Number.isNaN(line.held)
                      ? 'undefined'
                      : String(line.held)}
              </td>
              <td>
                {line.equal === undefined ? '? not known' : line.equal ? <span class="status-good">✓</span> : '✖'}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

function Details({
  row,
  cells,
  run,
  known,
}: {
  row: CommandRow;
  cells: StageCell[];
  run: RunStore;
  known: (ert_s: number) => boolean;
}) {
  const raw = octets.value?.run === run.id ? octets.value.of.get(row.command) : undefined;
  return (
    <div class="details" data-testid="command-details">
      <table>
        <thead>
          <tr>
            <th>stage</th>
            <th>on Earth (ERT)</th>
            <th>evidence</th>
          </tr>
        </thead>
        <tbody>
          {cells.flatMap((cell) => {
            const words = (row.stages.get(cell.stage) ?? []).filter((word) => known(word.ert_s));
            if (words.length === 0)
              return [
                <tr key={cell.stage} class="status-dim">
                  <td>? {cell.stage}</td>
                  <td>—</td>
                  <td class="evidence">nothing is known</td>
                </tr>,
              ];
            return words.map((word, i) => {
              const look = word.status;
              return (
                <tr key={`${cell.stage} ${i}`} class={look === 'failed' ? 'status-alarm' : ''}>
                  <td>
                    {STAGE_LOOKS[look].shape} {cell.stage}
                    {look === 'ok' ? '' : `, ${STAGE_LOOKS[look].word}`}
                  </td>
                  <td>{dayOfYear(word.ert_s, 3)}</td>
                  <td class="evidence">{word.evidence}</td>
                </tr>
              );
            });
          })}
        </tbody>
      </table>
      <ReadBack row={row} />
      {row.arguments && (
        <p class="encoded" tabIndex={0} role="group" aria-label="arguments as sent">
          {argumentsInWords(row.arguments, rowsNow())}
        </p>
      )}
      <p class="encoded" tabIndex={0} role="group" aria-label="octets as sent">
        {!octets.value
          ? 'asking for the octets'
          : raw === undefined
            ? 'octets not known'
            : `${raw.length / 2} octets: ${raw.replace(/../g, '$& ')}`}
      </p>
    </div>
  );
}

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
              onClick={() => void toggle(row.command)}
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
