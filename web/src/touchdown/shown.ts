// SPDX-License-Identifier: Apache-2.0
// Whether a touchdown has been heard of, by whatever told it, and whether its result is shown in place of the picture.
import { LAYOUT } from '../layout';
import { cutoff, runNow, signalOfRun, timepoints } from '../run/shown';
import { heardOf } from '../timeline/heard';

export const resultShown = signalOfRun(true);

export function touchedDown(): boolean {
  const run = runNow();
  const row = timepoints.value.find((each) => each.name === LAYOUT.landed);
  return run !== undefined && row !== undefined && heardOf(run, timepoints.value, cutoff.value).has(row.id);
}
