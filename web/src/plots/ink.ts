// SPDX-License-Identifier: Apache-2.0
// How a plot is drawn on: within its axes, and words that stand out from the lines behind them.
import type uPlot from 'uplot';
import { palette } from '../draw/palette';

/** Lets `draw` draw within the axes, in pixels of the screen; what it sets of the canvas ends with it. */
export function within(plot: uPlot, draw: (ctx: CanvasRenderingContext2D, ratio: number) => void): void {
  const { ctx } = plot;
  const { left, top, width, height } = plot.bbox;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  draw(ctx, window.devicePixelRatio || 1);
  ctx.restore();
}

export function outlined(ctx: CanvasRenderingContext2D, words: string, x: number, y: number, colour: string): void {
  ctx.strokeStyle = palette().panel;
  ctx.lineWidth = 3 * (window.devicePixelRatio || 1);
  ctx.lineJoin = 'round';
  ctx.strokeText(words, x, y);
  ctx.fillStyle = colour;
  ctx.fillText(words, x, y);
}
