// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import guide from '../../../docs/console.md?raw';
import { stage } from '../commands/file';
import { step } from '../commands/line';
import { useForTest } from '../run/session';
import { lookAtPast, pastRange, withRecording } from '../run/shown';
import { aDictionary, aStore } from '../testing/fixtures';
import { tab } from '../places/model';
import { SHORTCUTS, WORD_MS, focusPanel, helpShown, onKey } from './model';

beforeEach(() => void vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] }));
afterEach(() => {
  vi.useRealTimers();
  [step.value, stage.value, helpShown.value, pastRange.value] = ['type', 'review', false, undefined];
  document.body.textContent = '';
});

/** Presses a key with the focus on the element; returns whether a shortcut took it. */
function press(key: string, on: Partial<HTMLInputElement> = {}, tag = 'input'): boolean {
  const element = document.body.appendChild(Object.assign(document.createElement(tag), on));
  const event = new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true });
  element.addEventListener('keydown', onKey);
  element.dispatchEvent(event);
  vi.advanceTimersByTime(3 * WORD_MS); // nothing follows
  return event.defaultPrevented;
}

it('no key has two meanings, and docs/console.md has each with its words', () => {
  const keys = SHORTCUTS.flatMap((each) => each.keys);
  expect(new Set(keys).size).toBe(keys.length);
  for (const each of SHORTCUTS) expect(guide).toContain(`| \`${each.shown}\` | ${each.words} |`);
});
it('a letter acts on a slider and on a box to tick as anywhere, not in what takes text; the slider keeps its arrows', () => {
  useForTest(aStore(), aDictionary);
  lookAtPast({ from: -100, to: 0 }, false);
  expect([press('w', { type: 'range' }), withRecording.value]).toEqual([true, true]);
  expect([press('w', { type: 'checkbox' }), withRecording.value]).toEqual([true, false]);
  expect([
    press('ArrowLeft', { type: 'range' }),
    press('w', { type: 'search' }),
    press('w', {}, 'select'),
    withRecording.value,
  ]).toEqual([false, false, false, false]);
  press('Escape', { type: 'range' });
  expect(pastRange.value).toBeUndefined();
});
it('Esc takes back what is armed from wherever the focus is, before it closes anything; what is only reviewed after that', () => {
  useForTest(aStore(), aDictionary);
  for (const [type, tag] of [
    ['search', 'input'],
    ['range', 'input'],
    ['', 'button'],
  ] as const) {
    [step.value, stage.value, helpShown.value] = ['armed', 'armed', true];
    press('Escape', { type }, tag);
    expect([step.value, stage.value, helpShown.value], type).toEqual(['review', 'review', true]);
  }
  press('Escape', {}, 'button');
  expect([helpShown.value, step.value]).toEqual([false, 'review']);
  press('Escape', {}, 'button');
  expect(step.value).toBe('type');
});
it('a panel that is still being loaded is focused once it is there; not when the focus has gone elsewhere meanwhile', async () => {
  const frame = () => new Promise((resolve) => requestAnimationFrame(() => resolve(undefined)));
  for (const elsewhere of [false, true]) {
    document.body.innerHTML = `<button></button><div data-testid="panel-data"><p data-loading></p></div>`;
    focusPanel('recorded');
    await frame();
    await frame();
    if (elsewhere) document.querySelector('button')?.focus();
    const panel = document.querySelector('[data-testid="panel-data"]');
    if (panel) panel.innerHTML = '<div class="table-box"><input></div>';
    await frame();
    await frame();
    expect(document.activeElement?.tagName).toBe(elsewhere ? 'BUTTON' : 'INPUT');
  }
});

it('a word that is typed fires no shortcut: it goes into the command line if the run takes commands, else nowhere; a letter alone acts', () => {
  useForTest(aStore(), aDictionary);
  const typing = (text: string, apart_ms: number) => {
    for (const key of text) {
      const on = document.activeElement ?? document.body;
      const event = new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true });
      Object.defineProperty(event, 'timeStamp', { value: performance.now() });
      on.dispatchEvent(event);
      if (on instanceof HTMLInputElement && !event.defaultPrevented) on.value += key;
      vi.advanceTimersByTime(apart_ms);
    }
  };
  document.addEventListener('keydown', onKey);
  tab.value = 'channels';
  document.body.innerHTML = '<input data-testid="command-line">';
  typing('set edl', 200);
  expect([document.querySelector('input')?.value, tab.value, helpShown.value]).toEqual(['set edl', 'channels', false]);

  document.body.innerHTML = ''; // no line to take it
  typing('landing 2', 200);
  vi.advanceTimersByTime(3 * WORD_MS);
  expect(tab.value).toBe('channels');
  typing('l', WORD_MS);
  expect(tab.value).toBe('links');
  document.removeEventListener('keydown', onKey);
});

it('figures, signs and arrows act in the empty command line, and are text once a word stands in it', () => {
  useForTest(aStore(), aDictionary);
  document.body.innerHTML = '<input data-testid="command-line">';
  const input = document.querySelector('input') as HTMLInputElement;
  input.addEventListener('keydown', onKey);
  const taken = (key: string) => {
    const event = new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true });
    Object.defineProperty(event, 'timeStamp', { value: 1e9 }); // long after any word
    return !input.dispatchEvent(event);
  };
  expect(['?', 'ArrowLeft', '1', 'w'].map(taken)).toEqual([true, true, true, false]);
  expect(helpShown.value).toBe(true);
  input.value = 'do edl';
  expect(['?', 'ArrowLeft', '1'].map(taken)).toEqual([false, false, false]);
});
