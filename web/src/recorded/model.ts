// A fixed range of a run, asked of the archive: what it holds, and whether real time and recording agree.
import type { ChannelSeries } from '../gen/aeolis/v1/run_pb';
import { SOURCE_RECORDED } from '../run/store';

export interface RangeRow {
  name: string;
  unit: string;
  samples: number;
  given: number;
  thinned: boolean;
  live: number;
  recorded: number;
  least: number;
  largest: number;
  first_sclk: number;
  last_sclk: number;
  /** samples of real time that the recording holds with another value; undefined when they cannot be compared */
  differing: number | undefined;
}

export function rangeRow(series: ChannelSeries): RangeRow {
  const recordedAt = new Map<number, number>();
  let least = Infinity;
  let largest = -Infinity;
  let recorded = 0;
  series.sclk.forEach((sclk, i) => {
    const value = series.value[i] ?? NaN;
    least = value < least ? value : least;
    largest = value > largest ? value : largest;
    if (series.source[i] === SOURCE_RECORDED) {
      ++recorded;
      recordedAt.set(sclk, value);
    }
  });
  let compared = 0;
  let differing = 0;
  series.sclk.forEach((sclk, i) => {
    if (series.source[i] === SOURCE_RECORDED) return;
    const other = recordedAt.get(sclk);
    if (other === undefined) return;
    ++compared;
    if (!Object.is(other, series.value[i])) ++differing;
  });
  return {
    name: series.name, unit: series.unit, samples: Number(series.samples), given: series.sclk.length,
    thinned: series.thinned, recorded, live: series.sclk.length - recorded, least, largest,
    first_sclk: series.sclk[0] ?? NaN, last_sclk: series.sclk[series.sclk.length - 1] ?? NaN,
    differing: compared > 0 && !series.thinned ? differing : undefined,
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
    names: names.join(','), start: String(from_sclk), end: String(to_sclk), size: String(size), strategy: 'minmax',
  });
  if (csv) query.set('format', 'csv');
  return `/runs/${run}/channels?${query.toString()}`;
}
