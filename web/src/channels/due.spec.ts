// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { effect } from '@preact/signals';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { rowsTick as tick } from '../run/shown';
import { sight, whenDue } from './due';

let shown: Map<number, number>;
const stops: (() => void)[] = [];
function rows(...places: number[]): void {
  shown = new Map(places.map((place) => [place, -1]));
  for (const place of places)
    stops.push(
      effect(() => {
        whenDue(place);
        shown.set(place, tick.peek());
      }),
    );
}
const ticks = (count: number) => {
  for (let i = 0; i < count; ++i) tick.value += 1;
};

beforeEach(() => vi.useFakeTimers());
afterEach(() => {
  for (const stop of stops.splice(0)) stop();
  sight.value = { from: 0, to: Infinity };
  vi.useRealTimers();
});

it('a row in sight follows each tick, one out of sight takes its turn', () => {
  sight.value = { from: 16, to: 30 };
  rows(0, 16, 29, 200);
  for (let i = 0; i < 40; ++i) {
    ticks(1);
    expect([16, 29].map((place) => shown.get(place))).toEqual([tick.value, tick.value]);
    for (const place of [0, 200]) expect(tick.value - (shown.get(place) as number)).toBeLessThan(8);
  }
  const late = [...shown].filter(([place, at]) => (place === 0 || place === 200) && at < tick.value);
  expect(late.length).toBeGreaterThan(0);
});
it('a row that comes into sight is shown at once, and all are once nothing changes any more', () => {
  sight.value = { from: 0, to: 8 };
  rows(0, 160, 170, 180);
  ticks(3);
  sight.value = { from: 160, to: 168 };
  expect(shown.get(160)).toBe(tick.value);
  ticks(5);
  vi.advanceTimersByTime(1100);
  expect([...shown.values()]).toEqual(Array(4).fill(tick.value));
});
it('before it is known what is in sight, all rows are', () => {
  rows(0, 299);
  ticks(1);
  expect([...shown.values()]).toEqual([tick.value, tick.value]);
});
