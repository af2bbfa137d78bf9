import { describe, expect, it } from 'vitest';
import { aDictionary, aStore, samples } from '../testing/fixtures';
import { channelRows } from './model';

const row = (store: ReturnType<typeof aStore>, name: string, cutoff = Infinity) =>
  channelRows(store, aDictionary, name, cutoff).rows[0];

describe('channels', () => {
  it('say label, unit and age in stream time', () => {
    const store = aStore([samples(899, { 1: 4, 2: 5, 5: 1 })]);
    expect(row(store, 'edl_phase')).toMatchObject({ value: 'range control', age: '1.0 s', look: 'good' });
  });
  it('are stale when they should have come', () => {
    expect(row(aStore([samples(880, { 3: 1, 4: 1 })]), 'altitude_m')?.look).toBe('stale');
  });
  it('say that nothing came, and that a value is undefined', () => {
    expect(row(aStore(), 'altitude_m')).toMatchObject({ value: '—', look: 'never' });
    expect(row(aStore([samples(900, { 3: 1 })]), 'speed_mps')?.value).toBe('undefined');
  });
  it('judge the limits anew in a past view', () => {
    const store = aStore([samples(800, { 3: 300000, 4: 1 }), samples(900, { 3: 5, 4: 1 })]);
    expect(row(store, 'altitude_m', 850)?.look).toBe('caution');
    expect(row(store, 'altitude_m')?.look).toBe('good');
  });
  it('are found by any of their words', () => {
    expect(channelRows(undefined, aDictionary, 'gnc speed', Infinity)).toMatchObject({ total: 1, rows: [{ name: 'speed_mps' }] });
  });
});
