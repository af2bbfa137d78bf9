// SPDX-License-Identifier: Apache-2.0
// A recorded range from the archive, shown as numbers here and as the past in every panel.
import { signal } from '@preact/signals';
import type { RecordingSummary } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { numberText } from '../run/dictionary';
import { ask, refuseInDoubt } from '../run/connection';
import { dictionary, lookAtPast, pastRange, replay, runNow, signalOfRun, store } from '../run/shown';
import { fromEntry, readFromEntry } from '../run/time';
import { wordsFor } from '../run/api';
import { download, save, sizeWords } from './download';
import { fileName, rangeProblem, rangeRow, samplesPath, seriesPath } from './model';
import type { RangeRow, Shape } from './model';
import { columnsOf } from '../stream/series_answer';
import type { SeriesAnswer } from '../stream/series_answer';
import './style.css';

const from = signal('E+3:50');
const to = signal('E+5:00');
const channels = signal<string | undefined>(undefined);
const size = signal('20000');
const rows = signalOfRun<RangeRow[]>([]);
const summary = signalOfRun<RecordingSummary | undefined>(undefined);
const message = signalOfRun<{ good: boolean; text: string; range?: { from: number; to: number } } | undefined>(
  undefined,
);
/** The files that the shown samples can be taken as. */
const files = signalOfRun<{ shape: Shape; path: string; name: string }[]>([]);
const underWay = signal(false);
/** The download in progress. */
const taking = signal<{ stop: AbortController; octets: number; of: number | undefined } | undefined>(undefined);

async function take(path: string, name: string): Promise<void> {
  if (taking.value) return;
  const stop = new AbortController();
  taking.value = { stop, octets: 0, of: undefined };
  message.value = undefined;
  try {
    refuseInDoubt();
    const file = await download(path, stop.signal, (octets, of) => (taking.value = { stop, octets, of }));
    save(file, name);
    message.value = { good: true, text: `${name}: ${sizeWords(file.size, undefined)}` };
  } catch (error) {
    message.value = {
      good: false,
      text: stop.signal.aborted ? 'cancelled: no file was made' : `no file was made: ${wordsFor(error)}`,
    };
  } finally {
    taking.value = undefined;
  }
}

function defaultChannels(): string {
  return LAYOUT.plots
    .map((plot) => dictionary.value?.pick(plot.channel)?.name)
    .filter((name) => name !== undefined)
    .join(' ');
}

async function query(): Promise<void> {
  const run = store.value;
  const words = dictionary.value;
  if (!run || !words) return;
  const start = readFromEntry(from.value);
  const end = readFromEntry(to.value);
  const names = (channels.value ?? defaultChannels()).split(/[\s,]+/).filter((name) => name !== '');
  const unknown = names.find((name) => !words.pick([name]));
  const points = Number(size.value);
  const problem =
    rangeProblem(start, end) ??
    (names.length === 0 ? 'name at least one channel' : undefined) ??
    (unknown === undefined ? undefined : `no channel ${unknown} in the dictionary`) ??
    (Number.isInteger(points) && points >= 2 && points <= 20000 ? undefined : 'points: a whole number from 2 to 20000');
  if (problem !== undefined || start === undefined || end === undefined) {
    message.value = { good: false, text: problem ?? '' };
    return;
  }
  underWay.value = true;
  message.value = undefined;
  rows.value = [];
  try {
    const path = seriesPath(run.id, names, run.entrySclk + start, run.entrySclk + end, points);
    const list = await ask<SeriesAnswer[]>('series', path);
    if (store.value !== run) return;
    rows.value = list.map(rangeRow);
    run.addRange(columnsOf(list), run.entrySclk + start, run.entrySclk + end);
    files.value = (['long', 'wide'] as const).map((shape) => ({
      shape,
      path: `api/v1${samplesPath(run.id, names, run.entrySclk + start, run.entrySclk + end, shape)}`,
      name: fileName(run.run.scenario, run.id, start, end, shape),
    }));
    replay.value = undefined;
    const range = { from: start, to: end };
    lookAtPast(range, true);
    const samples = rows.value.reduce((sum, row) => sum + row.samples, 0);
    message.value = { good: true, text: `${samples} samples of ${rows.value.length} channels`, range };
    summary.value = await ask<RecordingSummary>('recording', `/runs/${run.id}/recording`).catch(() => undefined);
  } catch (error) {
    message.value = { good: false, text: error instanceof Error ? error.message : String(error) };
  } finally {
    underWay.value = false;
  }
}

function verdict(recording: RecordingSummary): string {
  if (recording.progress < 1) return `… the recording is here to ${Math.floor(recording.progress * 100)} %.`;
  return recording.realtimeNotRecorded + recording.realtimeDiffers === 0n
    ? '✓ Every live packet is in the recording, bit for bit.'
    : '✖ Live and recording do not agree.';
}

export function Recorded() {
  const run = runNow();
  if (!run) return null;
  return (
    <div class="table-box" data-testid="recorded">
      <form
        class="table-tools recorded-form"
        onSubmit={(event) => {
          event.preventDefault();
          void query();
        }}
      >
        <label>
          from{' '}
          <input
            class="time"
            data-testid="range-from"
            value={from.value}
            onInput={(event) => (from.value = event.currentTarget.value)}
          />
        </label>
        <label>
          to{' '}
          <input
            class="time"
            data-testid="range-to"
            value={to.value}
            onInput={(event) => (to.value = event.currentTarget.value)}
          />
        </label>
        <label class="wide">
          channels{' '}
          <input
            data-testid="range-channels"
            value={channels.value ?? defaultChannels()}
            onInput={(event) => (channels.value = event.currentTarget.value)}
          />
        </label>
        <label>
          points{' '}
          <input
            class="points"
            value={size.value}
            inputMode="numeric"
            onInput={(event) => (size.value = event.currentTarget.value)}
          />
        </label>
        <button type="submit" disabled={underWay.value} data-testid="range-query">
          {underWay.value ? 'asking…' : 'ask'}
        </button>
      </form>
      {message.value && (
        <p class={`message ${message.value.good ? 'good' : 'bad'}`} role="status" data-testid="range-message">
          {message.value.good ? '✓' : '✖'} {message.value.text}
          {message.value.range &&
            pastRange.value === message.value.range &&
            !replay.value &&
            '; every panel now shows this range'}
        </p>
      )}
      <div class="table-scroll" tabIndex={0} role="group" aria-label="recorded range">
        {rows.value.length > 0 && (
          <table data-testid="range-table">
            <thead>
              <tr>
                <th>channel</th>
                <th>unit</th>
                <th class="number">samples</th>
                <th class="number">live</th>
                <th class="number">recording only</th>
                <th class="number">least</th>
                <th class="number">largest</th>
                <th>first … last</th>
              </tr>
            </thead>
            <tbody>
              {rows.value.map((row) => (
                <tr key={row.name} data-samples={row.samples}>
                  <td>{row.name}</td>
                  <td>{row.unit}</td>
                  <td class="number">
                    {row.samples}
                    {row.thinned ? ` (${row.given} shown)` : ''}
                  </td>
                  <td class="number">{row.live}</td>
                  <td class="number">{row.recorded}</td>
                  <td class="number">{numberText(row.least)}</td>
                  <td class="number">{numberText(row.largest)}</td>
                  <td class="number">
                    {fromEntry(row.first_sclk - run.entrySclk, { tenths: true })} …{' '}
                    {fromEntry(row.last_sclk - run.entrySclk, { tenths: true })}
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        )}
        {rows.value.length === 0 && (
          <p class="none">
            A range of this run, by time from entry. The answer comes from the archive; every panel then shows that
            range and says so.
          </p>
        )}
        {summary.value && (
          <p data-testid="recording-summary">
            {verdict(summary.value)} Recording: {String(summary.value.recorded)} packets; live:{' '}
            {String(summary.value.realtime)}, not in the recording {String(summary.value.realtimeNotRecorded)},
            differing from it {String(summary.value.realtimeDiffers)}.
          </p>
        )}
        {files.value.length > 0 && rows.value.length > 0 && (
          <p data-testid="range-export">
            {taking.value ? (
              <>
                <progress
                  max={taking.value.of ?? 1}
                  value={taking.value.of === undefined ? undefined : taking.value.octets}
                  aria-label="of the file"
                />{' '}
                {sizeWords(taking.value.octets, taking.value.of)} have come{' '}
                <button type="button" onClick={() => taking.value?.stop.abort()}>
                  cancel
                </button>
              </>
            ) : (
              <>
                take these samples as CSV:{' '}
                {files.value.map(({ shape, path, name }) => (
                  <button
                    type="button"
                    key={shape}
                    title={`${name}: ${shape === 'long' ? 'a line a sample' : 'a line an instant of the first channel, a column a channel'}`}
                    onClick={() => void take(path, name)}
                  >
                    {shape}
                  </button>
                ))}
              </>
            )}
          </p>
        )}
      </div>
    </div>
  );
}
