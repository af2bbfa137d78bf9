// SPDX-License-Identifier: Apache-2.0
// A forecast with a command that is being reviewed, and without it.
import { signal } from '@preact/signals';
import type { CommandIntent } from '../stream/messages';
import { wordsFor } from '../run/api';
import { change } from '../run/connection';
import { notify } from '../run/shown';
import { showAt } from '../places/model';

export const CASES = 32;

/** Counts what was asked from elsewhere, so that the panel *What if* looks for it at once. */
export const asksElsewhere = signal(0);
/** Whether one is being asked for. */
export const flyingOut = signal(false);

/** Asks for it by what ground heard until now, and shows the panel with it; else says why it is not to be had. */
export async function flyOut(
  run: number,
  { command, arguments: given, fromSolution, releaseAt }: CommandIntent,
): Promise<void> {
  if (flyingOut.value) return;
  flyingOut.value = true;
  try {
    await change(`/runs/${run}/forecasts`, {
      from: 'telemetry',
      cases: CASES,
      commands: [
        { command, arguments: given, from_solution: fromSolution, ...(releaseAt && { release_at: releaseAt }) },
      ],
    });
    asksElsewhere.value += 1;
    showAt('data', 'what_if');
  } catch (error) {
    notify(`no forecast: ${wordsFor(error)}`);
  } finally {
    flyingOut.value = false;
  }
}
