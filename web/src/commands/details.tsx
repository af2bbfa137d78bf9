// SPDX-License-Identifier: Apache-2.0
// One command of the history, opened: each stage with its evidence, what the vehicle holds, what was sent.
import { useEffect, useState } from 'preact/hooks';
import { STAGE_LOOKS } from '../design/status';
import type { CommandList } from '../gen/aeolis/v1/run_pb';
import { ask } from '../run/connection';
import { cutoff, dictionary, runNow } from '../run/shown';
import type { CommandRow, RunStore } from '../run/store';
import { dayOfYear, fromEntry } from '../run/time';
import type { StageCell } from './model';
import { argumentsInWords, rowsNow } from './names';
import { readBackOf } from './read_back';

/** The octets of a command in hexadecimal, which the stream does not carry: asked for. '': not known. */
function useOctets(run: RunStore, command: number): string | undefined {
  const [octets, setOctets] = useState<string>();
  useEffect(() => {
    let wanted = true;
    const tell = (found: string) => wanted && setOctets(found);
    setOctets(undefined);
    ask<CommandList>('commands', `/runs/${run.id}/commands?after=${command - 1}&limit=1`).then(
      (list) => tell(list.commands.find((each) => Number(each.command) === command)?.octets ?? ''),
      () => tell(''),
    );
    return () => {
      wanted = false;
    };
  }, [run, command]);
  return octets;
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

export function Details({
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
  const octets = useOctets(run, row.command);
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
        {octets === undefined
          ? 'asking for the octets'
          : octets === ''
            ? 'octets not known'
            : `${octets.length / 2} octets: ${octets.replace(/../g, '$& ')}`}
      </p>
    </div>
  );
}
