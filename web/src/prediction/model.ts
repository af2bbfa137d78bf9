// SPDX-License-Identifier: Apache-2.0
// The server's prediction of the landing of the run shown: the nominal flight of its scenario. It is asked for once;
// channels are asked for when they are first drawn.
import { signal } from '@preact/signals';
import type { PredictedWindow, Prediction } from '../gen/aeolis/v1/prediction_pb';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { STATUS } from '../design/status';
import { ask } from '../run/connection';
import { Series } from '../run/series';
import { signalOfRun, store } from '../run/shown';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { shortestReason } from '../timeline/model';
import { columnsOf } from '../stream/series_answer';
import type { SeriesAnswer } from '../stream/series_answer';

/** Undefined: not asked yet, or still being made. */
export const prediction = signalOfRun<Prediction | undefined>(undefined);
/** Counts the arrivals of predicted channels. */
export const predictedVersion = signal(0);

interface Held {
  of: RunStore;
  series: Map<number, Series>;
  /** Asked for, also without an answer. */
  asked: Set<number>;
  wanted: DictionaryChannel[];
}
let held: Held | undefined;
let underWay = false;

const CHANNELS_A_QUESTION = 64; // the server's limit

export const isPredicted = (): boolean => prediction.value?.state === 'ready';

/** Asks for the prediction until the server has it, or says that there is none. Called each second. */
export async function refreshPrediction(): Promise<void> {
  const of = store.peek();
  if (!of || underWay || prediction.peek()) return;
  underWay = true;
  try {
    const reply = await ask<Prediction>('prediction', `/runs/${of.id}/prediction`);
    if (store.peek() === of && reply.state !== 'flying') prediction.value = reply;
  } catch {
    // The next round asks again.
  } finally {
    underWay = false;
  }
}

/** The predicted samples of a channel; undefined until they are here, and where nothing is predicted. */
export function predictedSeries(channel: DictionaryChannel | undefined): Series | undefined {
  const of = store.peek();
  if (!channel || !of || !isPredicted()) return undefined;
  if (held?.of !== of) held = { of, series: new Map(), asked: new Set(), wanted: [] };
  if (!held.asked.has(channel.id)) {
    held.asked.add(channel.id);
    if (held.wanted.push(channel) === 1) queueMicrotask(() => void fetchWanted());
  }
  return held.series.get(channel.id);
}

async function fetchWanted(): Promise<void> {
  const mine = held;
  if (!mine) return;
  const all = mine.wanted.splice(0);
  for (let i = 0; i < all.length; i += CHANNELS_A_QUESTION) {
    const some = all.slice(i, i + CHANNELS_A_QUESTION);
    const names = some.map(({ name }) => encodeURIComponent(name)).join(',');
    try {
      const list = await ask<SeriesAnswer[]>(
        'series',
        `/runs/${mine.of.id}/prediction?channels=${names}&format=protobuf`,
      );
      for (const { id, sclk, value } of columnsOf(list)) keep(mine, id, sclk, value);
    } catch {
      // Who draws it asks again.
      for (const { id } of some) mine.asked.delete(id);
    }
  }
}

function keep(mine: Held, id: number, sclk: Float64Array, value: Float64Array): void {
  const series = new Series();
  series.append(sclk, value);
  mine.series.set(id, series);
  predictedVersion.value += 1;
}

/** Sets a prediction without a server: for tests. Samples are [e_s, value] by number of channel. */
export function predictForTest(reply: Prediction, samples: Record<number, [number, number][]> = {}): void {
  prediction.value = reply;
  const of = store.peek();
  if (!of) return;
  held = { of, series: new Map(), asked: new Set(Object.keys(samples).map(Number)), wanted: [] };
  for (const [id, points] of Object.entries(samples))
    keep(
      held,
      Number(id),
      Float64Array.from(points, ([e_s]) => of.entrySclk + e_s),
      Float64Array.from(points, ([, value]) => value),
    );
}

/** Whether a difference of two values of this unit goes round: 179° and −179° are 2° apart. */
const goesRound = (unit: string): boolean => unit === 'deg';
const HALF_TURN_DEG = 180;
const around = (difference: number): number =>
  difference - 2 * HALF_TURN_DEG * Math.round(difference / (2 * HALF_TURN_DEG));

/** `value` less `predicted`. */
export function differenceOf(channel: DictionaryChannel, value: number, predicted: number): number {
  return goesRound(channel.unit) ? around(value - predicted) : value - predicted;
}

/** Whether a difference from the prediction says anything: not of labels, nor of true and false. */
export const hasDifference = (channel: DictionaryChannel): boolean => channel.labels.length === 0;

/**
 * The predicted value at an instant, on the line between its neighbours; a label holds until the next. Undefined in a
 * gap, and outside the flight.
 */
export function predictedAt(
  channel: DictionaryChannel,
  series: Series | undefined,
  sclk: number,
  gap_s: number,
): number | undefined {
  if (!series) return undefined;
  const after = series.firstAfter(sclk);
  if (after === 0) return undefined;
  const [t0, v0] = [series.sclk[after - 1] as number, series.value[after - 1] as number];
  if (t0 === sclk) return v0;
  if (after >= series.length) return undefined;
  const [t1, v1] = [series.sclk[after] as number, series.value[after] as number];
  if (t1 - t0 > gap_s) return undefined;
  if (!hasDifference(channel)) return v0;
  return v0 + (differenceOf(channel, v1, v0) * (sclk - t0)) / (t1 - t0);
}

/** Seconds from entry at which the nominal flight has this timepoint or event. */
export const predictedEvent = (name: string | undefined): number | undefined =>
  prediction.value?.events.find((each) => each.name === name)?.eS;

/** The predicted silences of a link, or the passes over it. */
export const windowsOf = (kind: 'silence' | 'pass', link: string): PredictedWindow[] =>
  prediction.value?.windows.filter((each) => each.kind === kind && each.link === link) ?? [];
export const passes = (): PredictedWindow[] => prediction.value?.windows.filter(({ kind }) => kind === 'pass') ?? [];

/** The words for a predicted silence, the longest first. */
export function windowWords({ words, fromES, toES }: Pick<PredictedWindow, 'words' | 'fromES' | 'toES'>): string[] {
  const silent = `${STATUS.quiet.shape} ${words}`;
  const short = `${STATUS.quiet.shape} ${shortestReason(words)}`;
  if (toES !== undefined && fromEntry(toES) === fromEntry(fromES))
    return [`${silent} ${fromEntry(fromES)}`, fromEntry(fromES)];
  const times = toES === undefined ? `from ${fromEntry(fromES)}` : `${fromEntry(fromES)} to ${fromEntry(toES)}`;
  return [`${silent} ${times}`, silent, short];
}
