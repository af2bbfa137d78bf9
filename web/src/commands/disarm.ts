// SPDX-License-Identifier: Apache-2.0
// Disarms commands and files when another run or the past is shown: a name typed for one vehicle must not send to
// another.
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
