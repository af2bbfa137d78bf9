// SPDX-License-Identifier: Apache-2.0
// Live data against the recording: one sentence, the rows with trouble first, and the octets that differ.
import type { ProofReport, ProofRow, ToneVerdict } from '../gen/aeolis/v1/run_pb';
import type { Status } from '../design/status';

export interface Row {
  name: string;
  live: number;
  identical: number;
  differs: number;
  missing: number;
  recorded: number;
  neverLive: number;
  notDecoded: number;
  pending: number;
}

function rowOf(row: ProofRow): Row {
  return {
    name: row.name,
    live: Number(row.realtime),
    identical: Number(row.identical),
    differs: Number(row.differs),
    missing: Number(row.missingInRecording),
    recorded: Number(row.recorded),
    neverLive: Number(row.neverSeenLive),
    notDecoded: Number(row.notDecoded),
    pending: Number(row.pending),
  };
}

export const trouble = (row: Row) => row.differs + row.missing + row.notDecoded;

/** The rows: those with trouble first, then by number of packets. */
export function rowsOf(rows: readonly ProofRow[]): Row[] {
  return rows
    .map(rowOf)
    .sort(
      (a, b) => trouble(b) - trouble(a) || b.recorded + b.live - a.recorded - a.live || a.name.localeCompare(b.name),
    );
}

export function totalOf(rows: readonly Row[]): Row {
  const total: Row = {
    name: 'all',
    live: 0,
    identical: 0,
    differs: 0,
    missing: 0,
    recorded: 0,
    neverLive: 0,
    notDecoded: 0,
    pending: 0,
  };
  for (const row of rows) {
    for (const key of [
      'live',
      'identical',
      'differs',
      'missing',
      'recorded',
      'neverLive',
      'notDecoded',
      'pending',
    ] as const)
      total[key] += row[key];
  }
  return total;
}

const many = (count: number) => count.toLocaleString('en').replaceAll(',', ' ');

/**
 * The summary in one sentence. Until the recording is complete, missing means not yet received, and nothing is called
 * proven.
 */
export function sentence(proof: ProofReport): { status: Status; text: string } {
  const total = totalOf(proof.streams.map(rowOf));
  if (total.differs > 0)
    return {
      status: 'failed',
      text: `${many(total.differs)} of ${many(total.live)} packets seen live differ from the recording.`,
    };
  if (!proof.recordingComplete) {
    return {
      status: 'missing',
      text:
        total.recorded === 0
          ? `${many(total.live)} packets were seen live; the recording has not come yet.`
          : `${many(total.identical)} of ${many(total.live)} packets seen live are in the recording so far, bit for bit; ${many(total.pending || total.live - total.identical)} wait for the rest of it.`,
    };
  }
  if (total.missing > 0)
    return {
      status: 'failed',
      text: `${many(total.missing)} of ${many(total.live)} packets seen live are not in the recording.`,
    };
  if (total.notDecoded > 0)
    return { status: 'caution', text: `${many(total.notDecoded)} packets could not be decoded; no other trouble.` };
  if (total.live === 0)
    return { status: 'unknown', text: `Nothing was seen live; the recording has ${many(total.recorded)} packets.` };
  return { status: 'holds', text: `All ${many(total.live)} packets seen live are in the recording, bit for bit.` };
}

/** The number of each verdict on tones, and the tones that are not identical. */
export function toneSummary(tones: readonly ToneVerdict[]): { counts: [string, number][]; odd: ToneVerdict[] } {
  const counts = new Map<string, number>();
  for (const tone of tones) counts.set(tone.verdict, (counts.get(tone.verdict) ?? 0) + 1);
  return { counts: [...counts].sort((a, b) => b[1] - a[1]), odd: tones.filter((tone) => tone.verdict !== 'identical') };
}

export interface Octet {
  text: string;
  differs: boolean;
}
interface DiffLine {
  at: string;
  one: Octet[];
  other: Octet[];
}

const A_LINE = 16;

/** Both packets, sixteen octets per line. An octet that only one of them has counts as different. */
export function diffLines(one: string, other: string): { lines: DiffLine[]; differing: number } {
  const split = (hex: string): string[] => hex.toLowerCase().match(/../g) ?? [];
  const [a, b] = [split(one), split(other)];
  const length = Math.max(a.length, b.length);
  const lines: DiffLine[] = [];
  let differing = 0;
  for (let at = 0; at < length; at += A_LINE) {
    const line: DiffLine = { at: at.toString(16).padStart(4, '0'), one: [], other: [] };
    for (let i = at; i < Math.min(at + A_LINE, length); ++i) {
      const differs = a[i] !== b[i];
      if (differs) ++differing;
      line.one.push({ text: a[i] ?? '--', differs });
      line.other.push({ text: b[i] ?? '--', differs });
    }
    lines.push(line);
  }
  return { lines, differing };
}
