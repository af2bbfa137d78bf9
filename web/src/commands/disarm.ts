// SPDX-License-Identifier: Apache-2.0
// Another run, or the past, is looked at: what was armed is taken back, for a name typed to one vehicle must never send to another.
import { effect, untracked } from '@preact/signals';
import { pastRange, store } from '../run/shown';
import { disarmFile } from './file';
import { disarm } from './line';

let run = store.peek()?.id;

effect(() => {
  const now = store.value?.id;
  void pastRange.value;
  untracked(() => {
    disarm(now !== run);
    disarmFile(now !== run);
    run = now;
  });
});
