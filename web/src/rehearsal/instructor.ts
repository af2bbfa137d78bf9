// SPDX-License-Identifier: Apache-2.0
// An instructor's faults and notes. The other participants may read them after the end of the rehearsal.
import { signal } from '@preact/signals';
import { mayInstruct } from '../access/model';
import { uplink } from '../commands/line';
import { OCTETS } from '../notes/model';
import { Refused, wordsFor } from '../run/api';
import { change, read } from '../run/connection';
import { signalOfRun, store } from '../run/shown';
import type { RunStore } from '../run/store';

/** A fault in the API's words. */
export interface Fault {
  device_fault?: { device: string; unit: string; kind: string; duration_s: number };
  system_fault?: { duration_s: number };
  station_outage?: { duration_s: number };
  orbiter_outage?: { duration_s: number };
  uhf_loss?: { duration_s: number; fraction: number };
  wind_shift?: { duration_s: number; east_mps: number; north_mps: number };
  air_shift?: { duration_s: number; fraction: number };
  sensor_error?: { device: string; unit: string; duration_s: number; off_by?: number; grows_per_s?: number };
  false_tone?: { duration_s: number; tone: number };
  computer_reset?: boolean;
}
export interface Intervention {
  e_s: number; // at the vehicle
  fault?: Fault;
  note?: { text: string; by?: string };
  skipped?: boolean; // the inject is left out
  inject?: string; // of the run's plan: its id; empty: none of it
}

export const interventions = signal<{ run: number; all: Intervention[] } | undefined>(undefined);
/** What came of the last request; of an order to an inject with its id. */
export const message = signalOfRun<{ good: boolean; text: string; inject?: string } | undefined>(undefined);
export const busy = signal(false);

export const messageWords = (): string =>
  message.value ? `${message.value.good ? '●' : '✖'} ${message.value.text}` : '';

export const ofRun = (run: Pick<RunStore, 'id'>): readonly Intervention[] =>
  interventions.value?.run === run.id ? interventions.value.all : [];
/**
 * Whether the user may read them, and the plan: during the run with the right to instruct, after its end or
 * interruption everybody.
 */
export const mayRead = (run: Pick<RunStore, 'going'>): boolean => !run.going || mayInstruct();

/** Asks for the interventions. Throws the server's words, since there is no score without them. */
export async function askInterventions(run: RunStore): Promise<readonly Intervention[]> {
  const all: Intervention[] = [];
  for (let after = '0'; ; ) {
    const list = await read<{ interventions?: Intervention[]; next_after?: string }>(
      `/runs/${run.id}/interventions${after === '0' ? '' : `?after=${after}`}`,
    );
    for (const each of list.interventions ?? []) all.push(each);
    after = list.next_after ?? '0';
    if (after === '0') break;
  }
  if (store.value === run) interventions.value = { run: run.id, all };
  return all;
}

export async function refreshInterventions(): Promise<void> {
  const run = store.value;
  if (!run || !mayRead(run)) return;
  try {
    await askInterventions(run);
  } catch (error) {
    if (!(error instanceof Refused)) throw error; // the known list stays; the next round asks again
  }
}

/** Requests one intervention once; true if it was accepted. `of`: what its message is about. */
export async function intervene(what: object, done: string, of: { inject?: string } = {}): Promise<boolean> {
  if (busy.value) return false;
  busy.value = true;
  message.value = undefined;
  try {
    await change('/rehearsals/current', { ...what, run: store.value?.id ?? 0 });
    message.value = { good: true, text: done, ...of };
    await refreshInterventions();
    return true;
  } catch (error) {
    message.value = { good: false, text: wordsFor(error), ...of };
    return false;
  } finally {
    busy.value = false;
  }
}

export const inject = (fault: Fault): Promise<boolean> =>
  intervene({ inject: fault }, 'injected: it begins with the next cycle');

export function write(text: string): Promise<boolean> {
  const octets = new TextEncoder().encode(text.trim()).length;
  const bad =
    octets === 0
      ? 'there is nothing to write down'
      : octets > OCTETS
        ? `it has ${octets} octets; a note has at most ${OCTETS}`
        : '';
  if (!bad)
    return intervene({ note: { text: text.trim(), by: uplink.value.controller.trim() } }, 'kept for the review');
  message.value = { good: false, text: bad };
  return Promise.resolve(false);
}
