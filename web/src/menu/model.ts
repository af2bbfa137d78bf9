// SPDX-License-Identifier: Apache-2.0
// The menu on each value: by right click or the small button that follows the mouse, by key on the value in focus, by a
// long press. Whatever has `data-menu="KIND NAME"` has one; what it offers is loaded when it is first opened.
import { signal } from '@preact/signals';
import { grownBy } from '../draw/canvas';

/** What a menu is about: "channel altitude_m", "packet Status", "link uhf_live", "timepoint sufr", "instant of a note", "panel tones"; "display" and "link" of the page itself. */
export interface Opened {
  kind: string;
  name: string;
  /** Where its corner goes, in pixels of the page. */
  x: number;
  y: number;
  /** Seconds from entry, where the value is of one instant. */
  e_s: number | undefined;
  /** What has the focus again once it is closed. */
  opener: HTMLElement | undefined;
}
export const openedMenu = signal<Opened | undefined>(undefined);
/** The value under the mouse, beside which the button is. */
export const pointed = signal<{ on: HTMLElement; x: number; y: number } | undefined>(undefined);

const VALUES = '[data-menu]';
const LONG_PRESS_MS = 500; // chosen: as browsers do
const STILL_PX = 10; // chosen: a finger that moves more scrolls
const BESIDE_PX = 10; // the button stands out by a little less

const menuAt = (target: EventTarget | null): HTMLElement | undefined =>
  (target instanceof Element && target.closest<HTMLElement>(VALUES)) || undefined;
const scale = () => grownBy(document.documentElement);

/** Opens the menu of a value at a point of the window, else below it. */
export function openOn(on: HTMLElement, at?: { x: number; y: number }, opener = on): void {
  const [kind = '', ...name] = (on.dataset.menu ?? '').split(' ');
  const box = on.getBoundingClientRect();
  const { x, y } = at ?? { x: box.left + Math.min(box.width / 2, 40), y: box.bottom };
  pointed.value = undefined;
  openedMenu.value = {
    kind,
    name: name.join(' '),
    x: x / scale(),
    y: y / scale(),
    e_s: on.dataset.at === undefined ? undefined : Number(on.dataset.at),
    opener,
  };
}

/** Opens a menu of the page itself. */
export function openMenu(kind: 'display' | 'link'): void {
  const button = document.querySelector<HTMLElement>('[data-testid="display-menu"]');
  const box = button?.getBoundingClientRect();
  const focused = document.activeElement instanceof HTMLElement ? document.activeElement : undefined;
  openedMenu.value = {
    kind,
    name: '',
    x: (box?.right ?? window.innerWidth / 2) / scale(),
    y: (box?.bottom ?? 60) / scale(),
    e_s: undefined,
    opener: focused === document.body ? undefined : focused,
  };
}

export function closeMenu(): void {
  const { opener } = openedMenu.peek() ?? {};
  openedMenu.value = undefined;
  if (opener?.isConnected) focus(opener);
}

function focus(value: HTMLElement): void {
  if (value.tabIndex < 0) value.tabIndex = -1; // reached by arrows, not one by one by Tab
  value.focus();
}

const isInSight = (value: HTMLElement) => {
  const box = value.getBoundingClientRect();
  return box.width > 0 && box.height > 0;
};
const allValues = () => [...document.querySelectorAll<HTMLElement>(VALUES)].filter(isInSight);
let last: HTMLElement | undefined;

/** Focuses a value: the one that had the focus last, else the first of the panel in focus or under the mouse. */
export function focusValue(): void {
  const panel = document.querySelector('.panel:focus-within') ?? document.querySelector('.panel:hover');
  const all = allValues();
  const inPanel = all.filter((each) => panel?.contains(each));
  const value = (last?.isConnected && isInSight(last) && !panel ? last : undefined) ?? inPanel[0] ?? all[0];
  if (value) focus(value);
}

/** From one value to the next: ↑ ↓ within a panel, ← → to the next panel. */
function move(from: HTMLElement, key: string): void {
  const all = allValues();
  const panelOf = (value: HTMLElement | undefined) => value?.closest('.panel') ?? null;
  const own = all.filter((each) => panelOf(each) === panelOf(from));
  const at = own.indexOf(from);
  const panels = [...new Set(all.map(panelOf))];
  const panel = (by: number) => panels[(panels.indexOf(panelOf(from)) + by + panels.length) % panels.length];
  const to = {
    ArrowDown: own[Math.min(own.length - 1, at + 1)],
    ArrowUp: own[Math.max(0, at - 1)],
    Home: own[0],
    End: own.at(-1),
    ArrowRight: all.find((each) => panelOf(each) === panel(1)),
    ArrowLeft: all.find((each) => panelOf(each) === panel(-1)),
  }[key];
  if (!to) return;
  focus(to);
  to.scrollIntoView({ block: 'nearest' });
}

const MOVES = ['ArrowDown', 'ArrowUp', 'ArrowLeft', 'ArrowRight', 'Home', 'End'];

/** Keys on a value in focus. */
export function onValueKey(event: KeyboardEvent): void {
  const value = event.target instanceof HTMLElement && event.target.matches(VALUES) ? event.target : undefined;
  if (!value || event.ctrlKey || event.metaKey || event.altKey) return;
  last = value;
  if (['Enter', ' ', 'ContextMenu'].includes(event.key) || (event.key === 'F10' && event.shiftKey)) {
    if (!event.repeat) openOn(value);
  } else if (MOVES.includes(event.key) && !event.shiftKey) move(value, event.key);
  else if (event.key === 'Escape') value.blur();
  else return;
  event.preventDefault();
  event.stopPropagation();
}

/** A field keeps the browser's own menu. */
const isField = (target: EventTarget | null) => target instanceof Element && target.matches('input, textarea, select');

function onContextMenu(event: MouseEvent): void {
  const value = menuAt(event.target);
  if (!value || isField(event.target) || event.shiftKey) return;
  event.preventDefault();
  if (openedMenu.peek()?.opener !== value) openOn(value, { x: event.clientX, y: event.clientY }); // else a long press opened it
}

function onPoint(event: PointerEvent): void {
  if (event.pointerType !== 'mouse') return;
  const under = menuAt(event.target);
  const on = under?.matches('.panel-head[data-menu^="panel"]') ? undefined : under; // its right end has controls
  if (on === pointed.peek()?.on || (event.target instanceof Element && event.target.closest('.menu-button'))) return;
  const box = on?.getBoundingClientRect();
  pointed.value =
    on && box ? { on, x: rightInSight(on, box) / scale(), y: (box.top + box.height / 2) / scale() } : undefined;
}

/** The right end of what is in sight of a value: the row of a wide table goes on beyond its panel. */
function rightInSight(on: HTMLElement, { right }: DOMRect): number {
  const ends = [right, innerWidth - BESIDE_PX];
  for (let around = on.parentElement; around; around = around.parentElement) {
    const { display, overflowX } = getComputedStyle(around);
    if (display !== 'contents' && /auto|scroll|hidden|clip/.test(overflowX))
      ends.push(around.getBoundingClientRect().right);
  }
  return Math.min(...ends);
}

let pressed: ReturnType<typeof setTimeout> | undefined;
let pressedAt = { x: 0, y: 0 };
const release = () => clearTimeout(pressed);

function onPress(event: PointerEvent): void {
  release();
  const value = menuAt(event.target);
  if (event.pointerType !== 'touch' || !value || isField(event.target)) return;
  pressedAt = { x: event.clientX, y: event.clientY };
  pressed = setTimeout(() => openOn(value, pressedAt), LONG_PRESS_MS);
}

export function listenForMenus(): void {
  document.addEventListener('contextmenu', onContextMenu);
  document.addEventListener('keydown', onValueKey, true);
  document.addEventListener('pointerover', onPoint);
  document.addEventListener('scroll', () => (pointed.value = undefined), { capture: true, passive: true });
  window.addEventListener('resize', () => (pointed.value = undefined));
  document.addEventListener('pointerdown', onPress);
  document.addEventListener('pointerup', release);
  document.addEventListener('pointercancel', release);
  document.addEventListener('pointermove', (event) => {
    if (Math.hypot(event.clientX - pressedAt.x, event.clientY - pressedAt.y) > STILL_PX) release();
  });
}
