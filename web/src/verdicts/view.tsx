// SPDX-License-Identifier: Apache-2.0
// Live against recorded: one sentence, the counts by packet and by link, the tones, and any packet octet by octet.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { STATUS, VERDICTS } from '../design/status';
import type { Verdict } from '../design/status';
import type { PacketList, PacketRow, ProofReport } from '../gen/aeolis/v1/run_pb';
import { linkTitle } from '../links/model';
import { proofOfRun } from '../proof/report';
import { ask } from '../run/connection';
import { pastRange, runNow, store } from '../run/shown';
import { fromEntry } from '../run/time';
import { Mark } from './mark';
import { diffLines, rowsOf, sentence, toneSummary, totalOf, trouble } from './model';
import type { Octet, Row } from './model';
import './style.css';

const LISTED = 100;
const ALL = 'all packets';
const VERDICT_NAMES = Object.keys(VERDICTS) as Verdict[];
const wanted = signal<Verdict>('differs');
const listed = signal<{ run: number; verdict: Verdict; packets: PacketRow[]; more: boolean } | undefined>(undefined);
const opened = signal<PacketRow | undefined>(undefined);
const problem = signal<string | undefined>(undefined);

async function list(): Promise<void> {
  const run = store.value;
  const verdict = wanted.value;
  if (!run) return;
  try {
    const page = await ask<PacketList>('packets', `/runs/${run.id}/packets?verdict=${verdict}&limit=${LISTED}`);
    if (store.value !== run || wanted.value !== verdict) return;
    listed.value = { run: run.id, verdict, packets: page.packets, more: page.nextAfter !== 0n };
    problem.value = undefined;
  } catch (error) {
    problem.value = error instanceof Error ? error.message : String(error);
  }
}

/** Bars for the recording: the part seen live and the part that disagrees. Text can stand beside them. */
function Bar({ row }: { row: Row }) {
  const all = Math.max(1, row.recorded + row.missing);
  const part = (count: number) => `${(100 * count) / all}%`;
  return (
    <span
      class="verdict-bar"
      role="img"
      aria-label={`${row.identical} identical, ${trouble(row)} in trouble, ${row.neverLive} never seen live`}
    >
      <i class="is-identical" style={{ width: part(row.identical) }} />
      {trouble(row) > 0 && <i class="is-trouble" style={{ width: part(trouble(row)) }} />}
    </span>
  );
}

const bad = (count: number) => (count > 0 ? 'number status-alarm' : 'number');

function Counts({
  title,
  rows,
  name,
  testId,
  kind,
}: {
  title: string;
  rows: Row[];
  name: (row: Row) => string;
  testId: string;
  kind: 'packet' | 'link';
}) {
  return (
    <table data-testid={testId}>
      <thead>
        <tr>
          <th>{title}</th>
          <th>seen live of recorded</th>
          <th class="number">live</th>
          <th class="number">identical</th>
          <th class="number">differs</th>
          <th class="number">missing</th>
          <th class="number">never live</th>
          <th class="number">pending</th>
          <th class="number">not decoded</th>
          <th class="number">recorded</th>
        </tr>
      </thead>
      <tbody>
        {rows.map((row) => (
          <tr key={row.name} data-row={row.name} data-menu={row.name === ALL ? undefined : `${kind} ${row.name}`}>
            <td>{name(row)}</td>
            <td>
              <Bar row={row} />
            </td>
            <td class="number">{row.live}</td>
            <td class="number">{row.identical}</td>
            <td class={bad(row.differs)}>{row.differs}</td>
            <td class={bad(row.missing)}>{row.missing}</td>
            <td class="number">{row.neverLive}</td>
            <td class="number">{row.pending}</td>
            <td class={bad(row.notDecoded)}>{row.notDecoded}</td>
            <td class="number">{row.recorded}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Tones({ proof, entry_sclk }: { proof: ProofReport; entry_sclk: number }) {
  const { counts, odd } = toneSummary(proof.tones);
  return (
    <section class="verdict-tones" data-testid="tone-verdicts">
      <h3>Tones decoded on Earth against tones sent on board</h3>
      <p>
        {counts.length === 0
          ? 'No tone has been judged yet.'
          : counts.map(([verdict, count]) => `${count} ${verdict.replaceAll('_', ' ')}`).join(' · ')}
      </p>
      <ol>
        {odd.slice(0, 60).map((tone) => (
          <li key={`${tone.sclk} ${tone.verdict}`} data-menu="instant of a tone" data-at={tone.sclk - entry_sclk}>
            <time>{fromEntry(tone.sclk - entry_sclk, { tenths: true })}</time> {tone.verdict.replaceAll('_', ' ')}{' '}
            <small>
              decoded {tone.decoded ?? '—'}, sent {tone.recorded ?? '—'}
            </small>
          </li>
        ))}
      </ol>
    </section>
  );
}

const octets = (all: readonly Octet[]) =>
  all.map((octet, i) => (octet.differs ? <mark key={i}>{octet.text}</mark> : <span key={i}>{octet.text}</span>));

function Difference({ packet }: { packet: PacketRow }) {
  const { lines, differing } = diffLines(packet.hex, packet.otherHex || packet.hex);
  const compared = packet.otherHex !== '';
  return (
    <div class="difference" data-testid="difference">
      <p>
        <b>
          packet {String(packet.unit?.unit ?? '')} · {packet.unit?.name}
        </b>{' '}
        over {linkTitle(packet.unit?.link ?? '')} · <Mark verdict={packet.verdict} />
        {compared ? ` · ${differing} of ${packet.hex.length / 2} octets differ, marked` : ''}
        <button type="button" class="quiet" aria-label="close" onClick={() => (opened.value = undefined)}>
          ×
        </button>
      </p>
      <div class="table-scroll" tabIndex={0} role="group" aria-label="octets">
        <table>
          <thead>
            <tr>
              <th>at</th>
              <th>{compared ? 'this path' : 'octets'}</th>
              {compared && <th>the other path</th>}
            </tr>
          </thead>
          <tbody>
            {lines.map((line) => (
              <tr key={line.at}>
                <td class="alias">{line.at}</td>
                <td class="hex">{octets(line.one)}</td>
                {compared && <td class="hex">{octets(line.other)}</td>}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </div>
  );
}

function Packets() {
  const run = runNow();
  useEffect(() => {
    void list();
  }, [run?.id, wanted.value, run?.run.relayProgress]);
  const now = listed.value;
  if (!run) return null;
  const fits = now && now.run === run.id && now.verdict === wanted.value ? now : undefined;
  return (
    <section class="verdict-packets">
      <div class="table-tools">
        <label>
          packets that are{' '}
          <select
            data-testid="verdict-choice"
            value={wanted.value}
            onChange={(event) => {
              wanted.value = event.currentTarget.value as Verdict;
              opened.value = undefined;
            }}
          >
            {VERDICT_NAMES.map((verdict) => (
              <option key={verdict} value={verdict}>
                {VERDICTS[verdict].words}
              </option>
            ))}
          </select>
        </label>
        <span data-testid="verdict-count">
          {problem.value
            ? `✖ ${problem.value}`
            : !fits
              ? 'asking…'
              : fits.packets.length === 0
                ? 'none'
                : fits.more
                  ? `the first ${fits.packets.length}`
                  : `${fits.packets.length}`}
        </span>
        <small>{VERDICTS[wanted.value].means}</small>
      </div>
      {opened.value && <Difference packet={opened.value} />}
      {fits && fits.packets.length > 0 && (
        <table data-testid="verdict-packets">
          <tbody>
            {fits.packets.map((row) => (
              <tr key={String(row.unit?.unit)} data-menu={`packet ${row.unit?.name}`}>
                <td class="number">{fromEntry((row.unit?.sclk ?? NaN) - run.entrySclk, { tenths: true })}</td>
                <td>
                  <button type="button" class="link-button" onClick={() => (opened.value = row)}>
                    {String(row.unit?.unit)}
                  </button>
                </td>
                <td>{row.unit?.name}</td>
                <td class="number">{row.unit?.octets}</td>
                <td>{linkTitle(row.unit?.link ?? '')}</td>
                <td>
                  <Mark verdict={row.verdict} />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </section>
  );
}

export function Verdicts() {
  const run = runNow();
  const proof = proofOfRun.use();
  if (!run) return <p class="none">no run</p>;
  if (!proof)
    return (
      <p class="none" role="status">
        {proofOfRun.problem.value ? `✖ ${proofOfRun.problem.value}` : 'asking for the report…'}
      </p>
    );
  const said = sentence(proof);
  const rows = rowsOf(proof.streams);
  return (
    <div class="table-box verdicts" data-testid="verdicts">
      <p class="verdict-sentence" role="status" data-testid="verdict-sentence">
        <b class={`status-${STATUS[said.status].token}`}>{STATUS[said.status].shape}</b> {said.text}
      </p>
      {pastRange.value && (
        <p class="not-past">▲ Verdicts are of the whole run, not of the past that the other panels show.</p>
      )}
      <div class="table-scroll" tabIndex={0} role="group" aria-label="verdicts">
        <Packets />
        <Counts
          title="packet"
          rows={[{ ...totalOf(rows), name: ALL }, ...rows]}
          name={(row) => row.name}
          testId="verdicts-by-packet"
          kind="packet"
        />
        <Counts
          title="link"
          rows={rowsOf(proof.links)}
          name={(row) => linkTitle(row.name)}
          testId="verdicts-by-link"
          kind="link"
        />
        <Tones proof={proof} entry_sclk={run.entrySclk} />
        <p>
          <a href={`api/v1/runs/${run.id}/proof?format=csv`} download="aeolis-proof.csv">
            take this report as CSV
          </a>
        </p>
      </div>
    </div>
  );
}
