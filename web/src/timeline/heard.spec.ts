// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { aPlan, aStore, firing } from '../testing/fixtures';
import { heardOf } from './heard';

it('what was heard is worked out once for all who ask, and anew once something came, for another run or another instant', () => {
  const store = aStore([firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500 })]);
  const heard = heardOf(store, aPlan, Infinity);
  expect([...heard.keys()]).toEqual([0]);
  expect(heardOf(store, aPlan, Infinity)).toBe(heard);
  expect(heardOf(store, aPlan, 400).size).toBe(0);
  expect(heardOf(aStore(), aPlan, Infinity).size).toBe(0);
  expect(heardOf(store, [...aPlan], Infinity)).toEqual(heard);
  store.add({
    run: 1,
    completeThrough: 9,
    facts: [
      {
        kind: 'timepoint',
        seq: 9,
        ert_s: NaN,
        fact: { ...store.firings.get(0)!.live!, timepoint: 1, name: 'entry_interface', firedSclk: 900 },
      },
    ],
    columns: [],
    thinned: false,
    clocks: undefined,
  });
  expect([...heardOf(store, aPlan, Infinity).keys()]).toEqual([0, 1]);
});
