// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { limitsAnswer } from '../run/limits';
import { store } from '../run/shown';
import { recordedStaleness } from '../run/staleness';
import { aDictionary, aRun, aStore, alarm, samples, speedLimits, staleness } from '../testing/fixtures';
import { channelRow, channelsShown, staleWords } from './model';

function row(store: ReturnType<typeof aStore>, name: string, cutoff = Infinity, lost = false) {
  const channel = aDictionary.pick([name]);
  return channel && channelRow(store, channel, cutoff, lost);
}

describe('channels', () => {
  it('say label, unit and age in stream time', () => {
    const store = aStore([samples(899, { 1: 4, 2: 5, 5: 1 })]);
    expect(row(store, 'edl_phase')).toMatchObject({ value: 'range control', age: '1.0 s', look: 'good' });
  });
  // SCLK 900 is 05:00:00 on Earth.
  const silent = staleness({ packet: 'Navigation', stale: true, ert: '2012-219T04:59:00.0' });
  const heardAgain = staleness({ packet: 'Navigation', ert: '2012-219T04:59:30.0' });

  it('are stale when the ground says so of their packet, however old they are, and until it says otherwise', () => {
    expect(row(aStore([samples(500, { 3: 1, 4: 1 })]), 'altitude_m')?.look).toBe('good');
    expect(row(aStore([samples(839, { 3: 1, 4: 1 }), silent]), 'altitude_m')?.look).toBe('stale');
    const again = aStore([samples(839, { 1: 4, 3: 1 }), silent, heardAgain]);
    expect([839, 840, 869, 870].map((cutoff) => row(again, 'altitude_m', cutoff)?.look)).toEqual([
      'good',
      'stale',
      'stale',
      'good',
    ]);
    expect(row(again, 'edl_phase', 840)?.look).toBe('good'); // of another packet
  });
  it('are all stale after the run, and while there is no connection; a past view still knows what was said then', () => {
    const fresh = samples(899, { 3: 1, 4: 1 });
    expect(row(aStore([fresh], aRun({ state: 'finished' })), 'altitude_m')?.look).toBe('stale');
    expect(row(aStore([fresh], aRun({ state: 'finished' })), 'altitude_m', 899)?.look).toBe('good');
    expect([false, true].map((lost) => row(aStore([fresh]), 'altitude_m', Infinity, lost)?.look)).toEqual([
      'good',
      'stale',
    ]);
    expect(row(aStore([fresh]), 'altitude_m', 899, true)?.look).toBe('good');
  });
  it('known by the recording are stale when the server says so, whatever was heard live, and until it has said', () => {
    const run = aStore([samples(830, { 3: 1 }), silent]);
    run.addHistory([
      { id: 3, sclk: new Float64Array([848, 849, 870]), value: new Float64Array([2, 2, 2]), recorded: true },
    ]);
    const looks = (...cutoffs: number[]) => cutoffs.map((cutoff) => row(run, 'altitude_m', cutoff)?.look);
    store.value = run;
    expect(looks(849, 854, 899)).toEqual(['stale', 'stale', 'stale']);
    recordedStaleness.value = {
      packets: [{ packet: 'Navigation', stretches: [{ from_sclk: 855, to_sclk: 868 }, { from_sclk: 869 }] }],
    };
    // between 868 and 870 the history held is thinned; at 870 there is more than the server had when it answered
    expect(looks(849, 854, 856, 868.5, 870, 899)).toEqual(['good', 'good', 'stale', 'good', 'good', 'good']);
    recordedStaleness.value = { packets: [{ packet: 'Navigation', stretches: [{ from_sclk: 875 }] }] };
    expect(looks(870, 874, 876)).toEqual(['good', 'good', 'stale']);
    recordedStaleness.value = { packets: [] }; // of a packet without a rate none is too old
    expect(looks(899)).toEqual(['good']);
    store.value = undefined;
  });
  it('give every figure the same judgement, with its age in words', () => {
    const words = (store: ReturnType<typeof aStore>, cutoff = Infinity, lost = false) =>
      staleWords(store, aDictionary.pick(['altitude_m']), cutoff, lost);
    const old = aStore([samples(838, { 3: 1 }), silent]);
    expect([words(old), words(old, 839), words(old, 858), words(old, 839, true)]).toEqual([
      '◌ 1 m 02 s',
      undefined,
      '◌ 20 s',
      undefined,
    ]);
    expect([words(aStore([samples(900, { 3: 1 })]), Infinity, true), words(aStore())]).toEqual(['◌ 0 s', undefined]);
  });
  it('say that nothing came once they were asked for, and that a value is undefined', () => {
    const store = aStore();
    expect(row(store, 'altitude_m')).toMatchObject({ value: '—', look: 'unasked' });
    store.addHistory([], ['altitude_m']);
    expect([row(store, 'altitude_m'), row(store, 'speed_mps')]).toMatchObject([
      { value: '—', look: 'never' },
      { look: 'unasked' },
    ]);
    expect(row(aStore([samples(900, { 3: 1, 4: NaN })]), 'speed_mps')?.value).toBe('undefined');
  });
  it('have in a past view the alarms that the ground had raised by then, and judge nothing themselves', () => {
    const store = aStore([
      samples(800, { 3: 300000, 4: 1 }),
      alarm({ channel: 3, severity: 'warning', sclk: 800 }),
      samples(860, { 3: 5, 4: 1 }),
      alarm({ channel: 3, severity: 'none', sclk: 860 }),
      samples(900, { 3: 300000, 4: 1 }),
    ]);
    expect([799, 800, 859, 860, Infinity].map((cutoff) => row(store, 'altitude_m', cutoff)?.look)).toEqual([
      'unasked',
      'caution',
      'caution',
      'good',
      'good',
    ]);
  });
  it('say in a past view the limits that the server says held then, and nothing of its own before that', () => {
    const run = aStore();
    store.value = run;
    expect([row(run, 'altitude_m')?.limits, row(run, 'speed_mps')?.limits]).toEqual([
      'warning > 200000',
      'not known yet',
    ]);
    limitsAnswer.value = { live: false, answer: speedLimits };
    expect([799, 800, 850, Infinity].map((cutoff) => row(run, 'speed_mps', cutoff)?.limits)).toEqual([
      'watch > 6000',
      'watch > 90; distress > 120',
      'watch > 6000',
      'watch > 6000',
    ]);
    store.value = undefined;
  });
  it('are found by any of their words', () => {
    expect(channelsShown(aDictionary, 'gnc speed')).toMatchObject({ total: 1, channels: [{ name: 'speed_mps' }] });
  });
});
