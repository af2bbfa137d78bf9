// SPDX-License-Identifier: Apache-2.0
// A fixed range of a run from the archive: its content, live and recorded.
import type { SeriesAnswer } from '../stream/series_answer';

export interface RangeRow {
  name: string;
  unit: string;
  samples: number;
  given: number;
  thinned: boolean;
  live: number; // samples received live; the complete recording has them too
  recorded: number; // samples known from the recording only
  least: number;
  largest: number;
  first_sclk: number;
  last_sclk: number;
}

export function rangeRow({ name, unit, samples, thinned, columns }: SeriesAnswer): RangeRow {
  let least = Infinity;
  let largest = -Infinity;
  for (const { value } of columns) {
    for (const each of value) {
      if (each < least) least = each; // false for an undefined value
      if (each > largest) largest = each;
    }
  }
  const count = (recorded: boolean) => columns.find((column) => column.recorded === recorded)?.sclk.length ?? 0;
  const [live, recorded] = [count(false), count(true)];
  return {
    name,
    unit,
    samples,
    thinned,
    least,
    largest,
    live,
    recorded,
    given: live + recorded,
    first_sclk: columns.length > 0 ? Math.min(...columns.map((column) => column.sclk[0] ?? NaN)) : NaN,
    last_sclk: columns.length > 0 ? Math.max(...columns.map((column) => column.sclk.at(-1) ?? NaN)) : NaN,
  };
}

/** What is wrong with a typed range; undefined: nothing. */
export function rangeProblem(from: number | undefined, to: number | undefined): string | undefined {
  if (from === undefined) return 'the start is not a time: E+3:20, 200 or −60';
  if (to === undefined) return 'the end is not a time: E+3:20, 200 or −60';
  if (from >= to) return 'the end must be later than the start';
  return undefined;
}

const rangeQuery = (names: readonly string[], from_sclk: number, to_sclk: number) => ({
  names: names.join(','),
  from: String(from_sclk),
  to: String(to_sclk),
});

/** Path of a query for at most `size` points per channel; `live`: live samples only. */
export function seriesPath(
  run: number,
  names: readonly string[],
  from_sclk: number,
  to_sclk: number,
  size: number,
  live = false,
): string {
  return `/runs/${run}/channels?${new URLSearchParams({ ...rangeQuery(names, from_sclk, to_sclk), points: String(size), format: 'protobuf', ...(live && { source: 'realtime' }) }).toString()}`;
}

/** A file of samples. `long`: one line a sample. `wide`: one line an instant of the first channel, one column a channel. */
export type Shape = 'long' | 'wide';

/** Path of a query for every sample of the channels. */
export function samplesPath(
  run: number,
  names: readonly string[],
  from_sclk: number,
  to_sclk: number,
  shape: Shape,
): string {
  const align: Record<string, string> = shape === 'wide' ? { align: names[0] ?? '' } : {};
  return `/runs/${run}/samples?${new URLSearchParams({ ...rangeQuery(names, from_sclk, to_sclk), ...align }).toString()}`;
}

/** "nominal_run-3_E+3m50s_E+5m00s_wide.csv": run and range, without what a file's name cannot have. */
export function fileName(scenario: string, run: number, from_e_s: number, to_e_s: number, shape: Shape): string {
  const instant = (e_s: number) => {
    const [sign, all] = [e_s < 0 ? '-' : '+', Math.abs(e_s)];
    const seconds = (all % 60).toFixed(Number.isInteger(all) ? 0 : 1).padStart(Number.isInteger(all) ? 2 : 4, '0');
    return `E${sign}${Math.floor(all / 60)}m${seconds}s`;
  };
  const safe = scenario.replace(/[^\w.-]+/g, '-') || 'run';
  return `${safe}_run-${run}_${instant(from_e_s)}_${instant(to_e_s)}_${shape}.csv`;
}
