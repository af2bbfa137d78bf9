import { describe, expect, it } from 'vitest';
import { Series } from '../run/series';
import { align } from './model';

function series(...points: [number, number][]): Series {
  const made = new Series();
  made.append(Float64Array.from(points, ([x]) => x), Float64Array.from(points, ([, y]) => y));
  return made;
}

describe('a plot', () => {
  it('breaks its line where no sample came for long', () => {
    const [x, , live] = align(undefined, series([1, 10], [2, 20], [30, 30]), 0, 0, 100, Infinity, 1, 1000);
    expect(x).toEqual([1, 2, 29.999, 30]);
    expect(live).toEqual([10, 20, null, 30]);
  });
  it('draws the recording through where real time was silent', () => {
    const [, all, live] = align(series([2, 2], [3, 3], [4, 4], [5, 5], [6, 6], [7, 7], [8, 8], [9, 9]), series([1, 1], [10, 10]), 0, 0, 100, Infinity, 1, 1000);
    expect(all.filter((value) => value !== undefined)).toEqual([1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    expect(live.filter((value) => value !== undefined)).toEqual([1, ...Array<null>(8).fill(null), 10]);
  });
  it('breaks at an undefined value, and scales units', () => {
    const [, , live] = align(undefined, series([1, 1000], [2, NaN], [3, 3000]), 0, 0, 10, Infinity, 1000, 1000);
    expect(live).toEqual([1, null, 3]);
  });
  it('shows nothing after the end of a past view', () => {
    const [x] = align(undefined, series([1, 1], [2, 2], [3, 3]), 0, 0, 10, 2, 1, 1000);
    expect(x).toEqual([1, 2]);
  });
  it('always draws the newest sample', () => {
    const many = series(...Array.from({ length: 1000 }, (_, i): [number, number] => [i / 100, i]));
    const [, , live] = align(undefined, many, 0, 0, 100, Infinity, 1, 50);
    expect(live.at(-1)).toBe(999);
  });
});
