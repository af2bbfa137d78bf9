// The prediction of the run that is shown, and how the command in the form would move it.
import { computed } from '@preact/signals';
import { fields, chosen } from '../commands/line';
import { anchors, cutoff, dictionary, store, tick, timepoints } from '../run/session';
import { changeOf, changesMade, movedBy, predictions } from './predict';
import type { Moved, Prediction } from './predict';

const predictedAnchors = computed(() => (dictionary.value?.reply.predictedAnchors ?? []).map((each) => [each.anchor, each.afterEntryS] as const));

export const predicted = computed<Prediction[]>(() => {
  void tick.value;
  const run = store.value;
  return run ? predictions(run, timepoints.value, predictedAnchors.value, cutoff.value, changesMade(run, anchors.value, cutoff.value)) : [];
});

/** Before it is sent: what it would move. Undefined where the chosen command moves nothing by its kind. */
export const moved = computed<Moved[] | undefined>(() => {
  const [run, command] = [store.value, chosen.value];
  if (!run || !command) return undefined;
  const values = new Map(fields.value.flatMap((field) => (field.value === undefined || field.problem !== undefined ? [] : [[field.argument.name, field.value] as const])));
  const change = changeOf(command.name, values, run, anchors.value);
  return change && movedBy(predicted.value, predictions(run, timepoints.value, predictedAnchors.value, cutoff.value, [...changesMade(run, anchors.value, cutoff.value), change]));
});
