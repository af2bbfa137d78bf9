// SPDX-License-Identifier: Apache-2.0
// Another run laid over the plots: what the archive has of the plotted channels, by time from entry. It is no part of
// the run shown, so it has the colour of words, a dash of its own and its number.
import { effect } from '@preact/signals';
import type uPlot from 'uplot';
import { TYPE } from '../design/type';
import { palette } from '../draw/palette';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { predictedVersion } from '../prediction/model';
import { read } from '../run/connection';
import { dictionary, laidOver, notify, plottedChannels, store } from '../run/shown';
import { within, outlined } from './ink';
import { POINTS, traceOf } from './trace';
import type { Series, Trace } from './trace';

const DASH = [10, 4]; // unlike those of further channels and of what is predicted

let held: { run: number; traces: Map<string, Trace> } | undefined;

async function ask(run: number, names: readonly string[]): Promise<void> {
  try {
    const [{ entry_sclk }, { channels }] = await Promise.all([
      read<{ entry_sclk?: number }>(`/runs/${run}`),
      read<{ channels: Series[] }>(`/runs/${run}/channels?names=${names.join()}&points=${POINTS}`),
    ]);
    if (laidOver.value !== run) return;
    if (!entry_sclk) throw new Error('nobody knows its time of entry');
    if (store.value?.entryKnown === false) throw new Error('nobody knows the time of entry of the run that is shown');
    const rates = new Map(dictionary.value?.channels.map((each) => [each.name, each.expectedRateHz]));
    held = {
      run,
      traces: new Map(channels.map((each) => [each.name, traceOf(each, entry_sclk, rates.get(each.name) ?? 0)])),
    };
  } catch (error) {
    if (laidOver.value !== run) return;
    laidOver.value = undefined;
    notify(`run ${run} cannot be laid over: ${error instanceof Error ? error.message : String(error)}`);
  }
  predictedVersion.value += 1;
}

effect(() => {
  const run = laidOver.value;
  const names = dictionary.value ? plottedChannels() : [];
  if (run === undefined) held = undefined;
  else if (names.length > 0) void ask(run, names);
});

const traceNow = (channel: DictionaryChannel): Trace | undefined =>
  held?.run === laidOver.value ? held?.traces.get(channel.name) : undefined;

/** The number of its samples in a stretch of time, for observers that cannot see a canvas. */
export const samplesOfOther = (channel: DictionaryChannel, from_e_s: number, to_e_s: number): number =>
  traceNow(channel)?.e_s.filter((e_s) => e_s >= from_e_s && e_s <= to_e_s).length ?? 0;

/** Its least and largest value in a stretch of time, as plotted; none where there is none. */
export function boundsOfOther(channel: DictionaryChannel, per: number, from_e_s: number, to_e_s: number): number[] {
  const trace = traceNow(channel);
  let [low, high] = [Infinity, -Infinity];
  trace?.e_s.forEach((e_s, i) => {
    const value = trace.value[i] as number;
    if (e_s < from_e_s || e_s > to_e_s || Number.isNaN(value)) return;
    [low, high] = [Math.min(low, value / per), Math.max(high, value / per)];
  });
  return low > high ? [] : [low, high];
}

export function drawOther(plot: uPlot, channel: DictionaryChannel, per: number): void {
  const trace = traceNow(channel);
  const { min: from, max: to } = plot.scales.x ?? {};
  if (!trace || from === undefined || to === undefined) return;
  const { left, top, width, height } = plot.bbox;
  const colours = palette();
  within(plot, (ctx, ratio) => {
    ctx.strokeStyle = colours.text;
    ctx.lineWidth = ratio;
    ctx.setLineDash(DASH.map((each) => each * ratio));
    ctx.beginPath();
    let isBroken = true;
    trace.e_s.forEach((e_s, i) => {
      const value = trace.value[i] as number;
      if (Number.isNaN(value)) isBroken = true;
      if (Number.isNaN(value) || (trace.e_s[i + 1] ?? e_s) < from || (trace.e_s[i - 1] ?? e_s) > to) return;
      const point = [plot.valToPos(e_s, 'x', true), plot.valToPos(value / per, 'y', true)] as const;
      if (isBroken) ctx.moveTo(...point);
      else ctx.lineTo(...point);
      isBroken = false;
    });
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.font = `${TYPE.mark * ratio}px ${colours.sans}`;
    ctx.textAlign = 'right';
    ctx.textBaseline = 'bottom';
    outlined(ctx, `╌ run ${held?.run}`, left + width - 4 * ratio, top + height - 3 * ratio, colours.text);
  });
}
