// SPDX-License-Identifier: Apache-2.0
// Whether a touchdown has been heard of, by whatever told it, what the server judges of it, and whether its result is
// shown in place of the picture.
import { computed } from '@preact/signals';
import { LAYOUT } from '../layout';
import { asHeard, cutoff, runNow, signalOfRun, timepoints } from '../run/shown';
import { heardOf } from '../timeline/heard';

/** In the API's words (schema/aeolis/v1/touchdown.proto). */
export interface TouchdownStep {
  name: string;
  state: 'done' | 'waiting' | 'unknown' | 'never' | 'contradicted';
  words: string;
}
export interface TouchdownReport {
  verdict: 'untold' | 'reported' | 'confirmed' | 'contradicted';
  sclk?: number;
  steps: readonly TouchdownStep[];
  figures: readonly { name: string; channel: string; unit: string; value?: number; before_s: number }[];
  place?: { east_m: number; north_m: number; inside_ellipse?: boolean; rests_on: string };
  place_unknown: string;
}

/** `at`: SCLK, Infinity for now. `live`: without what only the recording brought. */
export const touchdownAnswer = signalOfRun<{ at: number; live: boolean; report: TouchdownReport } | undefined>(
  undefined,
);
/** The newest answer, unless it belongs to another view of the run or knows later data than the instant shown. */
export const touchdownKnown = computed(() => {
  const answer = touchdownAnswer.value;
  const fits = answer?.live === asHeard.value && answer.at <= cutoff.value;
  return fits && (cutoff.value !== Infinity || answer.at === Infinity) ? answer.report : undefined;
});

export const resultShown = signalOfRun(true);

export function touchedDown(): boolean {
  const run = runNow();
  const row = timepoints.value.find((each) => each.name === LAYOUT.landed);
  return run !== undefined && row !== undefined && heardOf(run, timepoints.value, cutoff.value).has(row.id);
}
