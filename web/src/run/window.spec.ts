// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, describe, expect, it } from 'vitest';
import { aStore } from '../testing/fixtures';
import { pastRange, replay } from './shown';
import { choice, pan, plotSpan, spanNow, zoom, zoomedTo } from './window';

describe('a fixed range', () => {
  const run = aStore();
  afterEach(() => {
    [pastRange.value, replay.value, choice.value] = [undefined, undefined, 'landing'];
  });
  it('is zoomed and panned within itself, and is whole again once it was left', () => {
    pastRange.value = { from: 0, to: 100 };
    expect([spanNow(run), zoomedTo()]).toEqual([{ from: 0, to: 100 }, undefined]);
    zoom(run, 0.5, 20);
    expect([spanNow(run), plotSpan(run), zoomedTo()]).toEqual(Array(3).fill({ from: 10, to: 60 }));
    pan(run, 0.25);
    expect(spanNow(run)).toEqual({ from: 22.5, to: 72.5 });
    for (let i = 0; i < 9; ++i) pan(run, 0.25);
    expect(spanNow(run)).toEqual({ from: 50, to: 100 });
    for (let i = 0; i < 9; ++i) pan(run, -0.25);
    expect(spanNow(run)).toEqual({ from: 0, to: 50 });
    zoom(run, 4);
    expect(spanNow(run)).toEqual({ from: 0, to: 100 });
    zoom(run, 0.5);
    expect([spanNow(run), choice.value]).toEqual([{ from: 25, to: 75 }, 'landing']);
    pastRange.value = { from: 0, to: 100 };
    expect(spanNow(run)).toEqual({ from: 0, to: 100 });
  });
  it('leaves what was zoomed to before where it was', () => {
    zoom(run, 0.1, 50);
    const before = spanNow(run);
    pastRange.value = { from: 0, to: 100 };
    expect(spanNow(run)).toEqual({ from: 0, to: 100 });
    zoom(run, 0.5);
    pastRange.value = undefined;
    expect(spanNow(run)).toEqual(before);
  });
});
