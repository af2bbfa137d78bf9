// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { axisNumber } from '../draw/axis';
import { Series } from '../run/series';
import { aDictionary, aStore, samples } from '../testing/fixtures';
import { shortStep, shortTime, ticks, valueTicks } from '../draw/axis';
import { create } from '@bufbuild/protobuf';
import { DictionaryChannelSchema } from '../gen/aeolis/v1/run_pb';
import { align, gapOf, less, readingAt } from './model';

function series(...points: [number, number][]): Series {
  const made = new Series();
  made.append(
    Float64Array.from(points, ([x]) => x),
    Float64Array.from(points, ([, y]) => y),
  );
  return made;
}

describe('a plot', () => {
  it('breaks its line where no sample came for long', () => {
    const [x, , lit] = align(undefined, series([1, 10], [2, 20], [30, 30]), [], 0, 0, 100, Infinity, 1, 1000);
    expect(x).toEqual([1, 2, 29.999, 30]);
    expect(lit).toEqual([10, 20, null, 30]);
  });
  it('draws what only the recording knows in another colour, in one trace', () => {
    const [x, silent, lit] = align(
      series([2, 2], [3, 3], [4, 4]),
      series([1, 1], [5, 5]),
      [{ from: 1.5, to: 4.5 }],
      0,
      0,
      100,
      Infinity,
      1,
      1000,
    );
    expect(x).toEqual([1, 2, 3, 4, 5]);
    expect(silent).toEqual([1, 2, 3, 4, 5]);
    expect(lit).toEqual([1, null, null, null, 5]);
  });
  it('breaks at an undefined value, and scales units', () => {
    const [, , lit] = align(undefined, series([1, 1000], [2, NaN], [3, 3000]), [], 0, 0, 10, Infinity, 1000, 1000);
    expect(lit).toEqual([1, null, 3]);
  });
  it('less its prediction is the difference in the same unit, with a gap where nothing was predicted', () => {
    const height = create(DictionaryChannelSchema, { id: 3, unit: 'm' });
    const predicted = series([0, 1000], [10, 2000], [50, 2000]);
    const observed = align(
      undefined,
      series([5, 1600], [10, 2000], [12, NaN], [30, 9]),
      [],
      0,
      0,
      60,
      Infinity,
      1000,
      1000,
      20,
    );
    expect(less(observed, height, predicted, 0, 1000, 20)).toEqual([
      [5, 10, 12, 30],
      [null, null, null, null],
      [0.1, 0, null, null],
    ]);
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
  it('loses no peak: one sample of a thousand is drawn, high or low, wherever it stands, and stays when time goes on', () => {
    for (const [at, peak] of [
      [503.7, 12],
      [17.1, -40],
      [950, 9.5],
    ] as const) {
      const all = Array.from({ length: 8000 }, (_, i): [number, number] => [i / 8, Math.sin(i / 50)]);
      const made = series(...[...all, [at + 0.01, peak] as [number, number]].sort(([one], [other]) => one - other));
      for (let end = 1000; end < 1010; end += 0.3) {
        const [x, , lit] = align(undefined, made, [], 0, 0, end, Infinity, 1, 180);
        expect(lit).toContain(peak);
        expect(x.length).toBeLessThan(180 * 5);
      }
    }
  });
  it('draws a slow channel through its samples, and a gap where more than one is missing', () => {
    const slow = series([0, 1], [10, 2], [20, 3], [50, 4]);
    const holes = (rate: number) =>
      align(undefined, slow, [], 0, 0, 60, Infinity, 1, 180, gapOf(rate))[2].filter((value) => value === null).length;
    expect([holes(0.1), holes(1)]).toEqual([1, 3]);
  });
  it('draws the same samples while its axis grows, so that nothing flickers', () => {
    const made = series(...Array.from({ length: 8000 }, (_, i): [number, number] => [i / 8, (i * 7919) % 101]));
    const [one] = align(undefined, made, [], 0, 0, 1000, 900, 1, 180);
    const [other] = align(undefined, made, [], 0, 0, 1007.3, 900, 1, 180);
    expect(other).toEqual(one);
  });
  it('keeps a peak beside what is undefined, and a gap between samples that are thinned', () => {
    const made = series(
      ...Array.from({ length: 1000 }, (_, i): [number, number] => [
        i / 10 + (i >= 500 ? 20 : 0),
        i === 250 ? NaN : i === 251 ? 99 : 1,
      ]),
    );
    const [x, , lit] = align(undefined, made, [], 0, 0, 120, Infinity, 1, 40);
    expect(lit).toContain(99);
    expect(lit.filter((value) => value === null)).toHaveLength(2);
    expect(x[lit.lastIndexOf(null)]).toBeCloseTo(70 - 1e-3);
  });
  it('has ticks that can be read at the size of the console: at least three, none over another', () => {
    for (const [from, to] of [
      [-60, 470],
      [-60, 260],
      [200, 260],
      [30, 35],
      [-1200, 470],
      [-7200, 0],
    ] as const) {
      const step = shortStep(from, to, 190);
      const labels = ticks(from, to, step).map((e_s) => [e_s, shortTime(e_s, step)] as const);
      expect(labels.length, `${from} … ${to}: ${labels}`).toBeGreaterThanOrEqual(2);
      expect((step / (to - from)) * 190, `${labels}`).toBeGreaterThan(
        Math.max(...labels.map(([, words]) => words.length)) * 6.7,
      );
    }
    expect(ticks(-60, 470, shortStep(-60, 470, 190)).map((e_s) => shortTime(e_s, 180))).toEqual([
      'E',
      '+3:00',
      '+6:00',
    ]);
  });
  it('says under the cursor what there was, whichever way it is known, and in a gap nothing', () => {
    const altitude = aDictionary.pick(['altitude_m'])?.id as number;
    const store = aStore([
      samples(800, { [altitude]: 5 }),
      samples(801, { [altitude]: 6 }),
      samples(805, { [altitude]: 7 }, 2),
    ]);
    expect(readingAt(store, altitude, -200, Infinity)).toMatchObject({ value: 5, recorded: false });
    expect(readingAt(store, altitude, -194.5, Infinity)).toMatchObject({ value: 7, recorded: true });
    expect(readingAt(store, altitude, -150, Infinity)).toBeUndefined();
    expect(readingAt(store, altitude, -194.5, 803)).toMatchObject({ value: 6 });
  });
  it('has two round values at least on each plot, a flat or a large one too', () => {
    for (const [low, high] of [
      [57, 257],
      [77.4, 79.1],
      [0, 0.28],
      [397501234, 397501236],
      [-200, 200],
    ] as const)
      for (const high_px of [60, 90, 240]) {
        const all = valueTicks(low, high, high_px);
        expect(all.length, `${low} … ${high} on ${high_px} px: ${all}`).toBeGreaterThanOrEqual(2);
        expect(all.every((each) => each >= low && each <= high)).toBe(true);
      }
  });
  it('numbers its axis in no one’s language', () => {
    expect([6000, -200000, 0.1 + 0.2, -0.25, 0, 1e-7].map(axisNumber)).toEqual([
      '6\u2009000',
      '−200\u2009000',
      '0.3',
      '−0.25',
      '0',
      '1e-7',
    ]);
  });
});
