// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { aDictionary, aStore, samples } from '../testing/fixtures';
import { allLimitsText, contextAt, isWorst, limitsIn, limitsOver, limitsText } from './limits';

const speed = aDictionary.pick(['speed_mps'])!;
const altitude = aDictionary.pick(['altitude_m'])!;
/** Late cruise to SCLK 800, then range control to 850, then landed. */
const flown = aStore([
  samples(700, { 1: 0 }),
  samples(799, { 1: 0 }),
  samples(800, { 1: 4 }),
  samples(849, { 1: 4 }),
  samples(850, { 1: 9 }),
  samples(899, { 1: 9 }),
]);

describe('limits', () => {
  it('of a context hold in it and nowhere else; where none holds, those without one', () => {
    const at = (sclk: number) => limitsIn(speed, contextAt(flown, aDictionary, sclk)).map((limit) => limit.above);
    expect([at(799), at(800), at(840), at(850)]).toEqual([[6000], [90, 120], [90, 120], [6000]]);
    expect(limitsIn(speed, undefined).map((limit) => limit.above)).toEqual([6000]);
  });
  it('of a plot are stretches, each with its context; a change of state that changes no limit is none', () => {
    expect(
      limitsOver(flown, aDictionary, speed, 650, 900).map(({ from_sclk, to_sclk, context, limits }) => [
        from_sclk,
        to_sclk,
        context,
        limits.map((limit) => limit.above),
      ]),
    ).toEqual([
      [650, 800, undefined, [6000]],
      [800, 850, 'range_control', [90, 120]],
      [850, 900, 'landed', [6000]],
    ]);
    expect(limitsOver(flown, aDictionary, altitude, 650, 900)).toHaveLength(1);
    expect(limitsOver(flown, aDictionary, aDictionary.pick(['next_desired_sclk'])!, 650, 900)).toEqual([]);
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
  it('are listed as they hold now, and all of them with their context', () => {
    expect(limitsText(limitsIn(speed, 'range_control'))).toBe('watch > 90; distress > 120');
    expect(allLimitsText(speed)).toBe('else: watch > 6000\nin range control: watch > 90; distress > 120');
    expect(allLimitsText(altitude)).toBe('warning > 200000');
  });
});
