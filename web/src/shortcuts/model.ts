// The keys, in one table: what the help shows is what the page does.
import { signal } from '@preact/signals';
import { openCommandLine } from '../commands/line';
import { changePace, togglePause } from '../rehearsal/view';
import { backToLive } from '../recorded/view';
import { dismissNotice, pastRange, store } from '../run/session';
import { choice, pan, zoom } from '../run/window';

export const helpShown = signal(false);
export type Tab = 'channels' | 'packets' | 'recorded' | 'rehearsal';
export const tab = signal<Tab>('channels');
export const TABS: { id: Tab; title: string; key: string }[] = [
  { id: 'channels', title: 'Channels', key: 'c' },
  { id: 'packets', title: 'Packets', key: 'k' },
  { id: 'recorded', title: 'Recorded range', key: 'r' },
  { id: 'rehearsal', title: 'Rehearsals and runs', key: 's' },
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
  { keys: ['1'], shown: '1', words: 'show the landing', act: () => (choice.value = 'landing') },
  { keys: ['2'], shown: '2', words: 'show the last minute', act: () => (choice.value = 'minute') },
  { keys: ['3'], shown: '3', words: 'show the whole run', act: () => (choice.value = 'run') },
  { keys: [']'], shown: ']', words: 'zoom in', act: () => zoom(store.value, 0.5) },
  { keys: ['['], shown: '[', words: 'zoom out', act: () => zoom(store.value, 2) },
  { keys: ['ArrowLeft'], shown: '←', words: 'earlier', act: () => pan(store.value, -0.25) },
  { keys: ['ArrowRight'], shown: '→', words: 'later', act: () => pan(store.value, 0.25) },
  ...TABS.map(({ id, title, key }) => ({ keys: [key], shown: key, words: title.toLowerCase(), act: () => focusPanel(id) })),
  { keys: ['t'], shown: 't', words: 'dark or light', act: toggleTheme },
  { keys: ['?'], shown: '?', words: 'these keys', act: () => (helpShown.value = !helpShown.value) },
  {
    keys: ['Escape'], shown: 'Esc', words: 'close this, or leave a past view',
    act: () => {
      if (helpShown.value) helpShown.value = false;
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
