// SPDX-License-Identifier: Apache-2.0
// What is predicted, drawn faint under the samples of a plot: the line of the nominal flight, and ahead of now the
// silences and the moments that come.
import type uPlot from 'uplot';
import { TYPE } from '../design/type';
import { PREDICTED } from '../design/status';
import { palette } from '../draw/palette';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { predictedAt, predictedVersion, windowWords, windowsOf } from '../prediction/model';
import type { Series } from '../run/series';
import { fromEntry } from '../run/time';
import { isImportant, shortTitle } from '../timeline/model';
import { predicted } from '../timeline/now';
import { outlined, within } from './ink';

export { boundsOfOther, drawOther, samplesOfOther } from './second';

const DASH = [2, 4]; // of the line; in pixels
const EDGE_DASH = [4, 4];
const RADIUS = 3.5;
const TICK = 5;
const FAINT = 0.75;
const WORD_IN_HEAD_PX = 306; // within a panel of 330, below which style.css leaves the word out of the head

export interface PredictedLine {
  channel: DictionaryChannel;
  series: Series;
  entry_sclk: number;
  per: number;
  gap_s: number;
  now_e_s: number;
}

/** The least and the largest predicted value between two times, as plotted. */
export function predictedBounds(
  { series, entry_sclk, per }: PredictedLine,
  from_e_s: number,
  to_e_s: number,
): [number, number] | undefined {
  let [low, high] = [Infinity, -Infinity];
  const end = series.firstAfter(entry_sclk + to_e_s);
  for (let i = series.firstAfter(entry_sclk + from_e_s); i < end; ++i) {
    const value = (series.value[i] as number) / per;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low > high ? undefined : [low, high];
}

/** The number of predicted samples after now, for observers that cannot see a canvas. */
export const samplesAhead = ({ series, entry_sclk, now_e_s }: PredictedLine, to_e_s: number): number =>
  Math.max(0, series.firstAfter(entry_sclk + to_e_s) - series.firstAfter(entry_sclk + now_e_s));

/** Left, right and row of a name that stands in the plot. */
interface Taken {
  from: number;
  to: number;
  y: number;
}

/** The predicted line as it was drawn, with the ends of both axes at that time. */
interface Kept {
  key: string;
  x: [number, number];
  y: [number, number];
  picture: OffscreenCanvas;
}
const pictures = new WeakMap<uPlot, Kept>();
const STANDS_PX = 0.5; // chosen: a line that would move by less stands

/** Whether the ends of the axis are where they were when the line was drawn. */
const stands = (plot: uPlot, axis: 'x' | 'y', ends: [number, number], [begin, end]: [number, number]): boolean =>
  Math.abs(plot.valToPos(ends[0], axis, true) - begin) < STANDS_PX &&
  Math.abs(plot.valToPos(ends[1], axis, true) - end) < STANDS_PX;

/**
 * The predicted line in the pixels of the plot. Dashes over a busy line cost more than all else in a plot, so it is
 * drawn again only once an axis has moved by half a pixel.
 */
function pictureOf(plot: uPlot, line: PredictedLine, x: [number, number], y: [number, number]): OffscreenCanvas {
  const { left, top, width, height } = plot.bbox;
  const { series, entry_sclk, per, gap_s } = line;
  const colours = palette();
  const key = `${predictedVersion.peek()} ${entry_sclk} ${per} ${width} ${height} ${colours.name}`;
  const kept = pictures.get(plot);
  if (
    kept?.key === key &&
    stands(plot, 'x', kept.x, [left, left + width]) &&
    stands(plot, 'y', kept.y, [top + height, top])
  )
    return kept.picture;
  const picture = kept?.key === key ? kept.picture : new OffscreenCanvas(width, height);
  const ctx = picture.getContext('2d');
  if (!ctx) return picture;
  const ratio = window.devicePixelRatio || 1;
  ctx.clearRect(0, 0, width, height);
  ctx.strokeStyle = colours.dim;
  ctx.lineWidth = ratio;
  ctx.setLineDash(DASH.map((each) => each * ratio));
  ctx.beginPath();
  const end = Math.min(series.length, series.firstAfter(entry_sclk + x[1]) + 1);
  let before = -Infinity;
  for (let i = Math.max(0, series.firstAfter(entry_sclk + x[0]) - 1); i < end; ++i) {
    const e_s = (series.sclk[i] as number) - entry_sclk;
    const px = plot.valToPos(e_s, 'x', true) - left;
    const py = plot.valToPos((series.value[i] as number) / per, 'y', true) - top;
    if (e_s - before > gap_s) ctx.moveTo(px, py);
    else ctx.lineTo(px, py);
    before = e_s;
  }
  ctx.stroke();
  pictures.set(plot, { key, x, y, picture });
  return picture;
}

/** Draws the predicted line, and a hollow dot on it for now; of a difference the line is zero. */
export function drawPredictedLine(
  plot: uPlot,
  line: PredictedLine,
  isDifference: boolean,
  taken: readonly Taken[],
): void {
  const { left, top, width } = plot.bbox;
  const { min: from, max: to } = plot.scales.x ?? {};
  const { min: low, max: high } = plot.scales.y ?? {};
  if (from === undefined || to === undefined || low === undefined || high === undefined) return;
  const x = (e_s: number) => plot.valToPos(e_s, 'x', true);
  const y = (value: number) => plot.valToPos(value, 'y', true);
  within(plot, (ctx, ratio) => {
    ctx.strokeStyle = palette().dim;
    ctx.globalAlpha = FAINT;
    ctx.lineWidth = ratio;
    if (isDifference) {
      ctx.setLineDash(DASH.map((each) => each * ratio));
      ctx.beginPath();
      ctx.moveTo(left, y(0));
      ctx.lineTo(left + width, y(0));
      ctx.stroke();
      return;
    }
    const { series, entry_sclk, per, gap_s, channel, now_e_s } = line;
    ctx.drawImage(pictureOf(plot, line, [from, to], [low, high]), left, top);
    const now = predictedAt(channel, series, entry_sclk + now_e_s, gap_s);
    if (now === undefined) return;
    ctx.globalAlpha = 1;
    ctx.beginPath();
    ctx.arc(x(now_e_s), y(now / per), RADIUS * ratio, 0, 7);
    ctx.stroke();
    if (plot.width < WORD_IN_HEAD_PX) nameDot(plot, x(now_e_s), y(now / per), taken);
  });
}

/** The word of the hollow dot where the plot's head has no room for it: beside it, a line below or above. */
function nameDot(plot: uPlot, x: number, y: number, taken: readonly Taken[]): void {
  const { ctx } = plot;
  const { left, top, width, height } = plot.bbox;
  const ratio = window.devicePixelRatio || 1;
  const colours = palette();
  ctx.font = `${TYPE.mark * ratio}px ${colours.sans}`;
  const wide = ctx.measureText(PREDICTED.word).width;
  const away = (RADIUS + 4) * ratio;
  const isRight = x + away + wide <= left + width;
  if (!isRight && x - away - wide < left) return;
  const line = TYPE.mark * ratio;
  const from = isRight ? x + away : x - away - wide;
  const isFree = (at: number) =>
    at - line / 2 >= top + (TICK + 1) * ratio + line && // below the name of what comes next
    at + line / 2 <= top + height &&
    !taken.some((name) => name.from < from + wide && name.to > from && Math.abs(name.y - line / 2 - at) < line);
  const row = [y + line, y - line, y + 2 * line, y - 2 * line].find(isFree);
  if (row === undefined) return;
  ctx.textAlign = isRight ? 'left' : 'right';
  ctx.textBaseline = 'middle';
  outlined(ctx, PREDICTED.word, isRight ? x + away : x - away, row, colours.dim);
}

/**
 * Draws what is predicted after now: silences of UHF as hollow boxes, and ticks for moments. The next one is named, where
 * no limit has its name: `taken`, left, right and row of each.
 */
export function drawAhead(plot: uPlot, now_e_s: number, taken: readonly Taken[]): void {
  const { left, top, width, height } = plot.bbox;
  const [right, bottom] = [left + width, top + height];
  const { min: from = 0, max: to = 0 } = plot.scales.x ?? {};
  const colours = palette();
  const x = (e_s: number) => plot.valToPos(e_s, 'x', true);
  within(plot, (ctx, ratio) => {
    ctx.font = `${TYPE.mark * ratio}px ${colours.sans}`;
    ctx.fillStyle = ctx.strokeStyle = colours.dim;
    ctx.lineWidth = ratio;
    ctx.textAlign = 'center';
    ctx.textBaseline = 'bottom';
    for (const silence of windowsOf('silence', 'uhf_live')) {
      const end = silence.toES ?? Infinity;
      if (end < now_e_s || silence.fromES > to || end < from) continue;
      const [x1, x2] = [Math.max(left, x(Math.max(silence.fromES, now_e_s))), Math.min(right, x(Math.min(end, to)))];
      if (end - silence.fromES < 1) {
        ctx.fillRect(Math.round(x1), bottom - TICK * ratio, ratio, TICK * ratio); // as short as a hand-over
        continue;
      }
      ctx.setLineDash(EDGE_DASH.map((each) => each * ratio));
      ctx.globalAlpha = FAINT;
      ctx.beginPath();
      for (const [e_s, px] of [
        [silence.fromES, x1],
        [end, x2],
      ] as const) {
        if (e_s <= now_e_s || e_s > to) continue;
        ctx.moveTo(px, top);
        ctx.lineTo(px, bottom);
      }
      ctx.stroke();
      const words = windowWords(silence).find((each) => ctx.measureText(each).width + 8 * ratio <= x2 - x1);
      if (words !== undefined) ctx.fillText(words, (x1 + x2) / 2, bottom - 4 * ratio);
    }
    ctx.setLineDash([]);
    ctx.textBaseline = 'top';
    const coming = predicted.value
      .filter(({ name, e_s, fired }) => !fired && e_s > now_e_s && e_s <= to && isImportant(name))
      .sort((one, other) => one.e_s - other.e_s);
    for (const { e_s } of coming) {
      ctx.globalAlpha = FAINT;
      ctx.fillRect(Math.round(x(e_s)), top, ratio, TICK * ratio);
    }
    const next = coming[0];
    const words = next ? `${shortTitle(next.name)} ${fromEntry(next.e_s)}` : '';
    const half = ctx.measureText(words).width / 2;
    if (next && 2 * half < width) {
      const at = Math.max(left + half + 2, Math.min(right - half - 2, x(next.e_s)));
      const row = top + (TICK + 1) * ratio;
      const isFree = !taken.some(
        (name) => name.from < at + half && name.to > at - half && name.y > row && name.y < row + 22 * ratio,
      );
      ctx.globalAlpha = 1;
      if (isFree) outlined(ctx, words, at, row, colours.dim);
    }
  });
}
