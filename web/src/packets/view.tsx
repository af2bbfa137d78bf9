// SPDX-License-Identifier: Apache-2.0
// Packets as received: the traffic of each link and packet, the newest packets, and one packet octet by octet beside
// its fields.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Packet as ReceivedPacket } from '../gen/aeolis/v1/items_pb';
import type { PacketList, PacketRow } from '../gen/aeolis/v1/run_pb';
import { linkTitle } from '../links/model';
import { ask } from '../run/connection';
import { cutoff, dictionary, notify, pastRange, replay, runNow, signalOfRun, store, withRecording } from '../run/shown';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { Mark } from '../verdicts/mark';
import {
  fieldsAt,
  heardRows,
  hexLines,
  linkRows,
  newestPackets,
  octetsOf,
  packetStreams,
  pageWords,
  placeWords,
} from './model';
import type { Rate } from './model';
import { wish } from './open';
import './style.css';

const SHOWN = 100;

/** A line of the list. The row of a live packet is fetched from the archive when it is opened. */
interface Line {
  fact: ReceivedPacket;
  seq: number;
  row?: PacketRow;
}

const wanted = signal<string | undefined>(undefined); // only this packet
const opened = signalOfRun<PacketRow | undefined>(undefined);
const current = signalOfRun<bigint | undefined>(undefined); // number of the selected packet
/** The frozen list while a packet is open, so that the opened line does not move away. */
const held = signal<{ run: number; lines: Line[] } | undefined>(undefined);
/** The packets of a past view, from the archive; the page itself holds only the newest. */
const pastRows = signal<{ packets: PacketRow[]; next: number }>({ packets: [], next: 0 });
/** The pages of the range: the sequence number after which each begins, up to the current page. */
const pages = signal<{ of: object | undefined; name: string | undefined; after: number[] }>({
  of: undefined,
  name: undefined,
  after: [0],
});
/** The field or octet under the mouse or the keyboard focus; an octet lights all its fields. */
const lit = signal<{ field: number } | { octet: number } | undefined>(undefined);

async function askPackets(query: string): Promise<{ packets: PacketRow[]; next: number }> {
  const run = store.value;
  if (!run) return { packets: [], next: 0 };
  try {
    const { packets, nextAfter } = await ask<PacketList>('packets', `/runs/${run.id}/packets?${query}`);
    return { packets, next: Number(nextAfter) };
  } catch (error) {
    notify(`packets: ${error instanceof Error ? error.message : String(error)}`);
    return { packets: [], next: 0 };
  }
}

async function show(line: Line, lines: Line[]): Promise<void> {
  const run = store.value;
  if (!run) return;
  current.value = line.fact.unit;
  held.value ??= { run: run.id, lines };
  const row = line.row ?? (await askPackets(`after=${line.seq - 1}&limit=1`)).packets[0];
  if (current.value !== line.fact.unit) return;
  opened.value = row;
  lit.value = undefined;
}

/** Shows what was asked for from elsewhere. */
function take({ name, row, field }: NonNullable<typeof wish.value>): void {
  const run = store.value;
  wish.value = undefined;
  opened.value = row;
  if (!row?.unit || !run) {
    wanted.value = name;
    held.value = undefined;
    return;
  }
  current.value = row.unit.unit;
  held.value = { run: run.id, lines: [{ fact: row.unit, seq: 0, row }] };
  const at = row.fields.findIndex((each) => each.name === field);
  lit.value = at < 0 ? undefined : { field: at };
  requestAnimationFrame(() =>
    document.querySelectorAll('[data-testid="packet-fields"] tr')[at]?.scrollIntoView({ block: 'nearest' }),
  );
}

function close(): void {
  opened.value = undefined;
  held.value = undefined;
  current.value = undefined;
  document.querySelector<HTMLElement>('[data-testid="packet-rows"]')?.focus();
}

function linesOf(run: RunStore, past: boolean): Line[] {
  if (held.value?.run === run.id) return held.value.lines;
  if (!past) return newestPackets(run, SHOWN, wanted.value);
  const rows = withRecording.value ? pastRows.value.packets : heardRows(run, pastRows.value.packets, cutoff.value);
  return rows.flatMap((row) =>
    row.unit && (wanted.value === undefined || row.unit.name === wanted.value) ? [{ fact: row.unit, seq: 0, row }] : [],
  );
}

function onListKey(event: KeyboardEvent, lines: Line[]): void {
  const at = lines.findIndex((line) => line.fact.unit === current.value);
  const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: lines.length - 1, Enter: Math.max(0, at) }[event.key];
  if (event.key === 'Escape' && opened.value) close();
  else if (to === undefined) return;
  else {
    const line = lines[Math.min(lines.length - 1, Math.max(0, to))];
    if (line) void show(line, lines);
    (event.currentTarget as HTMLElement)
      .querySelectorAll('tbody tr')
      [Math.min(lines.length - 1, Math.max(0, to))]?.scrollIntoView({ block: 'nearest' });
  }
  event.preventDefault();
  event.stopPropagation();
}

function rateText(rate: Rate | undefined): string {
  const bits_per_s = (rate?.octets_per_s ?? 0) * 8;
  return !rate ? '' : bits_per_s >= 1000 ? `${(bits_per_s / 1000).toFixed(1)} kb/s` : `${Math.round(bits_per_s)} b/s`;
}

function Links({ whole }: { whole: boolean }) {
  const run = runNow();
  if (!run) return null;
  const rows = linkRows(run, !whole);
  return (
    <div class="table-tools link-rates" data-testid="link-rates">
      {rows.map((row) => (
        <span key={row.link}>
          <b>{linkTitle(row.link)}</b>
          {whole ? ', whole run:' : ''} {row.packets} packets, {row.octets} octets
          {row.rate && `, ${rateText(row.rate)}`}
          {row.duplicates > 0 && `, ${row.duplicates} seen before`}
        </span>
      ))}
      {rows.length === 0 && <span>no packet yet</span>}
      {!whole && run.run.relayProgress > 0 && (
        <span>
          packets of the recording: ask for a range <kbd>r</kbd>
        </span>
      )}
    </div>
  );
}

function Streams({ whole }: { whole: boolean }) {
  const run = runNow();
  const choose = (name: string | undefined) => {
    wanted.value = name;
    close();
  };
  return (
    <div class="table-scroll streams" tabIndex={0} role="region" aria-label="packets by APID">
      <table data-testid="packet-streams">
        <thead>
          <tr>
            <th class="number">APID</th>
            <th>packet</th>
            <th class="number">packets</th>
            <th class="number">a second</th>
            <th class="number">rate</th>
          </tr>
        </thead>
        <tbody>
          {(run ? packetStreams(run, !whole) : []).map((row) => (
            <tr
              key={`${row.apid} ${row.name}`}
              class={wanted.value === row.name ? 'shown' : ''}
              data-menu={`packet ${row.name}`}
            >
              <td class="number">0x{row.apid.toString(16).padStart(3, '0')}</td>
              <td>
                <button
                  type="button"
                  class="link-button"
                  aria-pressed={wanted.value === row.name}
                  title={row.name}
                  onClick={() => choose(wanted.value === row.name ? undefined : row.name)}
                >
                  {row.name}
                </button>
              </td>
              <td class="number">{row.packets}</td>
              <td class="number">{row.rate?.packets_per_s.toFixed(1) ?? ''}</td>
              <td class="number">{rateText(row.rate)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function PacketRows({ run, lines }: { run: RunStore; lines: Line[] }) {
  return (
    <div
      class="table-scroll packet-rows"
      tabIndex={0}
      role="region"
      aria-label={`packets, ${pastRange.value ? 'oldest' : 'newest'} first; up and down open them`}
      data-testid="packet-rows"
      onKeyDown={(event) => onListKey(event, lines)}
    >
      <table data-testid="packet-table">
        <thead>
          <tr>
            <th class="number">from entry</th>
            <th>number</th>
            <th class="number">APID</th>
            <th>packet</th>
            <th class="number">octets</th>
            <th>link</th>
            <th>verdict</th>
          </tr>
        </thead>
        <tbody>
          {lines.map((line) => {
            const { fact } = line;
            const chosen = fact.unit === current.value;
            return (
              <tr
                key={String(fact.unit)}
                class={chosen ? 'shown' : ''}
                aria-current={chosen ? 'true' : undefined}
                onClick={() => void show(line, lines)}
              >
                <td class="number">{fromEntry(fact.sclk - run.entrySclk, { tenths: true })}</td>
                <td>
                  <button type="button" class="link-button" tabIndex={-1}>
                    {String(fact.unit)}
                  </button>
                </td>
                <td class="number">0x{fact.apid.toString(16).padStart(3, '0')}</td>
                <td title={fact.name}>{fact.name}</td>
                <td class="number">{fact.octets}</td>
                <td title={fact.duplicate ? 'came before over another link' : undefined}>
                  {linkTitle(fact.link)}
                  {fact.duplicate ? ' (again)' : ''}
                </td>
                <td>{line.row ? <Mark verdict={line.row.verdict} /> : <span class="status-dim">open it</span>}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}

/** Octets and fields side by side; pointing at one highlights the other. */
function Contents({ packet }: { packet: PacketRow }) {
  const at = lit.value;
  const fields = at === undefined ? [] : 'field' in at ? [at.field] : fieldsAt(packet.fields, at.octet);
  const octets = new Set<number>(at && 'octet' in at ? [at.octet] : []);
  for (const index of fields) {
    const field = packet.fields[index];
    if (!field) continue;
    const { first, last } = octetsOf(field);
    for (let octet = first; octet <= last; ++octet) octets.add(octet);
  }
  const place = fields.map((index) => packet.fields[index]).filter((field) => field !== undefined);
  const light = (octet: number) => ({
    class: octets.has(octet) ? 'lit' : undefined,
    onMouseEnter: () => (lit.value = { octet }),
  });
  const onFieldKey = (event: KeyboardEvent) => {
    const now = at && 'field' in at ? at.field : -1;
    const to = { ArrowDown: now + 1, ArrowUp: now - 1, Home: 0, End: packet.fields.length - 1 }[event.key];
    if (event.key === 'Escape') close();
    else if (to === undefined) return;
    else {
      lit.value = { field: Math.min(packet.fields.length - 1, Math.max(0, to)) };
      (event.currentTarget as HTMLElement)
        .querySelectorAll('tr')
        [lit.value.field]?.scrollIntoView({ block: 'nearest' });
    }
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: the pointer only lights what the keys of the fields light, too
    <div class="contents" onMouseLeave={() => (lit.value = undefined)}>
      <div class="table-scroll octets" tabIndex={0} role="region" aria-label="octets" data-testid="packet-octets">
        {hexLines(packet.hex).map((line) => (
          <div key={line.at}>
            <span class="alias">{line.at}</span>
            <span class="hex-part">
              {line.octets.map((octet, i) => (
                <span key={i} data-octet={line.first + i} {...light(line.first + i)}>
                  {octet}
                </span>
              ))}
            </span>
            <span class="text-part">
              {line.text.map((letter, i) => (
                <span key={i} {...light(line.first + i)}>
                  {letter}
                </span>
              ))}
            </span>
          </div>
        ))}
      </div>
      <div
        class="table-scroll packet-fields"
        tabIndex={0}
        role="region"
        aria-label="fields; up and down light their octets"
        data-testid="packet-fields"
        onKeyDown={onFieldKey}
      >
        <table>
          <tbody>
            {packet.fields.map((field, index) => (
              <tr
                key={index}
                class={fields.includes(index) ? 'lit' : ''}
                data-field={field.name}
                data-menu={dictionary.value?.pick([field.name]) && `channel ${field.name}`}
                title={placeWords(field)}
                onMouseEnter={() => (lit.value = { field: index })}
              >
                <td>{field.name}</td>
                <td class="number">{field.text}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p class="place" aria-live="polite" data-testid="packet-place">
        {place.length === 0
          ? 'point at a field or an octet, or go through the fields with ↑ ↓'
          : place
              .slice(0, 3)
              .map((field) => `${field.name}: ${placeWords(field)}, ${field.bits} bits`)
              .join(' · ')}
      </p>
    </div>
  );
}

function Packet({ packet }: { packet: PacketRow }) {
  return (
    <div class="packet" data-testid="packet">
      <p>
        <b>
          packet {String(packet.unit?.unit ?? '')} · {packet.unit?.name}
        </b>{' '}
        over {linkTitle(packet.unit?.link ?? '')}, {packet.hex.length / 2} octets · <Mark verdict={packet.verdict} />
        {packet.unit?.duplicate ? ', came before over another link' : ''}
        <button type="button" class="quiet" aria-label="close the packet" onClick={close}>
          close <kbd>Esc</kbd>
        </button>
      </p>
      {packet.problem !== '' && packet.unit?.name.startsWith('not decoded') !== true && (
        <p class="status-caution" data-testid="packet-problem">
          not decoded to its end: {packet.problem}
        </p>
      )}
      <Contents packet={packet} />
    </div>
  );
}

/** The position of the page in the range. The total is known with the last page. */
function Pages({ after, listed }: { after: number[]; listed: number }) {
  const { packets, next } = pastRows.value;
  const turn = (to: number[]) => {
    close();
    pages.value = { ...pages.value, after: to };
  };
  return (
    <div class="table-tools" data-testid="packet-pages">
      <button type="button" disabled={after.length < 2} onClick={() => turn(after.slice(0, -1))}>
        ‹ earlier
      </button>
      <button type="button" disabled={next === 0} onClick={() => turn([...after, next])}>
        later ›
      </button>
      <span role="status">
        {pageWords(after.length - 1, SHOWN, packets.length, next !== 0)}
        {listed < packets.length && `; ${listed} of them had been heard by then`}
      </span>
    </div>
  );
}

export function Packets() {
  const moving = replay.value?.playing === true;
  const past = moving ? undefined : pastRange.value;
  const name = wanted.value;
  const now = pages.value;
  const after = now.of === past && now.name === name ? now.after : [0];
  const begin = after.at(-1);
  useEffect(() => {
    pages.value = { of: past, name, after };
    pastRows.value = { packets: [], next: 0 };
    held.value = undefined;
    const run = store.value;
    if (!past || !run) return;
    const { from, to } = replay.value ? { from: past.to - 10, to: past.to } : past;
    const only = name === undefined ? '' : `&name=${encodeURIComponent(name)}`;
    let current = true;
    void askPackets(`from=${run.entrySclk + from}&to=${run.entrySclk + to}&limit=${SHOWN}&after=${begin}${only}`).then(
      (rows) => {
        if (current) pastRows.value = rows;
      },
    );
    return () => {
      current = false;
    };
  }, [past, name, begin]);
  const wished = wish.value;
  useEffect(() => {
    if (wished) take(wished);
  }, [wished]);
  const run = runNow();
  if (!run) return null;
  if (moving)
    return (
      <p class="none" data-testid="packets-not-replayed">
        ▲ Packets are not replayed. Hold the replay (<kbd>p</kbd>) to see those of the ten seconds before it.
      </p>
    );
  const packet = opened.value;
  const lines = linesOf(run, past !== undefined);
  const top = held.value?.run === run.id && !past ? lines[0]?.fact.unit : undefined;
  const since =
    top === undefined
      ? 0
      : run.packets.filter(({ fact }) => fact.unit > top && (wanted.value === undefined || fact.name === wanted.value))
          .length;
  return (
    <div class="table-box">
      {past && <p class="not-past">▲ Counts are of the whole run; the packets are those of the past that is shown.</p>}
      <Links whole={past !== undefined} />
      {(wanted.value !== undefined || since > 0) && (
        <div class="table-tools">
          {wanted.value !== undefined && (
            <span>
              only <b>{wanted.value}</b>, of {past ? 'all of the range' : 'the newest held'}{' '}
              <button
                type="button"
                onClick={() => {
                  wanted.value = undefined;
                  close();
                }}
              >
                show all
              </button>
            </span>
          )}
          {since > 0 && (
            <span class="status-caution" data-testid="list-held">
              ▲ the list stands still while a packet is open: {since} came since
            </span>
          )}
        </div>
      )}
      {past && <Pages after={after} listed={held.value ? pastRows.value.packets.length : lines.length} />}
      <div class={`packets ${packet ? 'with-packet' : ''}`}>
        <Streams whole={past !== undefined} />
        <PacketRows run={run} lines={lines} />
        {packet && <Packet packet={packet} />}
      </div>
    </div>
  );
}
