// SPDX-License-Identifier: Apache-2.0
// Further channels over a plot. Each has a dash of its own, shown with its name in the corner, since colours are for what is known
// from where. One of the same unit shares the plot's scale; any other has its own, with its least and largest value.
import type uPlot from 'uplot';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { TYPE } from '../design/type';
import { palette } from '../draw/palette';
import { numberText } from '../run/dictionary';
import { cutoff, shownRun } from '../run/shown';
import type { RunStore } from '../run/store';
import { align, gapIn } from './model';

const DASHES = [
  [6, 3],
  [2, 3],
  [8, 3, 2, 3],
] as const; // chosen: told apart at a width of one pixel

export const overVersions = (run: RunStore | undefined, over: readonly DictionaryChannel[]): string =>
  over.map(({ id }) => `${run?.recorded.get(id)?.version} ${run?.live.get(id)?.version}`).join();

/** Time and value of each point; null breaks the line. */
function traceOf(run: RunStore, channel: DictionaryChannel, from: number, to: number, pixels: number) {
  const { entrySclk, recorded, live } = run;
  const gap_s = gapIn(run, channel);
  const { id } = channel;
  const [x, , y] = align(recorded.get(id), live.get(id), [], entrySclk, from, to, cutoff.value, 1, pixels, gap_s);
  return { x, y };
}

/** Least and largest value of the channels of that unit over the span; none where there is none. */
export function extremes(
  run: RunStore,
  over: readonly DictionaryChannel[],
  unit: string,
  { from, to }: { from: number; to: number },
): number[] {
  return over.flatMap((channel) => {
    if (channel.unit !== unit) return [];
    const known = traceOf(run, channel, from, to, 1).y.filter((each) => each !== null);
    return known.length > 0 ? [Math.min(...known), Math.max(...known)] : [];
  });
}

/** `unit`: of the plot's own channel; `per` converts it to the unit of the scale. */
export function drawOver(plot: uPlot, over: readonly DictionaryChannel[], unit: string, per: number): void {
  const run = shownRun();
  const { min: from, max: to } = plot.scales.x ?? {};
  if (!run || over.length === 0 || from === undefined || to === undefined) return;
  const { left, top, width, height } = plot.bbox;
  const ratio = window.devicePixelRatio || 1;
  const colours = palette();
  const { ctx } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  ctx.font = `${TYPE.mark * ratio}px ${colours.sans}`;
  ctx.strokeStyle = ctx.fillStyle = colours.text;
  ctx.textAlign = 'left';
  ctx.textBaseline = 'alphabetic';
  ctx.lineWidth = ratio;
  for (const [i, channel] of over.entries()) {
    const { x, y } = traceOf(run, channel, from, to, plot.width);
    const known = y.filter((each) => each !== null);
    if (known.length === 0) continue;
    const [low, high] = [Math.min(...known), Math.max(...known)];
    const isShared = channel.unit === unit;
    const yOf = (value: number) =>
      isShared
        ? plot.valToPos(value / per, 'y', true)
        : top + height * (high > low ? 0.94 - (0.88 * (value - low)) / (high - low) : 0.5);
    ctx.setLineDash((DASHES[i % DASHES.length] ?? []).map((each) => each * ratio));
    ctx.beginPath();
    let isBroken = true;
    for (const [at, value] of y.entries()) {
      if (value === null) isBroken = true;
      else {
        const point = [plot.valToPos(x[at] as number, 'x', true), yOf(value)] as const;
        if (isBroken) ctx.moveTo(...point);
        else ctx.lineTo(...point);
        isBroken = false;
      }
    }
    const [begin, row] = [left + 4 * ratio, top + (10 + i * 13) * ratio];
    ctx.moveTo(begin, row - 4 * ratio);
    ctx.lineTo(begin + 22 * ratio, row - 4 * ratio); // before its name
    ctx.stroke();
    ctx.setLineDash([]);
    const scale = isShared
      ? ''
      : `, ${numberText(low)} to ${numberText(high)} ${channel.unit === '1' ? '' : channel.unit}`.trimEnd();
    ctx.strokeStyle = colours.panel;
    ctx.lineWidth = 3 * ratio;
    const words = `${channel.name}${scale}`;
    ctx.strokeText(words, begin + 26 * ratio, row);
    ctx.fillText(words, begin + 26 * ratio, row);
    ctx.strokeStyle = colours.text;
    ctx.lineWidth = ratio;
  }
  ctx.restore();
}
