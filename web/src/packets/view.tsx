import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Unit } from '../gen/aeolis/v1/items_pb';
import type { RunStore } from '../run/store';
import type { PacketList, PacketRow } from '../gen/aeolis/v1/run_pb';
import { ask, pastRange, notify, replay, runNow, store } from '../run/session';
import { linkTitle } from '../links/model';
import { fromEntry } from '../run/time';
import { hexLines, linkRates, newestUnits } from './model';
import './style.css';

const SHOWN = 100;
const opened = signal<PacketRow | undefined>(undefined);

async function open(seq: number): Promise<void> {
  const run = store.value;
  if (!run) return;
  try {
    const list = await ask<PacketList>('packets', `/runs/${run.id}/packets?after=${seq - 1}&limit=1`);
    opened.value = list.packets[0];
    if (!opened.value) notify(`item ${seq} is not in the archive`);
  } catch (error) {
    notify(`packets: ${error instanceof Error ? error.message : String(error)}`);
  }
}

/** In a past view the units of that range come from the archive: the page itself holds only the newest. */
const pastRows = signal<PacketRow[]>([]);

async function askPast(range: { from: number; to: number }): Promise<void> {
  const run = store.value;
  if (!run) return;
  try {
    const path = `/runs/${run.id}/packets?from=${run.entrySclk + range.from}&to=${run.entrySclk + range.to}&limit=${SHOWN}`;
    const list = await ask<PacketList>('packets', path);
    pastRows.value = list.packets;
  } catch (error) {
    notify(`packets: ${error instanceof Error ? error.message : String(error)}`);
  }
}

function shownUnits(run: RunStore, past: boolean): { fact: Unit; show: () => void }[] {
  if (!past) return newestUnits(run, SHOWN).map(({ seq, fact }) => ({ fact, show: () => void open(seq) }));
  return pastRows.value.flatMap((row) => (row.unit ? [{ fact: row.unit, show: () => (opened.value = row) }] : []));
}

export function Packets() {
  const moving = replay.value?.playing === true;
  const past = moving ? undefined : pastRange.value;
  useEffect(() => {
    pastRows.value = [];
    if (past) void askPast(replay.value ? { from: past.to - 10, to: past.to } : past);
  }, [past]);
  const run = runNow();
  if (!run) return null;
  const packet = opened.value;
  if (moving) return <p class="none" data-testid="packets-not-replayed">▲ Units are not replayed. Hold the replay (<kbd>p</kbd>) to see those of the ten seconds before it.</p>;
  return (
    <div class="table-box">
      <div class="table-tools" data-testid="link-rates">
        {linkRates(run).map((rate) => (
          <span key={rate.link}>
            <b>{linkTitle(rate.link)}</b>{past ? ', whole run:' : ''} {rate.units} units, {rate.octets} octets
            {rate.octets_per_s !== undefined && `, ${(rate.octets_per_s * 8 / 1000).toFixed(1)} kb/s`}
            {rate.duplicates > 0 && `, ${rate.duplicates} seen before`}
          </span>
        ))}
        {run.unitTotals.size === 0 && <span>no unit yet</span>}
      </div>
      <div class="packets">
        <div class="table-scroll" tabIndex={0} aria-label="units">
          <table data-testid="unit-table">
            <thead><tr><th>from entry</th><th>unit</th><th>APID</th><th>packet</th><th class="number">octets</th><th>link</th></tr></thead>
            <tbody>
              {shownUnits(run, past !== undefined).map(({ fact, show }) => (
                <tr key={String(fact.unit)}>
                  <td class="number">{fromEntry(fact.sclk - run.entrySclk, { tenths: true })}</td>
                  <td><button type="button" class="link-button" onClick={show}>{String(fact.unit)}</button></td>
                  <td class="number">0x{fact.apid.toString(16).padStart(3, '0')}</td>
                  <td>{fact.name}</td>
                  <td class="number">{fact.octets}</td>
                  <td>{linkTitle(fact.link)}{fact.duplicate ? ' (again)' : ''}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
        {packet && (
          <div class="packet table-scroll" data-testid="packet">
            <b>unit {String(packet.unit?.unit ?? '')} · {packet.unit?.name}</b> over {linkTitle(packet.unit?.link ?? '')}, {packet.verdict.replaceAll('_', ' ')}{packet.unit?.duplicate ? ', came before over another link' : ''}
            <button type="button" class="quiet" aria-label="close" onClick={() => (opened.value = undefined)}>×</button>
            <pre>{hexLines(packet.hex).map((line) => `${line.at}  ${line.octets.padEnd(47)}  ${line.text}`).join('\n')}</pre>
            <dl>{packet.fields.map((field) => (<><dt>{field.name}</dt><dd>{field.text}</dd></>))}</dl>
          </div>
        )}
      </div>
    </div>
  );
}
