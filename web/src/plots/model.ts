// From series to what a plot takes: one axis of time, the recording and real time beside each other.
import type { Series } from '../run/series';

/** uPlot draws over `undefined` and breaks its line at `null`. */
const SKIP = undefined;
type Values = (number | null | undefined)[];

/**
 * [e_s, all, live], cut to the range with a sample of margin. `all` is what is known by any way, once there is a
 * recording; `live` is what came in real time, drawn over it: where only the first is seen, the recording filled in.
 */
export type Aligned = [number[], Values, Values];

const GAP_S = 6; // ours: longer without a sample is drawn as a gap; what is plotted comes at 1 Hz or faster

export function align(
  recorded: Series | undefined, live: Series | undefined, entry_sclk: number, from_e_s: number, to_e_s: number,
  cutoff: number, per: number, most: number,
): Aligned {
  const from = from_e_s + entry_sclk;
  const to = Math.min(to_e_s + entry_sclk, cutoff);
  const aligned: Aligned = [[], [], []];
  const [xs, all, lives] = aligned;
  const a = part(recorded, from, to, cutoff, most);
  const b = part(live, from, to, cutoff, most);
  const both = a.end > a.i;
  let lastAll = NaN;
  let lastLive = NaN;
  let lastLiveRow = -1;
  while (a.i < a.end || b.i < b.end) {
    const aSclk = a.i < a.end ? (a.series?.sclk[a.i] as number) : Infinity;
    const bSclk = b.i < b.end ? (b.series?.sclk[b.i] as number) : Infinity;
    const isLive = bSclk <= aSclk;
    const from = isLive ? b : a;
    const sclk = Math.min(aSclk, bSclk);
    const value = (from.series?.value[from.i] as number) / per;
    const shown = Number.isNaN(value) ? null : value;
    if (sclk - lastAll > GAP_S) {
      xs.push(sclk - entry_sclk - 1e-3);
      all.push(both ? null : SKIP);
      lives.push(SKIP);
    }
    // uPlot leaves out what lies between two nulls: all of a silence must be marked.
    if (isLive && sclk - lastLive > GAP_S) lives.fill(null, lastLiveRow + 1);
    xs.push(sclk - entry_sclk);
    all.push(both ? shown : SKIP);
    lives.push(isLive ? shown : SKIP);
    lastAll = sclk;
    if (isLive) {
      lastLive = sclk;
      lastLiveRow = lives.length - 1;
    }
    // The newest sample is always drawn, whatever the stride.
    from.i = from.i + from.stride >= from.end && from.i < from.end - 1 ? from.end - 1 : from.i + from.stride;
  }
  return aligned;
}

function part(series: Series | undefined, from: number, to: number, cutoff: number, most: number) {
  if (!series) return { series, i: 0, end: 0, stride: 1 };
  const i = Math.max(0, series.firstAfter(from) - 1);
  const end = Math.min(series.length, series.firstAfter(to) + (cutoff < Infinity ? 0 : 1));
  return { series, i, end, stride: Math.max(1, Math.floor((end - i) / most)) };
}
