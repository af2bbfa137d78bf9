// SPDX-License-Identifier: Apache-2.0
// The state of the display, as signals that the panels read: the run, the past view, the mode, and the notices.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Signal } from '@preact/signals';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { NamedRun } from '../stream/names';
import { LAYOUT } from '../layout';
import { modeOf } from '../mode/model';
import type { Mode } from '../mode/model';
import { mayAct } from '../access/model';
import { opened } from './address';
import type { Dictionary } from './dictionary';
import type { RunStore } from './store';

export const store = signal<RunStore | undefined>(undefined);
/** A signal that returns to `first` whenever another run is shown. */
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
export const runs = signal<NamedRun[]>([]);
export const scenarios = signal<{ name: string; title: string }[]>([]);
/** The requested run; 0: the current one. */
export const watched = signal(0);
/** The run that was asked for by its number; 0: none was, whichever is shown. */
export const asked = signal(0);
/** Changes five times a second if the data have changed. Numbers on the screen follow it and nothing faster. */
export const tick = signal(0);
/** Follows `tick` one frame later, for tables so long that they need a frame of their own. */
export const rowsTick = signal(0);
/** The part of the run shown as the past, in seconds from entry; undefined: no past view. */
export const pastRange = signal<{ from: number; to: number } | undefined>(undefined);
/** The reading of a past view: with the recording, or as it was heard then. */
export const withRecording = signal(false);

/** The run as every panel shows it. */
export function shownRun(): RunStore | undefined {
  const run = store.value;
  return pastRange.value && !withRecording.value ? run?.asHeardBy(cutoff.value, packetOf) : run;
}
const packetOf = (channel: number): string | undefined => dictionary.value?.channel(channel)?.packet;
/** The same for use in a view. It renders again at each tick, since a store changes without becoming a new object. */
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

/** SCLK up to which data are shown: the end of the past view, else Infinity. */
export const cutoff = computed(() =>
  pastRange.value && store.value ? store.value.entrySclk + pastRange.value.to : Infinity,
);

/** A replay: a past view whose end advances. `pastRange` is then the part replayed so far. */
export const replay = signal<{ pace: number; playing: boolean } | undefined>(undefined);

/** The mode. Subscribes to `tick`, since a run's state changes without a new store. */
export function modeNow(): Mode {
  void tick.value;
  return modeOf(store.value, pastRange.value !== undefined, replay.value !== undefined);
}

/** Whether the mission can only be listened to. */
export const hasNoCommands = (): boolean => dictionary.value?.commands.length === 0;

export const asHeard = computed(() => pastRange.value !== undefined && !withRecording.value);

/** Whether a command can be sent from what is shown. */
export function takesCommands(): boolean {
  return ['live', 'rehearsal'].includes(modeNow()) && mayAct() && !hasNoCommands();
}

/** Whether people can act in what is shown: not in the past, nor when the run is over, which the tick tells. */
export function takesActs(): boolean {
  void tick.value;
  return pastRange.value === undefined && store.value?.going === true;
}

export function lookAtPast(range: { from: number; to: number }, recorded: boolean): void {
  withRecording.value = recorded;
  pastRange.value = range;
}

/** The plots from top to bottom, each with the channels that share it; undefined: those of the layout. */
export const plots = signal(opened.picture.plots);
/** Another run, laid over the plots. */
export const laidOver = signal(opened.picture.over);

/** Channels that are plotted over time; their history has more points. */
export function plottedChannels(): string[] {
  const picks = [
    ...(plots.value ?? []).flat().map((name) => [name]),
    ...LAYOUT.plots.map((plot) => plot.channel),
    LAYOUT.altitude,
    LAYOUT.speed,
    LAYOUT.phase,
  ];
  return [...new Set(picks.map((names) => dictionary.value?.pick(names)?.name).filter((name) => name !== undefined))];
}

const drawn = computed(() => new Set(plottedChannels().map((name) => dictionary.value?.pick([name])?.id)));
export const isPlotted = (channel: number): boolean => drawn.peek().has(channel);
