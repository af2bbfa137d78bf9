// SPDX-License-Identifier: Apache-2.0
// Altitude against speed, from pairs of the same packet, and the predicted path.
import type { Series } from '../run/series';

interface Point {
  sclk: number;
  speed: number;
  altitude: number;
}

/** A point of the predicted path: seconds from entry, above the landing radius, relative to Mars. */
export interface PathPoint {
  e_s: number;
  altitude_m: number;
  speed_mps: number;
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

const FROM_E_S = -15; // chosen: before, height and speed are those of a coast

/** The predicted path down to the touchdown. */
export function pathOf(
  altitude: Series | undefined,
  speed: Series | undefined,
  entry_sclk: number,
  touchdown_e_s: number,
): PathPoint[] {
  return pairs(altitude, speed, entry_sclk + touchdown_e_s, Infinity)
    .map((point) => ({ e_s: point.sclk - entry_sclk, altitude_m: point.altitude, speed_mps: point.speed }))
    .filter(({ e_s }) => e_s >= FROM_E_S);
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
