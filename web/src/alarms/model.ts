// SPDX-License-Identifier: Apache-2.0
// Alarms that need attention, as the ground keeps them, each with its last action. The stream reports that something
// changed.
import { computed, signal } from '@preact/signals';
import { uplink } from '../commands/line';
import type { Status } from '../design/status';
import { wordsFor } from '../run/api';
import { isWorst } from '../run/limits';
import { change, read } from '../run/connection';
import { store } from '../run/shown';
import type { RunStore } from '../run/store';

export interface AlarmState {
  name: string;
  kind: string; // limit, staleness, link
  state: string; // unacknowledged, acknowledged, returned, latched, shelved, normal
  severity: string; // present severity; "none": within its limits again
  worst: string;
  acknowledged?: boolean;
  latches?: boolean;
  shelved_until?: string; // ERT
  limit?: string;
  value?: number;
  sclk?: number;
  by?: string;
  note?: string;
  reason?: string; // for staleness and links
  cause?: string; // for staleness: the lost link for which the packet is missing
}
type Action = 'acknowledge' | 'shelve' | 'unshelve' | 'reset';

const ORDER = ['unacknowledged', 'latched', 'returned', 'acknowledged', 'shelved', 'normal'];

/** The ground's list of alarms; undefined until the first answer. */
export const alarms = signal<{ run: number; all: AlarmState[] } | undefined>(undefined);
export const problem = signal('');
export const note = signal('');
export const shelveFor = signal('300');
export const acting = signal<string | undefined>(undefined);

export const listed = computed(() =>
  alarms.value && alarms.value.run === store.value?.id ? sorted(alarms.value.all) : [],
);
export const toAcknowledge = computed(() => listed.value.filter(wantsLook));

/**
 * Severities of all present alarms, acknowledged or not. Until the ground's list of this run has arrived, those of
 * limits from the stream.
 */
export function severitiesNow(run: RunStore): string[] {
  if (alarms.value?.run !== run.id) return [...run.alarms.values()].map((alarm) => alarm.severity);
  return listed.value
    .filter((alarm) => alarm.state !== 'shelved' && alarm.severity !== 'none' && alarm.severity !== '')
    .map((alarm) => alarm.severity);
}

export function lookOf(alarm: AlarmState): Status {
  const severity = alarm.severity === 'none' ? alarm.worst : alarm.severity;
  if (alarm.state === 'shelved' || alarm.state === 'normal') return 'quiet';
  if (alarm.severity === 'none' || alarm.severity === '') return 'good';
  return isWorst(severity) ? 'alarm' : 'caution';
}

export const wantsLook = (alarm: AlarmState) =>
  !alarm.acknowledged && ['unacknowledged', 'returned', 'latched'].includes(alarm.state);

/** The alarms that no one has acknowledged first, the worst of them on top. */
export function sorted(all: readonly AlarmState[]): AlarmState[] {
  const rank = (alarm: AlarmState) => [
    ORDER.indexOf(alarm.state) < 0 ? ORDER.length : ORDER.indexOf(alarm.state),
    isWorst(alarm.worst) ? 0 : 1,
  ];
  return [...all].sort((a, b) => {
    const [x, y] = [rank(a), rank(b)];
    return (x[0] as number) - (y[0] as number) || (x[1] as number) - (y[1] as number) || a.name.localeCompare(b.name);
  });
}

export function actionsOn(alarm: AlarmState): Action[] {
  if (alarm.state === 'shelved') return ['unshelve'];
  return [
    ...(wantsLook(alarm) ? (['acknowledge'] as const) : []),
    'shelve',
    ...(alarm.latches && alarm.severity === 'none' ? (['reset'] as const) : []),
  ];
}

/** Alarms that need attention and are new, or have grown worse. */
export function newAmong(before: readonly AlarmState[], after: readonly AlarmState[]): AlarmState[] {
  const known = new Map(before.filter(wantsLook).map((alarm) => [alarm.name, alarm.worst]));
  return after.filter((alarm) => wantsLook(alarm) && known.get(alarm.name) !== alarm.worst);
}
/** Those that the last answer brought, for call-outs. */
export const fresh = signal<readonly AlarmState[]>([]);

let asking = false;

/** Asks for the present states of alarms. */
export async function refreshAlarms(): Promise<void> {
  const run = store.value;
  if (!run || asking) return;
  asking = true;
  try {
    const { alarms: all = [] } = await read<{ alarms?: AlarmState[] }>(`/runs/${run.id}/alarms?state=current`);
    if (store.value !== run) return;
    const before = alarms.value?.run === run.id ? alarms.value.all : all;
    alarms.value = { run: run.id, all };
    fresh.value = newAmong(before, all);
  } catch {
    // The header reports a lost connection, a bar a lost session; the next round asks again.
  } finally {
    asking = false;
  }
}

export async function act(name: string, action: Action): Promise<void> {
  const run = store.value;
  if (!run || acting.value !== undefined) return;
  acting.value = name;
  problem.value = '';
  try {
    await change(`/runs/${run.id}/alarms`, {
      channel: name,
      action,
      note: note.value.trim(),
      by: uplink.value.controller.trim(),
      ...(action === 'shelve' && { shelve_s: Number(shelveFor.value) }),
    });
    note.value = '';
    await refreshAlarms();
  } catch (error) {
    problem.value = `${name} was not ${{ acknowledge: 'acknowledged', shelve: 'shelved', unshelve: 'unshelved', reset: 'reset' }[action]}: ${wordsFor(error)}`;
  } finally {
    acting.value = undefined;
  }
}

/** Acknowledges those of the alarms that no one has looked at; ends with the first that fails. */
export async function acknowledgeAll(of: readonly AlarmState[] = toAcknowledge.value): Promise<void> {
  const [words, run] = [note.value, store.value];
  for (const { name } of of.filter(wantsLook)) {
    if (store.value !== run) return;
    note.value = words; // each has the note
    await act(name, 'acknowledge');
    if (problem.value !== '') return;
  }
}
