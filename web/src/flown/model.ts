// SPDX-License-Identifier: Apache-2.0
// The as-flown report in words: each timepoint and event by every source that reported it, and the silences.
import type { AsFlownEvent, AsFlownReport, AsFlownTimepoint } from '../gen/aeolis/v1/run_pb';
import { fromEntry } from '../run/time';

interface FlownRow {
  name: string;
  planned: string;
  predicted: string;
  tone: string;
  uhf: string;
  recorded: string;
  againstPlan: string;
  againstPrediction: string;
  margin: string;
  verdict: string;
}

const time = (e_s: number | undefined) => (e_s === undefined ? '' : fromEntry(e_s, { tenths: true }));

/** When it was flown, by the best that is known: the recording, else live telemetry, else a tone. */
const flownAt = (row: {
  recordedES?: number | undefined;
  realtimeES?: number | undefined;
  toneES?: number | undefined;
}) => row.recordedES ?? row.realtimeES ?? row.toneES;

const apart = (flown: number | undefined, expected: number | undefined) =>
  flown === undefined || expected === undefined ? undefined : flown - expected;

/** "+4.4": later than expected, in seconds. */
function difference(flown: number | undefined, expected: number | undefined): string {
  const by_s = apart(flown, expected);
  if (by_s === undefined) return '';
  const tenths = Math.round(by_s * 10);
  return tenths === 0 ? '0.0' : `${tenths < 0 ? '−' : '+'}${Math.abs(tenths / 10).toFixed(1)}`;
}

/** The columns of the report by which its rows can be put in order, and each one's value. */
export const FLOWN_ORDER = {
  timepoint: (row: AsFlownTimepoint) => row.name,
  planned: (row: AsFlownTimepoint) => row.plannedES,
  predicted: (row: AsFlownTimepoint) => row.predictedES,
  'by tone': (row: AsFlownTimepoint) => row.toneES,
  'by telemetry': (row: AsFlownTimepoint) => row.realtimeES,
  recorded: (row: AsFlownTimepoint) => row.recordedES,
  'Δ plan, s': (row: AsFlownTimepoint) => apart(flownAt(row), row.plannedES),
  'Δ prediction, s': (row: AsFlownTimepoint) => apart(flownAt(row), row.predictedES),
  margin: (row: AsFlownTimepoint) => row.marginS,
  verdict: (row: AsFlownTimepoint) => row.verdict,
} as const;
export type FlownColumn = keyof typeof FLOWN_ORDER;

/** The rows in the order of a column; those without a value come last, whichever way. Differences by their size. */
export function inOrder(
  rows: readonly AsFlownTimepoint[],
  by: { column: FlownColumn; down: boolean } | undefined,
): readonly AsFlownTimepoint[] {
  if (!by) return rows;
  const value = FLOWN_ORDER[by.column];
  const sized = (row: AsFlownTimepoint) => {
    const own = value(row);
    return typeof own === 'number' && by.column.startsWith('Δ') ? Math.abs(own) : own;
  };
  const known = rows.filter((row) => value(row) !== undefined);
  const sorted = known.sort((one, other) => {
    const [a, b] = [sized(one), sized(other)];
    const order = typeof a === 'string' ? a.localeCompare(String(b)) : (a as number) - (b as number);
    return by.down ? -order : order;
  });
  return [...sorted, ...rows.filter((row) => value(row) === undefined)];
}

export function flownRow(row: AsFlownTimepoint): FlownRow {
  return {
    name: row.name,
    planned: time(row.plannedES),
    predicted: time(row.predictedES),
    tone: time(row.toneES),
    uhf: time(row.realtimeES),
    recorded: time(row.recordedES),
    againstPlan: difference(flownAt(row), row.plannedES),
    againstPrediction: difference(flownAt(row), row.predictedES),
    margin: row.marginS === undefined ? '' : `${row.marginS.toFixed(1)} s`,
    verdict: row.verdict,
  };
}

/** Row of an event, with the sources that reported it. */
export function flownEvent(row: AsFlownEvent) {
  return {
    name: row.name,
    predicted: time(row.predictedES),
    uhf: time(row.realtimeES),
    recorded: time(row.recordedES),
    text: row.text,
  };
}

/** The outcome of the landing in one sentence. */
export function summaryOf(report: AsFlownReport): string {
  const all = report.timepoints.length;
  const count = (known: (row: AsFlownTimepoint) => boolean) => report.timepoints.filter(known).length;
  const fired = count((row) => row.recordedES !== undefined || row.realtimeES !== undefined);
  return (
    `${fired} of ${all} timepoints fired: ${count((row) => row.realtimeES !== undefined)} told by telemetry, ${count((row) => row.toneES !== undefined)} by tones, ` +
    `${count((row) => row.recordedES !== undefined)} in the recording. ${report.tonesDecoded} tones were decoded, ${report.tonesErased} were lost.`
  );
}

/** `entryKnown`: otherwise the silence's times count from SCLK 0. */
export function silenceWords(silence: AsFlownReport['silences'][number], entryKnown = true): string {
  const when = (e_s: number) => (entryKnown ? fromEntry(e_s) : `SCLK ${e_s.toFixed(1)}`);
  const to =
    silence.toES === undefined
      ? 'to the end'
      : `to ${when(silence.toES)}, ${Math.round(silence.toES - silence.fromES)} s`;
  return `${when(silence.fromES)} ${to}: ${silence.reason}`;
}
