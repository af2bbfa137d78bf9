// Altitude against speed, by pairs that came in one packet.
import type { Series } from '../run/series';

export interface Point {
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
    const i = Math.min(step * stride, end - 1); // the newest is always among them
    const sclk = altitude.sclk[i] as number;
    while (j < speed.length && (speed.sclk[j] as number) < sclk) ++j;
    if (j >= speed.length) break;
    // History is thinned a channel at a time: the partner may be a little apart.
    if (Math.abs((speed.sclk[j] as number) - sclk) > 3) continue;
    const a = altitude.value[i] as number;
    const v = speed.value[j] as number;
    if (Number.isFinite(a) && Number.isFinite(v)) points.push({ sclk, altitude: a, speed: v });
  }
  return points;
}

const LEAST_M = 1;

/** 0 at the bottom, 1 at the top, logarithmic: the last ten metres get the room of a hundred kilometres. */
export function heightFraction(altitude_m: number, top_m: number): number {
  const clamped = Math.max(LEAST_M, altitude_m);
  return Math.log10(clamped / LEAST_M) / Math.log10(top_m / LEAST_M);
}
