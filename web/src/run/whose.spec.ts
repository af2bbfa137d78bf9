// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { aDictionary, aStore, firing, samples } from '../testing/fixtures';
import { channelRow } from '../channels/model';
import { whoseAt } from './whose';

it('after touchdown height and speed are the descent stage’s, and the table of channels says so; before, and of others, the vehicle’s', () => {
  const store = aStore([
    firing({ timepoint: 9, name: 'touchdown', firedSclk: 880 }),
    samples(890, { 3: 140, 4: 47, 5: 1 }),
  ]);
  expect([870, 881, Infinity].map((sclk) => whoseAt(store, 'altitude_m', sclk))).toEqual([
    undefined,
    'descent stage',
    'descent stage',
  ]);
  expect([whoseAt(store, 'parameters_received', Infinity), whoseAt(aStore(), 'altitude_m', Infinity)]).toEqual([
    undefined,
    undefined,
  ]);
  const whose = (cutoff: number) => channelRow(store, aDictionary.pick(['altitude_m'])!, cutoff).whose;
  expect([whose(Infinity), whose(870)]).toEqual(['descent stage', undefined]);
});
