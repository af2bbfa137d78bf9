// SPDX-License-Identifier: Apache-2.0
// What is shown: the run, the part of it that is looked at as the past, its mode, and what is said to who looks. The signals that the panels read.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Signal } from '@preact/signals';
import type { RunState, TimepointRow } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { modeOf } from '../mode/model';
import type { Mode } from '../mode/model';
import { mayAct } from '../access/model';
import { namedChannels } from './address';
import type { Dictionary } from './dictionary';
import type { RunStore } from './store';

export const store = signal<RunStore | undefined>(undefined);
/** What belongs to the run that is shown: once it is another one, as it was at first. */
export function signalOfRun<T>(first: T): Signal<T> {
  const value = signal(first);
  const shown = computed(() => store.value?.id);
  effect(() => {
    void shown.value;
    untracked(() => (value.value = first));
  });
  return value;
}
export const dictionary = signal<Dictionary | undefined>(undefined);
export const timepoints = signal<TimepointRow[]>([]);
export const runs = signal<RunState[]>([]);
export const scenarios = signal<{ name: string; title: string }[]>([]);
/** The run asked for: 0 is "the one that is going on". */
export const watched = signal(0);
/** Five times a second, when something has changed. Numbers on the screen follow this and nothing faster. */
export const tick = signal(0);
/** Follows it a frame later: for tables so long that they take a frame of their own. */
export const rowsTick = signal(0);
/** A part of the run looked at as the past, in seconds from entry; undefined: not a past view. */
export const pastRange = signal<{ from: number; to: number } | undefined>(undefined);
/** Of a past view: with what only the recording told, or as it was heard then. */
export const withRecording = signal(false);

/** The run as every panel shows it. */
export function shownRun(): RunStore | undefined {
  const run = store.value;
  return pastRange.value && !withRecording.value ? run?.asHeardBy(cutoff.value, packetOf) : run;
}
const packetOf = (channel: number): string | undefined => dictionary.value?.channel(channel)?.packet;
/** The same, read by a view: it is then shown again at each tick, for a store changes without becoming another. */
export function runNow(): RunStore | undefined {
  void tick.value;
  return shownRun();
}

interface Notice {
  id: number;
  text: string;
}
export const notices = signal<Notice[]>([]);
let lastNotice = 0;

export function notify(text: string): void {
  const shown = notices.value.filter((notice) => notice.text !== text);
  notices.value = [...shown.slice(-3), { id: ++lastNotice, text }];
}
export function dismissNotice(id?: number): void {
  notices.value = id === undefined ? [] : notices.value.filter((notice) => notice.id !== id);
}

/** SCLK up to which things are shown: the end of the past view, else all. */
export const cutoff = computed(() =>
  pastRange.value && store.value ? store.value.entrySclk + pastRange.value.to : Infinity,
);

/** A replay: the past view whose end moves on. `pastRange` is then what has been replayed so far. */
export const replay = signal<{ pace: number; playing: boolean } | undefined>(undefined);

/** Read with `tick`: a run's own state changes without a new store. */
export function modeNow(): Mode {
  void tick.value;
  return modeOf(store.value, pastRange.value !== undefined, replay.value !== undefined);
}

/** Of a mission that is only listened to. */
export const hasNoCommands = (): boolean => dictionary.value?.commands.length === 0;

export const asHeard = computed(() => pastRange.value !== undefined && !withRecording.value);

/** Whether a command can be sent from what is shown. */
export function takesCommands(): boolean {
  return ['live', 'rehearsal'].includes(modeNow()) && mayAct() && !hasNoCommands();
}

export function lookAtPast(range: { from: number; to: number }, recorded: boolean): void {
  withRecording.value = recorded;
  pastRange.value = range;
}

/** What is drawn over time: its history comes finer. */
export function plottedChannels(): string[] {
  const picks = [
    ...namedChannels().map((name) => [name]),
    ...LAYOUT.plots.map((plot) => plot.channel),
    LAYOUT.altitude,
    LAYOUT.speed,
    LAYOUT.phase,
  ];
  return [...new Set(picks.map((names) => dictionary.value?.pick(names)?.name).filter((name) => name !== undefined))];
}
