// SPDX-License-Identifier: Apache-2.0
// The instructor's plan of injects: the plan of the run that is shown, with what became of each inject, and orders to
// an inject that waits.
import { signal } from '@preact/signals';
import { Refused } from '../run/api';
import { read } from '../run/connection';
import { store } from '../run/shown';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { intervene, mayRead } from './instructor';

/** The server's answer (schema/aeolis/v1/plan.proto). */
export interface Plan {
  name: string; // empty: the run has no plan
  title: string;
  purpose: string;
  scenario: string;
  injects: readonly Inject[];
}
export interface Inject {
  inject: string; // its id
  title: string;
  when: string; // empty: by hand
  does: string;
  shows: string;
  team: readonly string[]; // what a good team does
  state: 'waiting' | 'done' | 'skipped';
  e_s?: number; // when it was done or skipped
}

const plan = signal<{ run: number; of: Plan } | undefined>(undefined);

/** The plan of a run; undefined if it has none, or none is known. */
export const planOf = (run: Pick<RunStore, 'id'>): Plan | undefined =>
  plan.value?.run === run.id && plan.value.of.name !== '' ? plan.value.of : undefined;

/** Asks for the plan of a run. Throws the server's words. */
export async function askPlan(run: RunStore): Promise<void> {
  const of = await read<Plan>(`/runs/${run.id}/plan`);
  if (store.value === run) plan.value = { run: run.id, of };
}

export async function refreshPlan(): Promise<void> {
  const run = store.value;
  if (!run || !mayRead(run)) return;
  try {
    await askPlan(run);
  } catch (error) {
    if (!(error instanceof Refused)) throw error; // the known plan stays; the next round asks again
  }
}

/** Orders an inject that waits: now, or not at all. */
async function order(what: { inject: string; skip?: true }, done: string): Promise<void> {
  await intervene({ plan: what }, done, { inject: what.inject });
  await refreshPlan();
}
export const injectNow = ({ inject, title }: Inject): Promise<void> =>
  order({ inject }, `“${title}” is injected with the next cycle`);
export const skip = ({ inject, title }: Inject): Promise<void> =>
  order({ inject, skip: true }, `“${title}” is left out`);

/** The title of an inject; its id where the plan is not known. */
export const titleOf = (of: Plan | undefined, id: string): string =>
  of?.injects.find((each) => each.inject === id)?.title || id;

/** "▲ done E+0:12.3": what has become of an inject. `going`: the run goes on. */
export function fateOf({ state, e_s }: Inject, going: boolean): string {
  const at = e_s === undefined ? '' : ` ${fromEntry(e_s, { tenths: true })}`;
  if (state === 'done') return `▲ done${at}`;
  if (state === 'skipped') return `– skipped${at}`;
  return going ? '▷ waiting' : '– not injected';
}
