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
    const [x, , lit] = align(undefined, series([1, 10], [2, 20], [30, 30]), [], 0, 0, 100, Infinity, 1, 1000);
    expect(x).toEqual([1, 2, 29.999, 30]);
    expect(lit).toEqual([10, 20, null, 30]);
  });
  it('draws what only the recording knows in another colour, in one trace', () => {
    const [x, silent, lit] = align(series([2, 2], [3, 3], [4, 4]), series([1, 1], [5, 5]), [{ from: 1.5, to: 4.5 }], 0, 0, 100, Infinity, 1, 1000);
    expect(x).toEqual([1, 2, 3, 4, 5]);
    expect(silent).toEqual([1, 2, 3, 4, 5]);
    expect(lit).toEqual([1, null, null, null, 5]);
  });
  it('breaks at an undefined value, and scales units', () => {
    const [, , lit] = align(undefined, series([1, 1000], [2, NaN], [3, 3000]), [], 0, 0, 10, Infinity, 1000, 1000);
    expect(lit).toEqual([1, null, 3]);
  });
  it('shows nothing after the end of a past view', () => {
    const [x] = align(undefined, series([1, 1], [2, 2], [3, 3]), [], 0, 0, 10, 2, 1, 1000);
    expect(x).toEqual([1, 2]);
  });
  it('always draws the newest sample', () => {
    const many = series(...Array.from({ length: 1000 }, (_, i): [number, number] => [i / 100, i]));
    const [, , lit] = align(undefined, many, [], 0, 0, 100, Infinity, 1, 50);
    expect(lit.at(-1)).toBe(999);
  });
});
