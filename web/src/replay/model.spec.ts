// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, describe, expect, it } from 'vitest';
import { useForTest } from '../run/session';
import { cutoff, modeNow, pastRange, replay, takesCommands } from '../run/shown';
import { aDictionary, aRun, aStore, ertUs } from '../testing/fixtures';
import { advanced, changeReplayPace, playOrHold, startReplay, step, toggleReplay } from './model';

const FIVE = ertUs('2012-219T05:00:00.0');
const run = () => aRun({ clocks: { sclk: 1300, seenSclk: 1300, eS: 300, ertUs: FIVE, scetUs: FIVE } });

afterEach(() => {
  replay.value = undefined;
  pastRange.value = undefined;
});

describe('a replay', () => {
  it('goes at its pace and stops where what is known ends', () => {
    expect(advanced(10, 0.5, 20, 100)).toEqual({ at: 20, ended: false });
    expect(advanced(95, 0.5, 20, 100)).toEqual({ at: 100, ended: true });
  });
  it('is a past view of its own name in which nothing can be sent and nothing later is shown', () => {
    useForTest(aStore([], run()), aDictionary);
    startReplay();
    expect([modeNow(), takesCommands(), cutoff.value]).toEqual(['replay', false, 940]);
    step(2);
    expect(cutoff.value).toBe(960);
    toggleReplay();
    expect([modeNow(), takesCommands(), cutoff.value]).toEqual(['rehearsal', true, Infinity]);
  });
  it('holds, and begins again after its end', () => {
    useForTest(aStore([], run()), aDictionary);
    startReplay();
    playOrHold();
    step(5);
    expect(pastRange.value?.to).toBe(-60);
    playOrHold();
    changeReplayPace(1);
    step(1000);
    expect([pastRange.value?.to, replay.value?.playing]).toEqual([300, false]);
    playOrHold();
    expect([pastRange.value?.to, replay.value?.pace]).toEqual([-60, 20]);
  });
});
