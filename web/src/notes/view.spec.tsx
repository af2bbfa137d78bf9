// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, describe, expect, it } from 'vitest';
import { useForTest } from '../run/session';
import { secondsOfDayOfYear } from '../run/time';
import { aDictionary, aStore, ertUs } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { found, notes, problem, refreshNotes, write } from './model';
import { Notes } from './view';

const server = aServer();
const a = (seq: number, text: string, at = '2012-219T04:59:00.0') => ({
  seq: String(seq),
  ert_us: String(ertUs(at)),
  note: { text, by: 'ann' },
});

beforeEach(() => {
  notes.value = undefined;
  problem.value = '';
  useForTest(aStore(), aDictionary);
});

describe('notes', () => {
  it('are put together from every page, once each, and only what is new is asked for again', async () => {
    server.routes['GET /runs/1/notes'] = { json: { notes: [a(3, 'one')], next_after: '3' } };
    server.routes['GET /runs/1/notes?after=3'] = { json: { notes: [a(3, 'one'), a(9, 'two')], next_after: '0' } };
    await refreshNotes();
    server.routes['GET /runs/1/notes?after=9'] = { json: { notes: [] } };
    await refreshNotes();
    expect(typeof notes.value === 'object' && notes.value.all.map((row) => row.text)).toEqual(['one', 'two']);
    expect(server.asked.map((each) => each.path)).toEqual([
      '/runs/1/notes',
      '/runs/1/notes?after=3',
      '/runs/1/notes?after=9',
    ]);
  });
  it('are found by any words, newest first, and in the past only what had been written', () => {
    const row = (seq: number, text: string, at: string) => ({
      seq,
      text,
      by: 'Ann',
      ert_s: secondsOfDayOfYear(at),
      sclk: undefined,
      call: '',
      readsBack: 0,
    });
    const all = [row(1, 'radar late', '2012-219T04:58:00.0'), row(2, 'radar fine', '2012-219T04:59:30.0')];
    const run = aStore();
    expect(found(all, 'ann RADAR', run, Infinity).map((each) => each.seq)).toEqual([2, 1]);
    expect(found(all, 'radar', run, 800).map((each) => each.seq)).toEqual([1]);
  });
  it('are written once, with the instant where one is meant', async () => {
    server.routes['POST /runs/1/notes'] = { json: {} };
    server.routes['GET /runs/1/notes'] = { json: { notes: [] } };
    expect(await Promise.all([write(' look ', 870), write('look', 870)])).toEqual([true, false]);
    expect(server.asked.filter((each) => each.method === 'POST').map((each) => each.body)).toEqual([
      { text: 'look', by: '', sclk: 870 },
    ]);
  });
  it('that are empty, too long or refused say so, and nothing of them is lost', async () => {
    expect([await write('  ', undefined), problem.value]).toEqual([false, 'there is nothing to write down']);
    expect([await write('ä'.repeat(2001), undefined), problem.value]).toEqual([
      false,
      'it has 4002 octets; a note has at most 4000',
    ]);
    server.routes['POST /runs/1/notes'] = { status: 401, json: { error: 'log in' } };
    expect([await write('x', undefined), problem.value]).toEqual([false, 'it was not written down: log in']);
  });
  it('are text, whatever stands in them', () => {
    const text = '<img src=x onerror=alert(1)>';
    notes.value = { run: 1, all: [{ seq: 1, text, by: '<b>', ert_s: 0, sclk: 1000, call: '', readsBack: 0 }] };
    const root = document.createElement('div');
    act(() => render(<Notes />, root));
    expect(root.querySelector('img')).toBeNull();
    expect(root.textContent).toContain('<img src=x');
    act(() => render(null, root));
  });
  it('of several lines are folded to their first; a search opens them', () => {
    const text = 'Anomaly report: radar late\nAt E+4:58.0\nAlarms: none is raised';
    notes.value = { run: 1, all: [{ seq: 1, text, by: 'Ann', ert_s: 0, sclk: 1000, call: '', readsBack: 0 }] };
    const root = document.body.appendChild(document.createElement('div'));
    act(() => render(<Notes />, root));
    const folded = () => root.querySelector('details')!;
    expect([folded().open, folded().querySelector('summary')?.textContent]).toEqual([
      false,
      'Anomaly report: radar late +2 lines',
    ]);
    expect(folded().querySelector('p')?.textContent).toBe('At E+4:58.0\nAlarms: none is raised');
    const search = root.querySelector<HTMLInputElement>('[data-testid="note-search"]')!;
    search.value = 'alarms';
    act(() => void search.dispatchEvent(new Event('input', { bubbles: true })));
    expect(folded().open).toBe(true);
    act(() => render(null, root));
  });
});
