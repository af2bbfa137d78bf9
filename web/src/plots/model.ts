// From series to what a plot takes: one axis of time, the recording and real time beside each other.
import type { Series } from '../run/series';

/**
 * [e_s, while UHF was silent, while it was live], cut to the range with a sample of margin. Both make one trace: what
 * is known from the recording only has another colour. null breaks a line.
 */
export type Aligned = [number[], (number | null)[], (number | null)[]];

export interface Silence {
  from: number;
  to: number;
}

const GAP_S = 6; // ours: longer without a sample is drawn as a gap; what is plotted comes at 1 Hz or faster

export function align(
  recorded: Series | undefined, live: Series | undefined, silences: readonly Silence[], entry_sclk: number,
  from_e_s: number, to_e_s: number, cutoff: number, per: number, most: number,
): Aligned {
  const from = from_e_s + entry_sclk;
  const to = Math.min(to_e_s + entry_sclk, cutoff);
  const aligned: Aligned = [[], [], []];
  const [xs, silent, lit] = aligned;
  const a = part(recorded, from, to, cutoff, most);
  const b = part(live, from, to, cutoff, most);
  let last = NaN;
  let wasSilent = false;
  while (a.i < a.end || b.i < b.end) {
    const aSclk = a.i < a.end ? (a.series?.sclk[a.i] as number) : Infinity;
    const bSclk = b.i < b.end ? (b.series?.sclk[b.i] as number) : Infinity;
    const of = bSclk <= aSclk ? b : a;
    const sclk = Math.min(aSclk, bSclk);
    const e_s = sclk - entry_sclk;
    const value = (of.series?.value[of.i] as number) / per;
    const shown = Number.isNaN(value) ? null : value;
    const isSilent = of === a && silences.some((silence) => e_s > silence.from && e_s < silence.to);
    if (sclk - last > GAP_S) {
      xs.push(e_s - 1e-3);
      silent.push(null);
      lit.push(null);
    }
    xs.push(e_s);
    // Where the colour changes, the sample belongs to both, so that the trace has no hole.
    silent.push(isSilent || wasSilent ? shown : null);
    lit.push(isSilent ? null : shown);
    if (isSilent && !wasSilent && lit.length > 1) silent[silent.length - 2] = lit[lit.length - 2] ?? null;
    wasSilent = isSilent;
    last = sclk;
    // The newest sample is always drawn, whatever the stride.
    of.i = of.i + of.stride >= of.end && of.i < of.end - 1 ? of.end - 1 : of.i + of.stride;
  }
  return aligned;
}

function part(series: Series | undefined, from: number, to: number, cutoff: number, most: number) {
  if (!series) return { series, i: 0, end: 0, stride: 1 };
  const i = Math.max(0, series.firstAfter(from) - 1);
  const end = Math.min(series.length, series.firstAfter(to) + (cutoff < Infinity ? 0 : 1));
  return { series, i, end, stride: Math.max(1, Math.floor((end - i) / most)) };
}
