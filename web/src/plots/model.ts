// From series to what a plot takes: one axis of time, the recording and real time beside each other.
import type { Series } from '../run/series';

/** [e_s, recorded, live], cut to the range with one sample of margin; null where one of them has no sample. */
export type Aligned = [number[], (number | null)[], (number | null)[]];

const GAP_S = 6; // ours: longer without a sample is drawn as a gap; the slowest channel plotted comes at 1 Hz

export function align(
  recorded: Series | undefined, live: Series | undefined, entry_sclk: number, from_e_s: number, to_e_s: number,
  cutoff: number, per: number, most: number,
): Aligned {
  const x: number[] = [];
  const ys: [(number | null)[], (number | null)[]] = [[], []];
  const from = from_e_s + entry_sclk;
  const to = Math.min(to_e_s + entry_sclk, cutoff);
  const cursors = [recorded, live].map((series) => {
    if (!series) return { i: 0, end: 0, stride: 1, last: -Infinity };
    const i = Math.max(0, series.firstAfter(from) - 1);
    const end = Math.min(series.length, series.firstAfter(to) + (cutoff < Infinity ? 0 : 1));
    return { i, end, stride: Math.max(1, Math.floor((end - i) / most)), last: -Infinity };
  });
  const sources = [recorded, live];
  for (;;) {
    let which = -1;
    let at = Infinity;
    cursors.forEach((cursor, k) => {
      const sclk = cursor.i < cursor.end ? (sources[k]?.sclk[cursor.i] as number) : Infinity;
      if (sclk < at) {
        at = sclk;
        which = k;
      }
    });
    if (which < 0) break;
    const cursor = cursors[which] as (typeof cursors)[number];
    const value = sources[which]?.value[cursor.i] as number;
    if (at - cursor.last > Math.max(GAP_S, 0) && cursor.last > -Infinity) {
      x.push((cursor.last + at) / 2 - entry_sclk);
      ys[which]?.push(NaN);
      ys[1 - which]?.push(null);
    }
    cursor.last = at;
    x.push(at - entry_sclk);
    ys[which]?.push(Number.isNaN(value) ? NaN : value / per);
    ys[1 - which]?.push(null);
    cursor.i += cursor.stride;
  }
  return orderAndMark([x, ys[0], ys[1]]);
}

/** uPlot joins over `undefined` and breaks at `null`; a gap's middle may lie out of order by the other's samples. */
function orderAndMark([x, recorded, live]: Aligned): Aligned {
  const order = x.map((_, i) => i).sort((a, b) => (x[a] as number) - (x[b] as number));
  const mark = (values: (number | null)[]) => order.map((i) => {
    const value = values[i];
    return value === null || value === undefined ? undefined : Number.isNaN(value) ? null : value;
  }) as (number | null)[];
  return [order.map((i) => x[i] as number), mark(recorded), mark(live)];
}
