// SPDX-License-Identifier: Apache-2.0
// What the places of the grid show. Three of them show a panel of choice; one panel at a time can have the room of all
// pictures. Words, events and the command line keep their place.
import { signal } from '@preact/signals';
import type { View } from '../run/address';
import { dictionary, plots } from '../run/shown';

export type Tab =
  | 'channels'
  | 'packets'
  | 'verdicts'
  | 'links'
  | 'flown'
  | 'recorded'
  | 'rehearsal'
  | 'campaigns'
  | 'what_if'
  | 'alarms'
  | 'procedures'
  | 'notes'
  | 'users'
  | 'vehicle';
export const tab = signal<Tab>('channels');
export const TABS: { id: Tab; title: string; key: string; words: string }[] = [
  { id: 'channels', title: 'Channels', key: 'c', words: 'channels: values, ages, limits' },
  { id: 'vehicle', title: 'Vehicle', key: 'b', words: 'the moving picture of the vehicle' },
  { id: 'alarms', title: 'Alarms', key: 'a', words: 'alarms: acknowledge, shelve, reset' },
  { id: 'procedures', title: 'Procedures', key: '8', words: 'procedures: begin one, its steps, what to do now' },
  { id: 'notes', title: 'Notes', key: 'n', words: 'shift log: write, search' },
  { id: 'packets', title: 'Packets', key: 'k', words: 'packets: octets and fields' },
  { id: 'verdicts', title: 'Verdicts', key: 'v', words: 'verdicts: live against recorded' },
  { id: 'links', title: 'Links', key: 'l', words: 'links: states, silences, counters' },
  {
    id: 'flown',
    title: 'As flown',
    key: 'f',
    words: 'as flown: every timepoint and event by plan, prediction at entry, tone, live telemetry and recording',
  },
  { id: 'recorded', title: 'Range', key: 'r', words: 'a recorded range, in every panel' },
  { id: 'rehearsal', title: 'Runs', key: 's', words: 'runs, and starting a rehearsal' },
  {
    id: 'campaigns',
    title: 'Campaigns',
    key: 'd',
    words: 'campaigns of dispersed landings: start, watch the ellipse fill',
  },
  { id: 'what_if', title: 'What if', key: ';', words: 'what if: fork a run, forecast it, lay it over another' },
  { id: 'users', title: 'Users', key: 'u', words: 'users, tokens, audit: for administrators' },
];

const isTab = (name: string): name is Tab => TABS.some(({ id }) => id === name);

/** The panels by their names in an address, with their titles. */
export const PANELS: Readonly<Record<string, string>> = {
  timeline: 'Timeline',
  descent: 'Descent',
  plots: 'Plots',
  tones: 'Tones',
  data: 'Data',
  waiting: 'Waiting for',
  events: 'Events',
  commands: 'Commands',
  ...Object.fromEntries(TABS.map(({ id, title }) => [id, title])),
};

export type Chosen = 'descent' | 'tones' | Tab;
/** What the places for descent and tones may show. */
export const CHOICES: readonly Chosen[] = ['descent', 'tones', ...TABS.map(({ id }) => id)];
const isChoice = (name: string): name is Chosen => (CHOICES as readonly string[]).includes(name);

export const middle = signal<Chosen>('descent');
export const low = signal<Chosen>('tones');
/** The panel that has the room of all pictures; undefined: none. */
export const full = signal<string | undefined>(undefined);

export type Place = 'middle' | 'low' | 'data';
const PLACES = { middle, low, data: tab } as const;
export const placeOf = (panel: string): Place | undefined =>
  (['middle', 'low', 'data'] as const).find((place) => PLACES[place].value === panel);

/** Shows a panel at a place. Where it was before, the other one is now, so that no panel is there twice. */
export function showAt(place: Place, panel: Chosen): void {
  if (place === 'data' && !isTab(panel)) return;
  const [from, before] = [placeOf(panel), PLACES[place].value];
  if (from === place) return;
  if (from === 'data') tab.value = isTab(before) ? before : freeTab(panel);
  else if (from) PLACES[from].value = before;
  if (place === 'data') tab.value = panel as Tab;
  else PLACES[place].value = panel;
}

/** The first tab that no place shows. */
const freeTab = (taken: string): Tab =>
  TABS.find(({ id }) => id !== taken && placeOf(id) === undefined)?.id ?? 'channels';

/** Makes sure that a panel of the grid is in sight. */
export function bringUp(panel: Chosen): void {
  const place = placeOf(panel);
  if (place === undefined) showAt(isTab(panel) ? 'data' : panel === 'descent' ? 'middle' : 'low', panel);
  const isInFull = full.value === panel || (full.value === 'data' && placeOf(panel) === 'data');
  if (full.value !== undefined && !isInFull) full.value = panel;
}

export function toggleFull(panel: string): void {
  full.value = full.value === panel ? undefined : panel;
}
export function closeFull(): boolean {
  const open = full.value !== undefined;
  full.value = undefined;
  return open;
}

/** What the places show, as far as it is not how the console comes. */
export function viewNow(): View {
  const view: View = {};
  if (tab.value !== 'channels') view.data = tab.value;
  if (middle.value !== 'descent') view.middle = middle.value;
  if (low.value !== 'tones') view.low = low.value;
  if (full.value !== undefined) view.full = full.value;
  if (plots.value) view.plots = plots.value;
  return view;
}

export const MOST_PLOTS = 16; // chosen: more are not legible
export const MOST_TOGETHER = 4; // chosen: of one plot; more lines have no dashes that can be told apart

/** Shows a view, and what it leaves out as the console comes. @returns a line for each part that cannot be shown */
export function showView(view: View): string[] {
  const problems: string[] = [];
  const known = <T extends string>(name: string | undefined, is: (name: string) => name is T): T | undefined => {
    if (name === undefined || is(name)) return name;
    problems.push(`there is no panel ${name.slice(0, 40)} to show there`);
    return undefined;
  };
  const isPanel = (name: string): name is string => Object.hasOwn(PANELS, name);
  [tab.value, middle.value, low.value] = ['channels', 'descent', 'tones'];
  const data = known(view.data, isTab);
  if (data) showAt('data', data);
  for (const place of ['middle', 'low'] as const) {
    const panel = known(view[place], isChoice);
    if (panel) showAt(place, panel);
  }
  full.value = known(view.full, isPanel);
  plots.value = view.plots && knownPlots(view.plots, problems);
  return problems;
}

function knownPlots(wanted: NonNullable<View['plots']>, problems: string[]): View['plots'] {
  const words = dictionary.value;
  const missing = new Set(wanted.flat().filter((name) => words && !words.pick([name])));
  if (missing.size > 0) problems.push(`no channel ${[...missing].slice(0, 3).join(', ')} in the dictionary`);
  const found = wanted.map((names) => names.filter((name) => !missing.has(name))).filter((names) => names.length > 0);
  if (found.length > MOST_PLOTS || found.some((names) => names.length > MOST_TOGETHER))
    problems.push(`${MOST_PLOTS} plots of ${MOST_TOGETHER} channels each are the most; the others are left out`);
  return found.length > 0 ? found.slice(0, MOST_PLOTS).map((names) => names.slice(0, MOST_TOGETHER)) : undefined;
}
