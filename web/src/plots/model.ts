// SPDX-License-Identifier: Apache-2.0
// Converts series to the data of a plot: one time axis, with recording and real time side by side.
import { signal } from '@preact/signals';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { differenceOf, predictedAt } from '../prediction/model';
import type { Series } from '../run/series';
import type { RunStore, Sample } from '../run/store';

/**
 * [e_s, values while telemetry was silent, values while it was live], cut to the range with one sample of margin. Together
 * they are one trace; samples known from the recording only have another colour. null breaks a line.
 */
export type Aligned = [number[], (number | null)[], (number | null)[]];

/** Whether plots show what was observed less what was predicted. */
export const difference = signal(false);

export interface Silence {
  from: number;
  to: number;
}

// chosen: a longer time without a sample is drawn as a gap, of a channel that arrives at 1 Hz or faster
export const GAP_S = 6;
export const GAP_PERIODS = 2.5; // chosen: one lost sample of a slow channel is no line through what is not known

/** The longest time between two samples of a channel that its trace goes through. */
export const gapOf = (expected_rate_hz: number): number =>
  expected_rate_hz > 0 ? Math.max(GAP_S, GAP_PERIODS / expected_rate_hz) : GAP_S;

/** Of a channel whose interval nobody promised, it is learnt from what was received. */
export const gapIn = (run: RunStore, channel: DictionaryChannel): number =>
  channel.expectedRateHz > 0
    ? gapOf(channel.expectedRateHz)
    : Math.max(GAP_S, GAP_PERIODS * run.spacing(channel.id), GAP_PERIODS * run.rhythm(channel.id));

/**
 * Aligns both series for a plot `pixels` wide. Of the samples that share a pixel the least and the largest are drawn,
 * so that no peak is lost.
 */
export function align(
  recorded: Series | undefined,
  live: Series | undefined,
  silences: readonly Silence[],
  entry_sclk: number,
  from_e_s: number,
  to_e_s: number,
  cutoff: number,
  per: number,
  pixels: number,
  gap_s = GAP_S,
): Aligned {
  const from = from_e_s + entry_sclk;
  const to = Math.min(to_e_s + entry_sclk, cutoff);
  const step_s = bucketOf((to_e_s - from_e_s) / pixels);
  const edges = silences
    .flatMap((silence) => [silence.from + entry_sclk, silence.to + entry_sclk])
    .sort((one, other) => one - other);
  const aligned: Aligned = [[], [], []];
  const [xs, silent, lit] = aligned;
  const a = thin(recorded, from, to, cutoff, step_s, edges, OF_RECORDED);
  const b = thin(live, from, to, cutoff, step_s, edges, OF_LIVE);
  let [i, j] = [0, 0];
  let reached = NaN;
  let wasSilent = false;
  while (i < a.length || j < b.length) {
    const of = i >= a.length || (j < b.length && (b.sclk[j] as number) <= (a.sclk[i] as number)) ? b : a;
    const at = of === a ? i++ : j++;
    const e_s = (of.sclk[at] as number) - entry_sclk;
    const value = of.value[at] as number;
    const shown = Number.isNaN(value) ? null : value / per;
    const isSilent = of === a && silences.some((silence) => e_s > silence.from && e_s < silence.to);
    if ((of.since[at] as number) - reached > gap_s) {
      xs.push(e_s - 1e-3);
      silent.push(null);
      lit.push(null);
    }
    xs.push(e_s);
    // Where the colour changes, the sample belongs to both traces, so that there is no hole.
    silent.push(isSilent || wasSilent ? shown : null);
    lit.push(isSilent ? null : shown);
    if (isSilent && !wasSilent && lit.length > 1) silent[silent.length - 2] = lit[lit.length - 2] ?? null;
    wasSilent = isSilent;
    if (!(reached > (of.until[at] as number))) reached = of.until[at] as number;
  }
  return aligned;
}

/** What was observed less what was predicted; a gap where nothing was predicted. */
export function less(
  [xs, silent, lit]: Aligned,
  channel: DictionaryChannel,
  predicted: Series,
  entry_sclk: number,
  per: number,
  gap_s: number,
): Aligned {
  const off = (values: (number | null)[]) =>
    values.map((value, i) => {
      const expected =
        value === null ? undefined : predictedAt(channel, predicted, entry_sclk + (xs[i] as number), gap_s);
      return value === null || expected === undefined ? null : differenceOf(channel, value * per, expected) / per;
    });
  return [xs, off(silent), off(lit)];
}

/**
 * Width of a bucket in seconds: one to two pixels, as a power of two, so that buckets stay in place while the axis
 * grows.
 */
function bucketOf(second_per_pixel: number): number {
  return 2 ** Math.ceil(Math.log2(Math.max(second_per_pixel, 1e-6)));
}

/**
 * The drawn samples as columns. Two instances are kept for reuse, since eight plots are thinned twenty times a second.
 */
class Thinned {
  length = 0;
  sclk = new Float64Array(1 << 10);
  value = new Float64Array(1 << 10);
  /** Times of the first and the last sample of each one's bucket. There may be a gap between two buckets. */
  since = new Float64Array(1 << 10);
  until = new Float64Array(1 << 10);

  add(series: Series, index: number, since: number, until: number): void {
    if (this.length === this.sclk.length) this.grow();
    this.sclk[this.length] = series.sclk[index] as number;
    this.value[this.length] = series.value[index] as number;
    this.since[this.length] = since;
    this.until[this.length] = until;
    ++this.length;
  }

  private grow(): void {
    for (const column of ['sclk', 'value', 'since', 'until'] as const) {
      const larger = new Float64Array(this[column].length * 2);
      larger.set(this[column]);
      this[column] = larger;
    }
  }
}
const [OF_RECORDED, OF_LIVE] = [new Thinned(), new Thinned()];

/**
 * Copies the least, the largest and the first undefined sample of each bucket in order of time, and the newest sample.
 * A bucket also ends at an edge.
 */
function thin(
  series: Series | undefined,
  from: number,
  to: number,
  cutoff: number,
  step_s: number,
  edges: readonly number[],
  into: Thinned,
): Thinned {
  into.length = 0;
  if (!series) return into;
  const { sclk, value } = series;
  const end = Math.min(series.length, series.firstAfter(to) + (cutoff < Infinity ? 0 : 1));
  let edge = 0;
  for (let i = Math.max(0, series.firstAfter(from) - 1); i < end; ) {
    const since = sclk[i] as number;
    while (edge < edges.length && (edges[edge] as number) <= since) ++edge;
    const ends = Math.min((Math.floor(since / step_s) + 1) * step_s, edges[edge] ?? Infinity);
    let [least, largest, unknown] = [-1, -1, -1];
    let [low, high] = [Infinity, -Infinity];
    do {
      const now = value[i] as number;
      if (now < low) {
        low = now;
        least = i;
      }
      if (now > high) {
        high = now;
        largest = i;
      }
      if (Number.isNaN(now) && unknown < 0) unknown = i;
      ++i;
    } while (i < end && (sclk[i] as number) < ends);
    const until = sclk[i - 1] as number;
    const [one, other] = least < largest ? [least, largest] : [largest, least];
    let last = -1;
    for (const index of unknown < 0
      ? [one, other]
      : unknown < one
        ? [unknown, one, other]
        : unknown < other
          ? [one, unknown, other]
          : [one, other, unknown]) {
      if (index <= last) continue;
      into.add(series, index, since, until);
      last = index;
    }
    if (i === end && last < i - 1) into.add(series, i - 1, since, until);
  }
  return into;
}

/** The reading at an instant: the newest sample by then. Undefined in a gap and after the end of the shown data. */
export function readingAt(
  run: RunStore,
  channel: number,
  e_s: number,
  cutoff: number,
  gap_s = GAP_S,
): Sample | undefined {
  const sclk = run.entrySclk + e_s;
  const sample = run.latest(channel, Math.min(cutoff, sclk));
  return sample && sclk - sample.sclk <= gap_s ? sample : undefined;
}
