// The keys, in one table: what the help shows is what the page does.
import { signal } from '@preact/signals';
import { openCommandLine } from '../commands/line';
import { changePace, togglePause } from '../rehearsal/view';
import { toggleGuide } from '../guide/model';
import { toggleReplay } from '../replay/model';
import { backToLive, dismissNotice, pastRange, store } from '../run/session';
import { closeTimepoint, stepTimepoint } from '../timeline/view';
import { choice, pan, zoom } from '../run/window';

export const helpShown = signal(false);
export type Tab = 'channels' | 'packets' | 'verdicts' | 'links' | 'flown' | 'recorded' | 'rehearsal' | 'campaigns' | 'alarms' | 'notes' | 'users';
export const tab = signal<Tab>('channels');
export const TABS: { id: Tab; title: string; key: string; words: string }[] = [
  { id: 'channels', title: 'Channels', key: 'c', words: 'channels: values, ages, limits' },
  { id: 'alarms', title: 'Alarms', key: 'a', words: 'alarms: acknowledge, shelve, reset' },
  { id: 'notes', title: 'Notes', key: 'n', words: 'shift log: write, search' },
  { id: 'packets', title: 'Packets', key: 'k', words: 'packets: octets and fields' },
  { id: 'verdicts', title: 'Verdicts', key: 'v', words: 'verdicts: live against recorded' },
  { id: 'links', title: 'Links', key: 'l', words: 'links: states, silences, counters' },
  { id: 'flown', title: 'As flown', key: 'f', words: 'as flown: every timepoint by plan, prediction at entry, tone, UHF and recording' },
  { id: 'recorded', title: 'Range', key: 'r', words: 'a recorded range, in every panel' },
  { id: 'rehearsal', title: 'Runs', key: 's', words: 'runs, and starting a rehearsal' },
  { id: 'campaigns', title: 'Campaigns', key: 'd', words: 'campaigns of dispersed landings: start, watch the ellipse fill' },
  { id: 'users', title: 'Users', key: 'u', words: 'users, tokens, audit: for administrators' },
];

export function focusPanel(which: Tab): void {
  tab.value = which;
  requestAnimationFrame(() =>
    document.querySelector<HTMLElement>(`[data-testid="panel-data"] .table-box :is(input, select, button, [tabindex])`)?.focus());
}

export function toggleTheme(): void {
  const root = document.documentElement;
  const next = root.dataset['theme'] === 'light' ? 'dark' : 'light';
  root.dataset['theme'] = next;
  localStorage.setItem('aeolis-theme', next);
}

export interface Shortcut {
  keys: string[];
  shown: string;
  words: string;
  act: () => void;
}

export const SHORTCUTS: Shortcut[] = [
  { keys: ['/'], shown: '/', words: 'command line: type words, Tab completes, Enter goes on, Esc back', act: () => openCommandLine() },
  { keys: ['+', '='], shown: '+', words: 'faster', act: () => changePace(1) },
  { keys: ['-', '−'], shown: '−', words: 'slower', act: () => changePace(-1) },
  { keys: ['p'], shown: 'p', words: 'pause and go on', act: togglePause },
  { keys: ['y'], shown: 'y', words: 'replay the landing; again: leave', act: toggleReplay },
  { keys: ['1'], shown: '1', words: 'show the landing', act: () => (choice.value = 'landing') },
  { keys: ['2'], shown: '2', words: 'show the last minute', act: () => (choice.value = 'minute') },
  { keys: ['3'], shown: '3', words: 'show the whole run', act: () => (choice.value = 'run') },
  { keys: [']'], shown: ']', words: 'zoom in', act: () => zoom(store.value, 0.5) },
  { keys: ['['], shown: '[', words: 'zoom out', act: () => zoom(store.value, 2) },
  { keys: ['ArrowLeft'], shown: '←', words: 'earlier', act: () => pan(store.value, -0.25) },
  { keys: ['ArrowRight'], shown: '→', words: 'later', act: () => pan(store.value, 0.25) },
  { keys: ['.'], shown: '.', words: 'next timepoint: state, offsets, why it fired or has not', act: () => stepTimepoint(1) },
  { keys: [','], shown: ',', words: 'timepoint before', act: () => stepTimepoint(-1) },
  { keys: ['e'], shown: 'e', words: 'search the events', act: () => document.querySelector<HTMLElement>('[data-testid="event-search"]')?.focus() },
  ...TABS.map(({ id, key, words }) => ({ keys: [key], shown: key, words, act: () => focusPanel(id) })),
  { keys: ['g'], shown: 'g', words: 'the guide for a first landing', act: toggleGuide },
  { keys: ['t'], shown: 't', words: 'dark or light', act: toggleTheme },
  { keys: ['?'], shown: '?', words: 'these keys', act: () => (helpShown.value = !helpShown.value) },
  {
    keys: ['Escape'], shown: 'Esc', words: 'close what is open, or leave a past view',
    act: () => {
      if (helpShown.value) helpShown.value = false;
      else if (closeTimepoint()) return;
      else if (pastRange.value) backToLive();
      else dismissNotice();
    },
  },
];

export function onKey(event: KeyboardEvent): void {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  const target = event.target as HTMLElement | null;
  const inField = target?.matches('input, select, textarea') ?? false;
  if (inField) {
    if (event.key === 'Escape') target?.blur();
    return;
  }
  const shortcut = SHORTCUTS.find((each) => each.keys.includes(event.key));
  if (!shortcut) return;
  event.preventDefault();
  shortcut.act();
}
