// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { limitsAnswer } from '../run/limits';
import { store } from '../run/shown';
import { aDictionary, aRun, aStore, alarm, samples, speedLimits } from '../testing/fixtures';
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
  it('are stale when they should have come', () => {
    expect(row(aStore([samples(880, { 3: 1, 4: 1 })]), 'altitude_m')?.look).toBe('stale');
  });
  it('are stale at the instant that is shown, after the run as well, and all of them while nothing comes', () => {
    const [old, going] = [
      [samples(500, { 3: 1, 4: 1 }), samples(501, { 3: 1, 4: 1 })],
      aStore([samples(899, { 3: 1, 4: 1 })]),
    ];
    expect([row(aStore(old), 'altitude_m', 502)?.look, row(aStore(old), 'altitude_m', 520)?.look]).toEqual([
      'good',
      'stale',
    ]);
    expect(row(aStore(old, aRun({ state: 'finished' })), 'altitude_m')?.look).toBe('stale');
    expect([false, true].map((lost) => row(going, 'altitude_m', Infinity, lost)?.look)).toEqual(['good', 'stale']);
  });
  it('give every figure the same judgement, with its age in words', () => {
    const words = (store: ReturnType<typeof aStore>, cutoff = Infinity, lost = false) =>
      staleWords(store, aDictionary.pick(['altitude_m']), cutoff, lost);
    expect([896, 898].map((sclk) => words(aStore([samples(sclk, { 3: 1 })])))).toEqual(['◌ 4 s', undefined]);
    const old = aStore([samples(500, { 3: 1 }), samples(501, { 3: 1 })]);
    expect([words(old), words(old, 502), words(old, 520), words(old, 502, true)]).toEqual([
      '◌ 6 m 39 s',
      undefined,
      '◌ 19 s',
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
