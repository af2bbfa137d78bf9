// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { RunStore } from '../run/store';
import { aRun } from '../testing/fixtures';

let next: FrameRequestCallback = () => undefined;
let now_ms = 0;
const FRAME_MS = 16;
const frames = (count: number) => {
  for (let i = 0; i < count; ++i) {
    now_ms += FRAME_MS;
    next(now_ms);
  }
};
const column = (sclk: number) => ({ id: 3, recorded: false, sclk: Float64Array.of(sclk), value: Float64Array.of(1) });
let onDraw: typeof import('./loop').onDraw;
let run: RunStore;
let shown: typeof import('../run/shown');

beforeEach(async () => {
  vi.stubGlobal('requestAnimationFrame', (then: FrameRequestCallback) => (next = then));
  vi.resetModules();
  const loop = await import('./loop');
  shown = await import('../run/shown');
  ({ onDraw } = loop);
  shown.store.value = run = new RunStore(aRun());
  loop.startLoop();
  now_ms = 1000;
});

describe('the loop', () => {
  it('draws at the next frame what begins to be shown', () => {
    onDraw(() => undefined);
    frames(1);
    let drawn = 0;
    onDraw(() => () => ++drawn);
    frames(1);
    expect(drawn).toBe(1);
  });
  it('draws the first sample of a run at the next frame, though it looked a moment ago when there was none', () => {
    let drawn = 0;
    onDraw(() => () => ++drawn);
    frames(1);
    expect(drawn).toBe(1);
    run.addHistory([column(900)]);
    frames(1);
    expect(drawn).toBe(2);
  });
  it('lets numbers wait for the frame after the one that answers a key, but not for ever while a key is held', () => {
    frames(1);
    run.addHistory([column(900)]);
    frames(1);
    const before = shown.tick.value;
    run.addHistory([column(901)]);
    for (let i = 0; i < 14; ++i) {
      window.dispatchEvent(new KeyboardEvent('keydown', { key: '?' }));
      frames(1);
    }
    expect(shown.tick.value).toBe(before);
    frames(1);
    expect(shown.tick.value).toBe(before + 1);
    run.addHistory([column(902)]);
    for (let i = 0; i < 30; ++i) {
      window.dispatchEvent(new KeyboardEvent('keydown', { key: '?' }));
      frames(1);
    }
    expect(shown.tick.value).toBe(before + 2);
  });
  it('lets all look at their sizes before any draws, so that the page is laid out once', () => {
    const did: string[] = [];
    for (const name of ['a', 'b']) {
      onDraw(() => {
        did.push(`look ${name}`);
        return () => did.push(`draw ${name}`);
      });
    }
    frames(1);
    expect(did).toEqual(['look a', 'look b', 'draw a', 'draw b']);
  });
  it('draws samples as often as they come, and no oftener than it must', () => {
    let drawn = 0;
    onDraw(() => () => ++drawn);
    for (let i = 0; i < 60; ++i) {
      run.addHistory([column(900 + i)]);
      frames(1);
    }
    expect(drawn).toBeGreaterThanOrEqual(18);
    expect(drawn).toBeLessThanOrEqual(24);
  });
  it('goes on at the next frame where drawing takes long, and leaves out what is no longer shown', () => {
    const did: string[] = [];
    let clock_ms = 0;
    vi.spyOn(performance, 'now').mockImplementation(() => clock_ms);
    const stops = ['a', 'b', 'c'].map((name) => {
      let drawn = false;
      return onDraw(() =>
        drawn
          ? undefined
          : () => {
              drawn = true;
              clock_ms += 15;
              did.push(name);
            },
      );
    });
    frames(1);
    expect(did).toEqual(['a']);
    stops[1]?.();
    frames(1);
    expect(did).toEqual(['a', 'c']);
    vi.mocked(performance.now).mockRestore();
  });
  it('gives the rows of long tables a frame of their own, after the numbers', () => {
    const seen: [number, number][] = [];
    for (let i = 0; i < 40; ++i) {
      run.update(aRun());
      frames(1);
      seen.push([shown.tick.value, shown.rowsTick.value]);
    }
    const changes = seen
      .slice(1)
      .map(([tick, rows], i) => [tick - (seen[i] as [number, number])[0], rows - (seen[i] as [number, number])[1]]);
    expect(changes.every(([tick, rows]) => !(tick && rows))).toBe(true);
    expect([seen.at(-1)?.[0], seen.at(-1)?.[1]].every((count) => (count ?? 0) >= 3)).toBe(true);
  });
});
