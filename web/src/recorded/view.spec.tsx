import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ChannelSeriesSchema } from '../gen/aeolis/v1/run_pb';
import { rangeProblem, rangeRow, seriesPath } from './model';

describe('a recorded range', () => {
  it('is refused upside down or unreadable, in words', () => {
    expect(rangeProblem(10, 5)).toContain('later');
    expect(rangeProblem(undefined, 5)).toContain('start');
    expect(rangeProblem(1, undefined)).toContain('end');
    expect(rangeProblem(-5, 5)).toBeUndefined();
  });
  it('counts what came live and what the recording alone has', () => {
    const series = create(ChannelSeriesSchema, { name: 'a', samples: 3n, sclk: [1, 2, 3], value: [5, -1, 7], source: [1, 2, 1] });
    expect(rangeRow(series)).toMatchObject({ live: 2, recorded: 1, least: -1, largest: 7, first_sclk: 1, last_sclk: 3 });
  });
  it('asks the route as it is documented', () => {
    expect(seriesPath(3, ['a', 'b'], 1.5, 2, 100, true)).toBe('/runs/3/channels?names=a%2Cb&from=1.5&to=2&points=100&format=csv');
  });
});
