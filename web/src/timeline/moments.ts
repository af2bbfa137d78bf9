// SPDX-License-Identifier: Apache-2.0
// Moments that people wait for but that are no timepoints; flight reports each by an event and a tone of the same name.
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { predictedEvent } from '../prediction/model';
import type { RunStore } from '../run/store';
import { heardOf, lastHeard } from './heard';

export interface Moment {
  name: string;
  before: string;
  /** The reported time, else the predicted one. */
  e_s: number | undefined;
  /** Reported, or passed because the next timepoint is known. */
  done: boolean;
}

/** The moments of the plan shown, in order. */
export function momentsOf(store: RunStore, plan: readonly TimepointRow[], cutoff: number): Moment[] {
  const last = lastHeard(plan, heardOf(store, plan, cutoff));
  return LAYOUT.moments.flatMap(({ name, before }) => {
    const at = plan.findIndex((row) => row.name === before);
    if (at < 0) return [];
    const told =
      store.events.find(({ fact }) => fact.name.toLowerCase() === name && fact.sclk <= cutoff)?.fact.sclk ??
      store.tonesBy(cutoff).find(({ fact }) => fact.tone !== undefined && fact.name === name)?.fact.sclk;
    const predicted = at > last ? predictedEvent(name) : undefined;
    return {
      name,
      before,
      e_s: told === undefined ? predicted : told - store.entrySclk,
      done: told !== undefined || at <= last,
    };
  });
}
