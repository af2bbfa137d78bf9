// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Pace } from './pace';

describe('a pace', () => {
  it('lets the first through at once, and the others every so often on the average, however late some come', () => {
    const pace = new Pace(50, 30);
    expect(pace.wait(1000)).toBe(0);
    let taken = 0;
    for (let now = 1000; now < 11_000; now += 7) {
      if (pace.wait(now) > 0) continue;
      pace.took(now);
      ++taken;
    }
    expect(taken).toBeGreaterThanOrEqual(195);
    expect(taken).toBeLessThanOrEqual(201);
  });
  it('after one that came late lets the next come sooner, but not too soon', () => {
    const pace = new Pace(50, 30);
    pace.took(0);
    expect(pace.wait(0)).toBe(30);
    pace.took(30);
    expect(pace.wait(30)).toBe(50);
    pace.took(95); // 15 late
    expect(pace.wait(95)).toBe(35);
    pace.took(1000);
    expect(pace.wait(1000)).toBe(30);
  });
});
