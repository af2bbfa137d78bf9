// SPDX-License-Identifier: Apache-2.0
// Altitude against speed, from pairs of the same packet, and their position relative to the predicted corridor.
import type { Series } from '../run/series';
import { SPREAD } from './corridor';

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
export interface CorridorPoint extends PathPoint {
  half_decades: number;
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

const FROM_E_S = -15; // chosen: before, height and speed are those of a coast, and no landing was measured against them
const STRAIGHT_DECADES = 0.012; // a point is left out where the line without it is as near as this

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

const decades = ({ altitude_m, speed_mps }: PathPoint): [number, number] => [
  Math.log10(Math.max(LEAST_MPS, speed_mps)),
  Math.log10(Math.max(LEAST_M, altitude_m)),
];

/** The path with the points that its shape needs. */
function simplified(points: readonly PathPoint[]): PathPoint[] {
  const [first, last] = [points[0], points[points.length - 1]];
  if (!first || !last || points.length < 3) return [...points];
  const [[ax, ay], [bx, by]] = [decades(first), decades(last)];
  const [dx, dy] = [bx - ax, by - ay];
  let [worst, at] = [0, 0];
  points.forEach((point, index) => {
    const [px, py] = decades(point);
    const part = Math.max(0, Math.min(1, ((px - ax) * dx + (py - ay) * dy) / (dx * dx + dy * dy || 1)));
    const off = Math.hypot(px - ax - part * dx, py - ay - part * dy);
    if (off > worst) [worst, at] = [off, index];
  });
  if (worst <= STRAIGHT_DECADES) return [first, last];
  return [...simplified(points.slice(0, at + 1)), ...simplified(points.slice(at)).slice(1)];
}

/** The half width of the corridor at an instant, on the line between what was measured. */
function spreadAt(e_s: number): number {
  const after = SPREAD.findIndex((each) => each.e_s > e_s);
  const [a, b] = after < 0 ? [SPREAD.at(-1), SPREAD.at(-1)] : [SPREAD[Math.max(0, after - 1)], SPREAD[after]];
  if (!a || !b) return 0;
  const part = b.e_s > a.e_s ? Math.max(0, (e_s - a.e_s) / (b.e_s - a.e_s)) : 0;
  return a.half_decades + part * (b.half_decades - a.half_decades);
}

/** The predicted corridor: the predicted path, as wide as landings strayed from it. */
export const corridorOf = (path: readonly PathPoint[]): CorridorPoint[] =>
  simplified(path).map((point) => ({ ...point, half_decades: spreadAt(point.e_s) }));

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
