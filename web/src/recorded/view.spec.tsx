import { describe, expect, it } from 'vitest';
import { rangeProblem, rangeRow, seriesPath } from './model';

describe('a recorded range', () => {
  it('is refused upside down or unreadable, in words', () => {
    expect(rangeProblem(10, 5)).toContain('later');
    expect(rangeProblem(undefined, 5)).toContain('start');
    expect(rangeProblem(1, undefined)).toContain('end');
    expect(rangeProblem(-5, 5)).toBeUndefined();
  });
  it('counts what came live and what the recording alone has', () => {
    const columns = [
      { id: 1, recorded: false, sclk: Float64Array.of(1, 3), value: Float64Array.of(5, 7) }, { id: 1, recorded: true, sclk: Float64Array.of(2), value: Float64Array.of(-1) },
    ];
    const series = { id: 1, name: 'a', unit: '', samples: 9, thinned: true, columns };
    expect(rangeRow(series)).toMatchObject({ samples: 9, given: 3, live: 2, recorded: 1, least: -1, largest: 7, first_sclk: 1, last_sclk: 3 });
    expect(rangeRow({ ...series, columns: [] })).toMatchObject({ given: 0, first_sclk: NaN });
  });
  it('asks the route as it is documented', () => {
    expect(seriesPath(3, ['a', 'b'], 1.5, 2, 100, 'csv')).toBe('/runs/3/channels?names=a%2Cb&from=1.5&to=2&points=100&format=csv');
  });
});
