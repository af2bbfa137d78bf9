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
  margin: string;
  verdict: string;
}

const time = (e_s: number | undefined) => (e_s === undefined ? '' : fromEntry(e_s, { tenths: true }));

export function flownRow(row: AsFlownTimepoint): FlownRow {
  return {
    name: row.name,
    planned: time(row.plannedES),
    predicted: time(row.predictedES),
    tone: time(row.toneES),
    uhf: time(row.realtimeES),
    recorded: time(row.recordedES),
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
    `${fired} of ${all} timepoints fired: ${count((row) => row.realtimeES !== undefined)} told by UHF, ${count((row) => row.toneES !== undefined)} by tones, ` +
    `${count((row) => row.recordedES !== undefined)} in the recording. ${report.tonesDecoded} tones were decoded, ${report.tonesErased} were lost.`
  );
}

export function silenceWords(silence: AsFlownReport['silences'][number]): string {
  const to =
    silence.toES === undefined
      ? 'to the end'
      : `to ${fromEntry(silence.toES)}, ${Math.round(silence.toES - silence.fromES)} s`;
  return `${fromEntry(silence.fromES)} ${to}: ${silence.reason}`;
}
