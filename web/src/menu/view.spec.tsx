// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { layouts } from '../layouts/model';
import { full, middle, showView, tab } from '../places/model';
import { plotsNow } from '../plots/chosen';
import { useForTest } from '../run/session';
import { lookAtPast, pastRange, plots } from '../run/shown';
import { onKey } from '../shortcuts/model';
import { sound } from '../sound/model';
import { aDictionary, aStore, alarm, samples, tone } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { itemsOf } from './items';
import type { Item } from './items';
import { closeMenu, focusValue, listenForMenus, openOn, onValueKey, openedMenu, pointed } from './model';
import { MenuView } from './view';
import { limitLines, sampleLines } from './why';

vi.stubGlobal(
  'ResizeObserver',
  class {
    observe() {}
    disconnect() {}
  },
);
const server = aServer();
const page = document.body;

beforeEach(() => {
  showView({});
  pastRange.value = undefined;
  useForTest(aStore(), aDictionary);
  page.innerHTML = `
    <section class="panel" id="one"><header data-menu="panel one">0</header><p data-menu="channel altitude_m">1</p><p data-menu="channel speed_mps">2</p></section>
    <section class="panel" id="two"><p data-menu="packet Status">3</p></section><div id="root"></div>`;
  for (const each of page.querySelectorAll('[data-menu]'))
    each.getBoundingClientRect = () => ({ width: 10, height: 10, left: 0, top: 0, bottom: 10 }) as DOMRect;
  document.addEventListener('keydown', onValueKey, true);
  window.addEventListener('keydown', onKey);
});
afterEach(() => {
  document.removeEventListener('keydown', onValueKey, true);
  window.removeEventListener('keydown', onKey);
  closeMenu();
});

const value = (text: string) =>
  [...page.querySelectorAll<HTMLElement>('[data-menu]')].find((each) => each.textContent === text)!;
function open(text: string): void {
  openOn(value(text));
  act(() => render(<MenuView />, page.querySelector('#root')!));
}
const items = (kind: string, name = ''): Item[] => (itemsOf({ kind, name, e_s: undefined }) ?? []).flat();
const item = (kind: string, name: string, words: RegExp) => items(kind, name).find((each) => words.test(each.words))!;
const press = (key: string) =>
  act(
    () =>
      void document.activeElement?.dispatchEvent(
        new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }),
      ),
  );

describe('the menu of a value', () => {
  it('is opened by key from the value in focus, gone through by arrows and letters, and gives the focus back', () => {
    focusValue();
    expect(document.activeElement).toBe(value('0'));
    press('ArrowDown');
    expect(document.activeElement).toBe(value('1'));
    press('ArrowDown');
    expect(document.activeElement).toBe(value('2'));
    press('ArrowRight');
    expect(document.activeElement).toBe(value('3'));
    press('ArrowLeft');
    press('ArrowDown');
    press('Enter');
    expect(openedMenu.value).toMatchObject({ kind: 'channel', name: 'altitude_m' });
    act(() => render(<MenuView />, page.querySelector('#root')!));
    const menu = page.querySelector('[role=menu]');
    expect(menu?.getAttribute('aria-label')).toBe('altitude_m');
    expect(document.activeElement?.textContent).toMatch(/^Plot it over/); // the first that can be done
    press('End');
    expect(document.activeElement?.textContent).toMatch(/^Copy a link/);
    press('i');
    expect(document.activeElement?.textContent).toMatch(/^Its bytes/);
    press('Escape');
    expect([openedMenu.value, document.activeElement]).toEqual([undefined, value('1')]);
  });
  it('says of what cannot be done why, and does nothing then', () => {
    open('2');
    const taken = [...page.querySelectorAll<HTMLElement>('[role=menuitem]')].find((each) =>
      /^Plot it:/.test(each.textContent ?? ''),
    );
    expect([taken?.textContent, taken?.getAttribute('aria-disabled')]).toEqual(['Plot it: it has a plot', 'true']);
    act(() => taken?.click());
    expect([plots.value, openedMenu.value?.name]).toEqual([undefined, 'speed_mps']);
    useForTest(undefined, aDictionary);
    expect(item('channel', 'edl_phase', /bytes/).why).toBe('there is no run');
    expect(item('channel', 'edl_phase', /limits/).why).toBe('it has none');
  });
  it('plots a channel by itself, over another, and takes it out again', () => {
    expect(plotsNow()).toEqual([['altitude_m'], ['speed_mps']]);
    item('channel', 'edl_phase', /^Plot it$/).act?.();
    expect(plotsNow().at(-1)).toEqual(['edl_phase']);
    item('channel', 'next_desired_sclk', /over Speed/).act?.();
    expect(plotsNow()[1]).toEqual(['speed_mps', 'next_desired_sclk']);
    expect(items('channel', 'next_desired_sclk').some(({ words }) => /over Speed/.test(words))).toBe(false);
    item('channel', 'speed_mps', /^Take it out/).act?.();
    expect(plotsNow()).toEqual([['altitude_m'], ['next_desired_sclk'], ['edl_phase']]);
    for (const name of ['altitude_m', 'next_desired_sclk', 'edl_phase']) item('channel', name, /^Take/).act?.();
    expect([plots.value, plotsNow()]).toEqual([undefined, [['altitude_m'], ['speed_mps']]]);
  });
  it('shows limits and evidence as they are at the instant that is shown', () => {
    const run = aStore([alarm({ channel: 3, severity: 'warning', sclk: 850, limit: '> 200000 m' })], undefined);
    const altitude = aDictionary.pick(['altitude_m'])!;
    expect(limitLines(run, altitude)).toEqual([
      ['now', 'warning > 200000'],
      ['always', 'warning > 200000'],
    ]);
    const lines = sampleLines(run, altitude, { sclk: 860, value: 210000, recorded: false });
    expect(lines).toContainEqual(['of', 'E−2:20.0 (SCLK 860.000)']);
    expect(lines).toContainEqual(['alarm', 'warning since E−2:30.0: > 200000 m']);
    expect(sampleLines(run, altitude, undefined)).toEqual([['value', 'not asked for yet']]);
  });
  it('of a timepoint says what told of it, and that nothing has', () => {
    useForTest(aStore([tone({ tone: 7, name: 'entry', sclk: 880 })]), aDictionary);
    expect(item('timepoint', 'entry', /Point/).why).toBe('not known');
    openedMenu.value = { kind: 'timepoint', name: 'moon', x: 0, y: 0, e_s: undefined, opener: undefined };
    act(() => render(<MenuView />, page.querySelector('#root')!));
    act(() =>
      [...page.querySelectorAll<HTMLElement>('[role=menuitem]')]
        .find((each) => /^Why/.test(each.textContent ?? ''))
        ?.click(),
    );
    expect(page.querySelector('[role=dialog]')?.textContent).toMatch(/told by\s*nothing yet/);
  });
});

describe('the menu of a panel', () => {
  it('gives it the room of all pictures, and puts another in its place', () => {
    item('panel', 'descent', /^Full size/).act?.();
    expect(full.value).toBe('descent');
    expect(item('panel', 'descent', /^Back/).key).toBe('z');
    full.value = undefined;
    item('panel', 'descent', /^Links here/).act?.();
    expect(middle.value).toBe('links');
    expect(items('panel', 'timeline').some(({ words }) => / here$/.test(words))).toBe(false);
  });
});

describe('layouts', () => {
  it('are saved as what the places show, chosen, and removed; what the server refuses is said', async () => {
    showView({ data: 'links', plots: [['altitude_m', 'speed_mps']] });
    const kept: { name: string; view: string; saved: string }[] = [];
    server.routes['GET /layouts'] = () => ({ json: { layouts: kept, layouts_max: 32 } });
    server.routes['PUT /layouts/Entry%202'] = () => {
      kept.push({
        name: 'Entry 2',
        view: String((server.asked.at(-1)?.body as { view?: string } | undefined)?.view),
        saved: '',
      });
      return { json: {} };
    };
    openedMenu.value = { kind: 'display', name: '', x: 0, y: 0, e_s: undefined, opener: undefined };
    act(() => render(<MenuView />, page.querySelector('#root')!));
    act(() => [...page.querySelectorAll<HTMLElement>('[role=menuitem]')].at(-1)?.click());
    const field = page.querySelector<HTMLInputElement>('[data-testid=layout-name]')!;
    expect(document.activeElement).toBe(field);
    const save = async (name: string) => {
      act(() => {
        field.value = name;
        field.dispatchEvent(new Event('input', { bubbles: true }));
      });
      await act(
        async () =>
          void page.querySelector('form')?.dispatchEvent(new Event('submit', { bubbles: true, cancelable: true })),
      );
    };
    await save('Entry 2');
    await vi.waitFor(() =>
      expect(layouts.value).toEqual([{ name: 'Entry 2', view: 'data=links&channels=altitude_m+speed_mps', saved: '' }]),
    );
    server.routes['PUT /layouts/more'] = { status: 409, json: { error: 'there are 32 layouts' } };
    await save('more');
    await vi.waitFor(() =>
      expect(page.querySelector('[role=alert]')?.textContent).toContain('more was not saved: there are 32 layouts'),
    );
    closeMenu();
    showView({});
    expect(items('display').find(({ words }) => words === 'Layout: Entry 2')?.checked).toBe(false);
    items('display')
      .find(({ words }) => words === 'Layout: Entry 2')
      ?.act?.();
    expect([tab.value, plots.value]).toEqual(['links', [['altitude_m', 'speed_mps']]]);
    items('display')
      .find(({ words }) => words === 'Layout: as the console comes')
      ?.act?.();
    expect([tab.value, plots.value, sound.value]).toEqual(['channels', undefined, 'off']);
  });
});

describe('the bytes of a value', () => {
  it('are those of the packet that brought the sample shown, also in a past', async () => {
    const heard: string[] = [];
    useForTest(aStore([samples(850, { 3: 1 }), samples(860, { 3: 2 })]), aDictionary, (message) => {
      if (message.type === 'ask') heard.push(message.path);
    });
    lookAtPast({ from: -1000, to: -145 }, true);
    open('1');
    act(() =>
      [...page.querySelectorAll<HTMLElement>('[role=menuitem]')]
        .find((each) => /^Its bytes/.test(each.textContent ?? ''))
        ?.click(),
    );
    await vi.waitFor(() => expect(heard[0]).toMatch(/packets\?name=Navigation&from=849\.999&to=850\.001/));
  });
});

describe('by touch and by mouse', () => {
  it('a long press opens the menu, a shorter one, a moving finger and a field do not; a right click does', () => {
    listenForMenus();
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] });
    const field = document.createElement('input');
    value('2').append(field);
    const touch = (type: string, on: Element, x = 0) =>
      on.dispatchEvent(new PointerEvent(type, { pointerType: 'touch', clientX: x, clientY: 0, bubbles: true }));
    const opens = (act_: () => void) => {
      openedMenu.value = undefined;
      act_();
      return openedMenu.peek()?.name;
    };
    const press_ = (on: Element, ms: number, moves = 0) => {
      touch('pointerdown', on);
      if (moves > 0) touch('pointermove', on, moves);
      vi.advanceTimersByTime(ms);
      touch('pointerup', on);
      vi.advanceTimersByTime(1000);
    };
    expect(opens(() => press_(value('2'), 600))).toBe('speed_mps');
    expect(opens(() => press_(value('2'), 300))).toBeUndefined();
    expect(opens(() => press_(value('2'), 600, 30))).toBeUndefined();
    expect(opens(() => press_(field, 600))).toBeUndefined();
    const click = (on: Element) => on.dispatchEvent(new MouseEvent('contextmenu', { bubbles: true, cancelable: true }));
    expect(opens(() => void click(value('1')))).toBe('altitude_m');
    expect(opens(() => void click(field))).toBeUndefined();
    expect(opens(() => void click(page))).toBeUndefined();
    vi.useRealTimers();
  });
  it('the button beside the value under the mouse ends where it is in sight, and is gone when that moves', () => {
    const [row, other] = [value('1'), value('3')];
    const isAt = (element: Element, right: number) => {
      element.getBoundingClientRect = () =>
        ({ left: 0, top: 100, right, bottom: 120, width: right, height: 20 }) as DOMRect;
    };
    const point = (on: Element) => {
      on.dispatchEvent(new PointerEvent('pointerover', { pointerType: 'mouse', bubbles: true }));
      return pointed.value && [pointed.value.x, pointed.value.y];
    };
    const panel = document.getElementById('one')!;
    isAt(panel, 600);
    isAt(row, 300);
    isAt(other, 5000);
    expect(point(row)).toEqual([300, 110]);
    expect(point(page)).toBeUndefined();
    isAt(row, 1390); // a row of a table that is wider than its panel
    panel.style.overflowX = 'auto';
    expect(point(row)).toEqual([600, 110]);
    expect(point(other)).toEqual([innerWidth - 10, 110]);
    window.dispatchEvent(new Event('resize'));
    expect(pointed.value).toBeUndefined();
  });
});
