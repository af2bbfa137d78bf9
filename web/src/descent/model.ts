// SPDX-License-Identifier: Apache-2.0
// Altitude against speed, from pairs of the same packet, and their position relative to the predicted corridor.
import type { Series } from '../run/series';
import type { CorridorPoint } from './corridor';

interface Point {
  sclk: number;
  speed: number;
  altitude: number;
}

export function pairs(altitude: Series | undefined, speed: Series | undefined, cutoff: number, most: number): Point[] {
  const points: Point[] = [];
  if (!altitude || !speed) return points;
  const end = altitude.firstAfter(cutoff);
  const stride = Math.max(1, Math.floor(end / most));
  let j = 0;
  for (let step = 0; step * stride < end + stride - 1; ++step) {
    const i = Math.min(step * stride, end - 1); // the newest pair is always included
    const sclk = altitude.sclk[i] as number;
    while (j < speed.length && (speed.sclk[j] as number) < sclk) ++j;
    if (j >= speed.length) break;
    // History is thinned channel by channel, so the partner may be slightly apart.
    if (Math.abs((speed.sclk[j] as number) - sclk) > 3) continue;
    const a = altitude.value[i] as number;
    const v = speed.value[j] as number;
    if (Number.isFinite(a) && Number.isFinite(v)) points.push({ sclk, altitude: a, speed: v });
  }
  return points;
}

export const LEAST_M = 5; // chosen: at touchdown the descent stage is 8 m up, on its bridle
export const LEAST_MPS = 0.5;

/**
 * Position on an axis, 0 at the bottom or left, 1 at the top or right. Logarithmic, so that the last metres get as much
 * room as the first kilometres.
 */
export function fraction(value: number, least: number, largest: number): number {
  return Math.log10(Math.max(least, value) / least) / Math.log10(largest / least);
}

const MARGIN = 1.2; // chosen: twelve landings do not reach as far as all would
const NARROWEST_DECADES = 0.03; // chosen: a narrower corridor could not be seen

export function halfWidth(point: CorridorPoint): number {
  return Math.max(NARROWEST_DECADES, point.half_decades * MARGIN);
}

export type Place = 'inside' | 'above' | 'below';

/**
 * Position of a point relative to the corridor, by the nearest point of its centre line; undefined: outside the
 * prediction. "above" is the side of more height or less speed.
 */
export function placeIn(corridor: readonly CorridorPoint[], altitude_m: number, speed_mps: number): Place | undefined {
  const [first, last] = [corridor[0], corridor[corridor.length - 1]];
  if (!first || !last || altitude_m > first.altitude_m || altitude_m < last.altitude_m * 0.8) return undefined;
  const [x, y] = [Math.log10(Math.max(LEAST_MPS, speed_mps)), Math.log10(Math.max(LEAST_M, altitude_m))];
  let best = { off: Infinity, half: 0, side: 0 };
  for (let i = 1; i < corridor.length; ++i) {
    const [a, b] = [corridor[i - 1] as CorridorPoint, corridor[i] as CorridorPoint];
    const [ax, ay] = [Math.log10(a.speed_mps), Math.log10(a.altitude_m)];
    const [dx, dy] = [Math.log10(b.speed_mps) - ax, Math.log10(b.altitude_m) - ay];
    const part = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)));
    const [ox, oy] = [x - ax - part * dx, y - ay - part * dy];
    const off = Math.hypot(ox, oy);
    if (off < best.off) best = { off, half: halfWidth(a) * (1 - part) + halfWidth(b) * part, side: oy - ox };
  }
  return best.off <= best.half ? 'inside' : best.side > 0 ? 'above' : 'below';
}

export type Box = readonly [left: number, top: number, right: number, bottom: number];
type Pixel = readonly [x: number, y: number];
const STEP_PX = 4; // chosen: words that avoid a point every so many pixels avoid the line

/** Points of the drawn path, one every few pixels. */
export function wayOf(points: readonly Pixel[]): Pixel[] {
  const way: Pixel[] = [];
  for (const point of points) {
    const last = way[way.length - 1];
    if (!last || Math.hypot(point[0] - last[0], point[1] - last[1]) >= STEP_PX) way.push(point);
  }
  return way;
}

/** Whether the path avoids the box of these words. */
export const isClear = ([left, top, right, bottom]: Box, way: readonly Pixel[]): boolean =>
  !way.some(([x, y]) => x > left - STEP_PX && x < right + STEP_PX && y > top && y < bottom);
