// SPDX-License-Identifier: Apache-2.0
// The server's prediction for the run shown, and the effect of the command in the form.
import { computed } from '@preact/signals';
import { pastRange, shownRun, tick } from '../run/shown';
import { anchorTree } from './anchors';
import type { AnchorLine } from './anchors';
import { timelineKnown, timelineQuestion } from './asked';
import type { TimepointList } from '../gen/aeolis/v1/run_pb';
import type { Moved, Prediction } from './model';

export const predicted = computed<Prediction[]>(() => {
  const list = timelineKnown.value?.list;
  return list ? predictionsOf(list) : [];
});

/**
 * The times at which the server expects them, by the flights of ground's plan where they are made: what is overdue
 * keeps its own, since no later one is known.
 */
export const predictionsOf = ({ timepoints }: Pick<TimepointList, 'timepoints'>): Prediction[] =>
  timepoints.flatMap(({ id, name, expectedES, heardBy, flights, flightsES, flightsFromES, flightsToES }) => {
    const e_s = flightsES ?? expectedES;
    if (e_s === undefined) return [];
    const within =
      flightsFromES === undefined || flightsToES === undefined
        ? undefined
        : { from_e_s: flightsFromES, to_e_s: flightsToES };
    const byFlights = flightsES === undefined ? {} : { flights, ...(within && { within }) };
    return [{ id, name, e_s, fired: heardBy !== '', ...byFlights }];
  });

const BEHIND_S = 5; // chosen: a smaller delay is not worth a word

/** The instant of the prediction in seconds from entry, if the display has advanced beyond it. */
export const predictedAsOf = computed<number | undefined>(() => {
  void tick.value;
  const known_e_s = timelineKnown.value?.list.knownAtES;
  const shown_e_s = pastRange.value?.to ?? shownRun()?.seenE;
  return known_e_s !== undefined && shown_e_s !== undefined && shown_e_s - known_e_s > BEHIND_S ? known_e_s : undefined;
});

/**
 * The timepoints that the command in the form would move. Undefined if it moves none by its kind, and until the server
 * has answered.
 */
export const moved = computed<Moved[] | undefined>(() => {
  const known = timelineKnown.value;
  if (!known?.list.commandMoves || known.asked.command !== timelineQuestion.value.command) return undefined;
  return known.list.timepoints.flatMap(({ id, name, predictedES, movedES }) =>
    predictedES === undefined || movedES === undefined ? [] : [{ id, name, from_e_s: predictedES, to_e_s: movedES }],
  );
});

export const anchorLines = computed<AnchorLine[]>(() => {
  const list = timelineKnown.value?.list;
  return list ? anchorTree(list.anchors, list.timepoints) : [];
});
