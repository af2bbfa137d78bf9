// SPDX-License-Identifier: Apache-2.0
// What is armed in this console: nobody else knows of it until it leaves, the server neither.
import { computed } from '@preact/signals';
import { isLost } from '../run/connection';
import { shownRun } from '../run/shown';
import { hazardous, stage } from './file';
import { chosen, previewNow, step } from './line';
import { arrivalOf } from './model';

/** The names of the armed commands; none: nothing is armed here. */
export const armedHere = computed<readonly string[]>(() =>
  step.value === 'armed' && chosen.value ? [chosen.value.name] : stage.value === 'armed' ? hazardous.value : [],
);

/** How long the armed command can still leave and be of use, by the ground's newest answer. */
export function armedLeft_s(): number | undefined {
  const [reply, run] = [previewNow.value, shownRun()];
  if (step.value !== 'armed' || isLost.value || !run || reply?.arrivesUs === undefined) return undefined;
  const slack_s = arrivalOf(reply, run).before?.slack_s;
  return slack_s !== undefined && slack_s > 0 ? slack_s : undefined;
}
