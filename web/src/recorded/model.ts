// A fixed range of a run, asked of the archive: what it holds, and which of it came how.
import type { ChannelSeries } from '../gen/aeolis/v1/run_pb';
import { SOURCE_RECORDED } from '../stream/columns';

export interface RangeRow {
  name: string;
  unit: string;
  samples: number;
  given: number;
  thinned: boolean;
  live: number; // came live; the recording has them too once it is complete
  recorded: number; // known from the recording only
  least: number;
  largest: number;
  first_sclk: number;
  last_sclk: number;
}

export function rangeRow(series: ChannelSeries): RangeRow {
  let least = Infinity;
  let largest = -Infinity;
  let recorded = 0;
  series.value.forEach((value, i) => {
    least = value < least ? value : least;
    largest = value > largest ? value : largest;
    if (series.source[i] === SOURCE_RECORDED) ++recorded;
  });
  return {
    name: series.name, unit: series.unit, samples: Number(series.samples), given: series.sclk.length,
    thinned: series.thinned, recorded, live: series.sclk.length - recorded, least, largest,
    first_sclk: series.sclk[0] ?? NaN, last_sclk: series.sclk[series.sclk.length - 1] ?? NaN,
  };
}

/** What is wrong with a range as typed; undefined: nothing. */
export function rangeProblem(from: number | undefined, to: number | undefined): string | undefined {
  if (from === undefined) return 'the start is not a time: E+3:20, 200 or −60';
  if (to === undefined) return 'the end is not a time: E+3:20, 200 or −60';
  if (from >= to) return 'the end must be later than the start';
  return undefined;
}

export function seriesPath(
  run: number, names: readonly string[], from_sclk: number, to_sclk: number, size: number, csv: boolean,
): string {
  const query = new URLSearchParams({
    names: names.join(','), from: String(from_sclk), to: String(to_sclk), points: String(size),
  });
  if (csv) query.set('format', 'csv');
  return `/runs/${run}/channels?${query.toString()}`;
}
