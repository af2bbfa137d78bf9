// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { pictureOf, queryOf } from './address';
import type { Picture } from './address';

/** Numbers from a seed, so that a failure can be repeated. */
function seeded(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

function anyPicture(random: () => number): Picture {
  const maybe = <T>(value: () => T): T | undefined => (random() < 0.5 ? value() : undefined);
  const pick = <T>(...all: T[]): T => all[Math.floor(random() * all.length)] as T;
  const seconds = () => pick(Math.round((random() - 0.5) * 2e6), Math.round((random() - 0.5) * 1e7) / 1000, random());
  const span = () => {
    const [a, b] = [seconds(), seconds()];
    return { from: Math.min(a, b), to: Math.max(a, b) };
  };
  const name = () => Array.from({ length: 1 + random() * 12 }, () => pick(...'aZ9_-&=?#%/~äß日')).join('');
  const list = <T>(of: () => T) => Array.from({ length: 1 + random() * 4 }, of);
  const made: Picture = {
    run: pick(0, 1, 987654321),
    past: maybe(() => ({ ...span(), recorded: random() < 0.5 })),
    span: maybe(() => pick<Picture['span']>('run', 'minute', span())),
    cursor: maybe(seconds),
    over: maybe(() => pick(1, 987654321)),
    panel: maybe(name),
    full: maybe(name),
    data: maybe(name),
    middle: maybe(name),
    low: maybe(name),
    plots: maybe(() => list(() => list(name))),
  };
  return Object.fromEntries(Object.entries(made).filter(([, value]) => value !== undefined)) as unknown as Picture;
}

describe('a link', () => {
  it('opens what it was made of, whatever that is', () => {
    const random = seeded(25);
    for (let i = 0; i < 500; ++i) {
      const picture = anyPicture(random);
      const query = queryOf(picture);
      expect(pictureOf(`?${query}`), query).toEqual({ picture, problems: [] });
      expect(query).toMatch(/^[!-~]*$/);
    }
  });
  it('reads as people write it, and of what the console comes with it says nothing', () => {
    expect(queryOf({ run: 0 })).toBe('');
    expect(
      queryOf({
        run: 3,
        past: { from: -60, to: 100.5, recorded: true },
        data: 'links',
        plots: [['altitude_m', 'radar_altitude_m'], ['mach']],
      }),
    ).toBe('run=3&past=-60,100.5&with=recording&data=links&channels=altitude_m+radar_altitude_m,mach');
  });
  it('that a program has encoded throughout opens the same', () => {
    const { plots } = pictureOf('?channels=a%20b%2Cc').picture;
    expect([plots, pictureOf('?channels=a%2Bb,c').picture.plots]).toEqual([
      [['a', 'b'], ['c']],
      [['a', 'b'], ['c']],
    ]);
  });
  it('with a part that is none says so in a line for it, and keeps the rest', () => {
    const { picture, problems } = pictureOf('?run=x&past=5,1&span=never&at=1e3&data=links&what=ever');
    expect(picture).toEqual({ run: 0, data: 'links' });
    expect(problems).toEqual([
      'run=x in the address is no number of a run',
      'past=5,1 in the address is no range in seconds from entry',
      'span=never in the address is no stretch of time',
      'at=1e3 in the address is no time in seconds from entry',
    ]);
    expect(pictureOf(`?run=${'9'.repeat(500)}`).problems[0]?.length).toBeLessThan(100);
  });
});
