// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, describe, expect, it, vi } from 'vitest';
import { aDictionary, aRun, aStore, samples, speedLimits } from '../testing/fixtures';
import { allLimitsText, isWorst, limitsAnswer, limitsAt, limitsOver, limitsText, refreshLimits } from './limits';
import { pastRange, store } from './shown';

const speed = aDictionary.pick(['speed_mps'])!;
const altitude = aDictionary.pick(['altitude_m'])!;
const isAbove = (limits: readonly { above?: number }[] | undefined) => limits?.map((limit) => limit.above);

afterEach(() => {
  [store.value, pastRange.value] = [undefined, undefined];
  vi.unstubAllGlobals();
});

describe('limits', () => {
  it('of a channel with contexts are those that the server says held then, and unknown until it has', () => {
    store.value = aStore();
    expect([limitsAt(speed, 800), limitsOver(speed, 650, 900)]).toEqual([undefined, []]);
    limitsAnswer.value = { live: false, answer: speedLimits };
    expect([799, 800, 840, 850, Infinity].map((sclk) => isAbove(limitsAt(speed, sclk)?.limits))).toEqual([
      [6000],
      [90, 120],
      [90, 120],
      [6000],
      [6000],
    ]);
    expect(
      limitsOver(speed, 650, 900).map(({ from_sclk, to_sclk, context, limits }) => [
        from_sclk,
        to_sclk,
        context,
        isAbove(limits),
      ]),
    ).toEqual([
      [650, 800, '', [6000]],
      [800, 850, 'range_control', [90, 120]],
      [850, 900, '', [6000]],
    ]);
  });
  it('of a channel without contexts always hold', () => {
    expect(isAbove(limitsAt(altitude, 0)?.limits)).toEqual([200000]);
    expect(limitsOver(altitude, 650, 900)).toHaveLength(1);
    expect(limitsOver(aDictionary.pick(['next_desired_sclk'])!, 650, 900)).toEqual([]);
  });
  it('by the recording are none of a past as it was heard', () => {
    store.value = aStore();
    limitsAnswer.value = { live: false, answer: speedLimits };
    pastRange.value = { from: 0, to: 10 };
    expect(limitsAt(speed, 800)).toBeUndefined();
  });
  it('are asked for again when a value has come that decides them, and not before', async () => {
    const asked: string[] = [];
    vi.stubGlobal('fetch', (url: string) => {
      asked.push(url);
      return Promise.resolve(new Response(JSON.stringify(speedLimits)));
    });
    store.value = aStore([samples(700, { 1: 0, 4: 1 })], aRun({ run: 77n }));
    for (let i = 0; i < 4; ++i) await refreshLimits();
    const before = asked.length;
    expect([before <= 2, asked[0]]).toEqual([true, '/api/v1/runs/77/limits']);
    store.value.addHistory([{ id: 4, sclk: Float64Array.of(710), value: Float64Array.of(2), recorded: false }]);
    await refreshLimits();
    expect(asked.length).toBe(before);
    store.value.addHistory([{ id: 1, sclk: Float64Array.of(720), value: Float64Array.of(4), recorded: false }]);
    await refreshLimits();
    await refreshLimits();
    expect(asked.length).toBe(before + 1);
    pastRange.value = { from: 0, to: 10 };
    await refreshLimits();
    expect(asked.at(-1)).toBe('/api/v1/runs/77/limits?recorded=false');
  });
  it('of distress have the colour of alarms', () => {
    expect(['watch', 'warning', 'distress', 'critical', 'severe'].map(isWorst)).toEqual([
      false,
      false,
      true,
      true,
      true,
    ]);
  });
  it('are listed, all of them with their context', () => {
    expect(limitsText(speedLimits.channels[0]!.stretches[1]!.limits)).toBe('watch > 90; distress > 120');
    expect(limitsText([{ severity: 'critical', below: -3, above: 2 }])).toBe('critical < -3 or > 2');
    expect(allLimitsText(speed)).toBe('else: watch > 6000\nin range control: watch > 90; distress > 120');
    expect(allLimitsText(altitude)).toBe('warning > 200000');
  });
});
