// SPDX-License-Identifier: Apache-2.0
// The keys in one table, used by both the help and the page.
import { signal } from '@preact/signals';
import { leaveReport, openReport } from '../anomaly/opened';
import { askCalls } from '../calls/opened';
import { TABS, bringUp, closeFull, full, placeOf, toggleFull } from '../places/model';
import type { Tab } from '../places/model';
import { backFile, stage } from '../commands/file';
import { back, openCommandLine, step, typeIntoLine } from '../commands/line';
import { changePace, togglePause } from '../rehearsal/pace';
import { toggleGuide } from '../guide/model';
import { toggleRecording, toggleReplay } from '../replay/model';
import { backToLive } from '../run/session';
import { focusValue, openMenu } from '../menu/model';
import { nextSound } from '../sound/model';
import { dismissNotice, pastRange, store, takesCommands } from '../run/shown';
import { closeCursor, stepCursor } from '../run/cursor';
import { closeList, putAside, toggleList } from '../situation/model';
import { closeDetail, stepTimepoint, toggleAnchors } from '../timeline/view';
import { focusTones } from '../tones/view';
import { toggleDifference } from '../plots/view';
import { choice, pan, zoom } from '../run/window';

export const helpShown = signal(false);
/**
 * Opens a panel and focuses its first control, or the one that comes first in its work: as soon as the panel is there, since some are loaded when first opened;
 * not when the focus has gone elsewhere meanwhile.
 */
export function focusPanel(which: Tab): void {
  const before = document.activeElement;
  bringUp(which);
  const place = placeOf(which);
  const panel = `[data-testid="panel-${place === 'data' && ['data', undefined].includes(full.value) ? 'data' : which}"]`;
  const focusFirst = () => {
    if (placeOf(which) !== place || document.activeElement !== before) return;
    const first =
      document.querySelector<HTMLElement>(`${panel} .table-box [data-first]:enabled`) ??
      document.querySelector<HTMLElement>(`${panel} .table-box :is(input, select, button, [tabindex])`);
    if (first) {
      first.focus();
      if (first instanceof HTMLInputElement && first.type === 'text') first.select(); // what is filled in is replaced by the next letter
    } else if (document.querySelector(`${panel} [data-loading]`)) requestAnimationFrame(focusFirst);
  };
  requestAnimationFrame(focusFirst);
}

/** Gives the panel in focus, else that under the mouse, the room of all pictures; or takes it back. */
function zoomPanel(): void {
  if (closeFull()) return;
  const under = (selector: string) => document.querySelector<HTMLElement>(selector)?.dataset.panel;
  const panel = under('.panel:focus-within') ?? under('.panel:hover') ?? 'plots';
  if (document.querySelector('.console.alone') === null) toggleFull(panel);
}

function toggleTheme(): void {
  const root = document.documentElement;
  const next = root.dataset.theme === 'light' ? 'dark' : 'light';
  root.dataset.theme = next;
  localStorage.setItem('aeolis-theme', next);
}

/** Disarms commands and files, wherever the focus is. Returns whether any was armed. */
export function takeBackArmed(): boolean {
  const [command, file] = [step.value === 'armed', stage.value === 'armed'];
  if (command) back();
  if (file) backFile();
  return command || file;
}

interface Shortcut {
  keys: string[];
  shown: string;
  words: string;
  act: () => void;
}

export const SHORTCUTS: Shortcut[] = [
  {
    keys: ['/'],
    shown: '/',
    words: 'command line: type words, Tab completes, Enter goes on, Esc back',
    act: () => openCommandLine(),
  },
  { keys: ['+', '='], shown: '+', words: 'faster', act: () => changePace(1) },
  { keys: ['-', '−'], shown: '−', words: 'slower', act: () => changePace(-1) },
  { keys: ['p'], shown: 'p', words: 'pause and go on', act: togglePause },
  { keys: ['y'], shown: 'y', words: 'replay the landing; again: leave', act: toggleReplay },
  { keys: ['w'], shown: 'w', words: 'in a past view: as heard then, or with the recording', act: toggleRecording },
  { keys: ['m'], shown: 'm', words: 'banner: what else matters, and what was put aside', act: toggleList },
  { keys: ['x'], shown: 'x', words: 'banner: put its news aside', act: () => putAside() },
  { keys: ['1'], shown: '1', words: 'show the landing', act: () => (choice.value = 'landing') },
  { keys: ['2'], shown: '2', words: 'show the last minute', act: () => (choice.value = 'minute') },
  { keys: ['3'], shown: '3', words: 'show the whole run', act: () => (choice.value = 'run') },
  { keys: [']'], shown: ']', words: 'zoom in', act: () => zoom(store.value, 0.5) },
  { keys: ['['], shown: '[', words: 'zoom out', act: () => zoom(store.value, 2) },
  { keys: ['ArrowLeft'], shown: '←', words: 'earlier', act: () => pan(store.value, -0.25) },
  { keys: ['ArrowRight'], shown: '→', words: 'later', act: () => pan(store.value, 0.25) },
  {
    keys: ['Shift+ArrowLeft'],
    shown: 'Shift ←',
    words: 'cursor in plots, tones and timeline: earlier',
    act: () => stepCursor(-1),
  },
  { keys: ['Shift+ArrowRight'], shown: 'Shift →', words: 'cursor: later', act: () => stepCursor(1) },
  { keys: ['j'], shown: 'j', words: 'plots: observed less predicted; again: as observed', act: toggleDifference },
  {
    keys: ['.'],
    shown: '.',
    words: 'next timepoint: state, offsets, why it fired or has not',
    act: () => stepTimepoint(1),
  },
  { keys: [','], shown: ',', words: 'timepoint before', act: () => stepTimepoint(-1) },
  { keys: ['h'], shown: 'h', words: 'anchors: parent, offset, what defined each', act: toggleAnchors },
  {
    keys: ['o'],
    shown: 'o',
    words: 'tones: ← → choose a symbol, its evidence and spectrum',
    act: () => {
      bringUp('tones');
      requestAnimationFrame(focusTones);
    },
  },
  {
    keys: ['e'],
    shown: 'e',
    words: 'search the events',
    act: () => document.querySelector<HTMLElement>('[data-testid="event-search"]')?.focus(),
  },
  ...TABS.map(({ id, key, words }) => ({ keys: [key], shown: key, words, act: () => focusPanel(id) })),
  { keys: ['7'], shown: '7', words: 'standard calls: then one key each', act: () => askCalls('list') },
  { keys: ['6'], shown: '6', words: 'read back the newest call of another', act: () => askCalls('read back') },
  { keys: ['!'], shown: '!', words: 'anomaly report: what is on the screen, into the shift log', act: openReport },
  { keys: ['i'], shown: 'i', words: 'values: ↑ ↓ ← → from one to the next, Enter opens its menu', act: focusValue },
  { keys: ['z'], shown: 'z', words: 'full size: the panel in focus, or under the mouse; again: back', act: zoomPanel },
  { keys: ['9'], shown: '9', words: 'this display: link, sound, layouts', act: () => openMenu('display') },
  { keys: ['q'], shown: 'q', words: 'copy a link to what is shown', act: () => openMenu('link') },
  { keys: ['0'], shown: '0', words: 'call-outs: off, tones, words', act: nextSound },
  { keys: ['g'], shown: 'g', words: 'the guide for a first landing', act: toggleGuide },
  { keys: ['t'], shown: 't', words: 'dark or light', act: toggleTheme },
  { keys: ['?'], shown: '?', words: 'these keys', act: () => (helpShown.value = !helpShown.value) },
  {
    keys: ['Escape'],
    shown: 'Esc',
    words: 'close what is open, or leave a past view',
    act: () => {
      if (takeBackArmed() || leaveReport()) return;
      if (helpShown.value) helpShown.value = false;
      else if (closeList() || closeCursor() || closeDetail() || closeFull()) return;
      else if (step.value !== 'type' && takesCommands()) back();
      else if (pastRange.value) backToLive();
      else dismissNotice();
    },
  },
];

/** Ignores repeats of a held key: they choose, review, send and answer nothing. */
export function ignoreHeldEnter(event: KeyboardEvent): void {
  if (event.key !== 'Enter' || !event.repeat || (event.target as HTMLElement | null)?.matches('textarea')) return;
  event.preventDefault();
  event.stopPropagation();
}

/**
 * Who types a word leaves less than this between two letters, who presses a key waits to see what it did. Chosen: the
 * mean between two letters of 168 000 people who typed was 0.24 s [dhakal-2018].
 */
export const WORD_MS = 300;
/** The first letter, which acts when no other follows. */
let first: { key: string; act: (() => void) | undefined; timer: ReturnType<typeof setTimeout> } | undefined;
/** Until then a word goes on that nothing takes. */
let wordUntil_ms = -Infinity;

function actFirst(): void {
  const waiting = first;
  if (!waiting) return;
  clearTimeout(waiting.timer);
  first = undefined;
  waiting.act?.();
}

/** A letter acts when it stays alone: a word acts as nothing, and goes into the command line if a run takes commands. */
function onLetter(event: KeyboardEvent, act: (() => void) | undefined): void {
  event.preventDefault();
  if (event.repeat) return;
  const begun = first;
  if (begun) clearTimeout(begun.timer);
  first = undefined;
  if (!begun && event.timeStamp >= wordUntil_ms) {
    first = { key: event.key, act, timer: setTimeout(actFirst, WORD_MS) };
    return;
  }
  if (!takesCommands() || !typeIntoLine((begun?.key ?? '') + event.key)) wordUntil_ms = event.timeStamp + 2 * WORD_MS;
}

export function onKey(event: KeyboardEvent): void {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  const target = event.target as HTMLElement | null;
  // No command begins with a figure, a sign or an arrow: in the empty command line those act as anywhere.
  const isEmptyLine = target instanceof HTMLInputElement && target.dataset.testid === 'command-line' && !target.value;
  const acts = isEmptyLine && event.key !== 'Escape' && !/^\p{L}$/u.test(event.key);
  if (!acts && target?.matches('input:not([type=range], [type=checkbox]), select, textarea')) {
    if (event.key !== 'Escape') return;
    target.blur();
    takeBackArmed();
    return;
  }
  if (target?.matches('[type=range]') && event.key.startsWith('Arrow')) return; // arrows move the slider
  const key = event.shiftKey && event.key.startsWith('Arrow') ? `Shift+${event.key}` : event.key;
  const shortcut = SHORTCUTS.find((each) => each.keys.includes(key));
  if (/^\p{L}$/u.test(event.key)) {
    onLetter(event, shortcut?.act);
    return;
  }
  if (event.key.length === 1 && event.timeStamp < wordUntil_ms) {
    wordUntil_ms = event.timeStamp + 2 * WORD_MS; // a blank or a figure within it
    event.preventDefault();
    return;
  }
  if (!shortcut) return;
  if (event.key === 'Escape' && first) clearTimeout(first.timer);
  if (event.key === 'Escape') first = undefined;
  actFirst();
  event.preventDefault();
  shortcut.act();
}
