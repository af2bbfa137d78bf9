// SPDX-License-Identifier: Apache-2.0
// The prediction of the run that is shown, and how the command in the form would move it.
import { computed } from '@preact/signals';
import { fields, chosen } from '../commands/line';
import { anchors, cutoff, dictionary, shownRun, tick, timepoints } from '../run/shown';
import { anchorTree } from './anchors';
import type { AnchorLine } from './anchors';
import { changeOf, changesMade, movedBy, predictions } from './predict';
import type { Moved, Prediction } from './predict';

/** As the design had them when the run began. */
const predictedAnchors = computed(() =>
  anchors.value.flatMap(({ name, predictedES }) => (predictedES === undefined ? [] : [[name, predictedES] as const])),
);

export const predicted = computed<Prediction[]>(() => {
  void tick.value;
  const run = shownRun();
  return run
    ? predictions(
        run,
        timepoints.value,
        predictedAnchors.value,
        cutoff.value,
        changesMade(run, anchors.value, cutoff.value),
      )
    : [];
});

/** Before it is sent: what it would move. Undefined where the chosen command moves nothing by its kind. */
export const moved = computed<Moved[] | undefined>(() => {
  const [run, command] = [shownRun(), chosen.value];
  if (!run || !command) return undefined;
  const values = new Map(
    fields.value.flatMap((field) =>
      field.value === undefined || field.problem !== undefined ? [] : [[field.argument.name, field.value] as const],
    ),
  );
  const change = changeOf(command.name, values, run, anchors.value);
  return (
    change &&
    movedBy(
      predicted.value,
      predictions(run, timepoints.value, predictedAnchors.value, cutoff.value, [
        ...changesMade(run, anchors.value, cutoff.value),
        change,
      ]),
    )
  );
});

export const anchorLines = computed<AnchorLine[]>(() => {
  void tick.value;
  const [run, words] = [shownRun(), dictionary.value];
  return run && words
    ? anchorTree(
        run,
        words,
        anchors.value,
        timepoints.value,
        predictedAnchors.value,
        cutoff.value,
        changesMade(run, anchors.value, cutoff.value),
      )
    : [];
});
