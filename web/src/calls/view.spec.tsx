// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { access } from '../access/model';
import { uplink } from '../commands/line';
import { DictionaryReplySchema } from '../gen/aeolis/v1/run_pb';
import { notes } from '../notes/model';
import type { NoteRow } from '../notes/model';
import { Dictionary } from '../run/dictionary';
import { useForTest } from '../run/session';
import { notices } from '../run/shown';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { callsOf, problem, readBackWords, toReadBack, waiting } from './model';
import { askCalls, callsAsked, callsReady, callsShown } from './opened';
import { Calls } from './view';

const server = aServer();
const words = new Dictionary(
  create(DictionaryReplySchema, {
    channels: aDictionary.reply.channels,
    calls: [
      { call: 'seen', key: 'p', says: 'Parachute seen' },
      { call: 'tone', key: 't', says: 'Tone heard', asks: 'which tone' },
    ],
    readBackS: 20,
  }),
);
const row = (seq: number, by: string, ert_s: number, readsBack = 0): NoteRow => ({
  seq,
  by,
  ert_s,
  readsBack,
  text: `line ${seq}`,
  call: 'seen',
  sclk: undefined,
});
const plain: NoteRow = { ...row(3, 'Ann', 5), call: '' };

let root: HTMLElement;
beforeEach(() => {
  access.value = { state: 'open' } as typeof access.value;
  uplink.value = { ...uplink.value, controller: 'Bob' };
  notes.value = undefined;
  callsAsked.value = 'nothing';
  callsReady.value = true;
  problem.value = '';
  root = document.body.appendChild(document.createElement('div'));
});
afterEach(() => {
  act(() => render(null, root));
  root.remove();
});
const shown = () =>
  act(() => {
    useForTest(aStore([], aRun()), words);
    render(<Calls />, root);
  });
const press = (key: string, on = root.querySelector<HTMLElement>('[data-testid=calls]')) =>
  act(async () => void on?.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true })));
const posted = () => server.asked.filter(({ method }) => method === 'POST').map(({ body }) => body);
const part = (name: string) => root.querySelector<HTMLInputElement>(`[data-testid=${name}]`);

it('a call has the first line that reads it back; other lines of the log are no calls', () => {
  const calls = callsOf([row(1, 'Ann', 0), row(2, 'Cem', 1), plain, row(4, 'Bob', 4, 1), row(5, 'Cem', 6, 1)]);
  expect(calls.map(({ made, readBack }) => [made.seq, readBack?.seq])).toEqual([
    [1, 4],
    [2, undefined],
  ]);
});

it('a read-back is told with its delay, and one that did not come as a fact', () => {
  const call = { made: row(1, 'Ann', 100), readBack: undefined };
  expect(readBackWords({ ...call, readBack: row(2, 'Bob', 104, 1) }, 500, 20)).toEqual({
    words: 'read back by Bob 4.0 s later',
    state: 'done',
  });
  expect(readBackWords(call, 110, 20)).toEqual({ words: 'not read back yet', state: 'waits' });
  expect(readBackWords(call, 130, 20)).toEqual({ words: 'not read back for 30.0 s', state: 'late' });
  expect(readBackWords(call, 110, 20, true)).toEqual({ words: 'not read back', state: 'late' });
});

it('the newest call of another is the one that a key reads back, and none that is old or one’s own', () => {
  const calls = waiting([row(1, 'Ann', 0), row(2, 'Ann', 400), row(3, 'Cem', 410), row(4, 'Bob', 420)], 430);
  expect(calls.map(({ made }) => made.seq)).toEqual([4, 3, 2]);
  expect(toReadBack(calls)?.made.seq).toBe(3);
});

it('the list makes a call by one key, and asks for what a call needs', async () => {
  server.routes['POST /runs/1/notes'] = { json: {} };
  server.routes['GET /runs/1/notes'] = { json: { notes: [] } };
  shown();
  await act(() => askCalls('list'));
  expect(part('calls')?.textContent).toContain('p Parachute seen');
  await press('p');
  await vi.waitFor(() => expect(part('calls')).toBeNull());
  expect(posted()).toEqual([{ by: 'Bob', position: '', call: 'seen' }]);

  await act(() => askCalls('list'));
  await press('t');
  const given = part('call-given')!;
  given.value = '165';
  await act(() => void given.dispatchEvent(new Event('input', { bubbles: true })));
  await press('p', given); // a letter in the field is a letter
  expect(posted()).toHaveLength(1);
  await press('Enter', given);
  await vi.waitFor(() => expect(posted()[1]).toEqual({ by: 'Bob', position: '', call: 'tone', text: '165' }));
});

it('what the server refuses stays in the list with the reason, and Escape leaves it', async () => {
  server.routes['POST /runs/1/notes'] = { status: 409, json: { error: 'gnc is held by Ann' } };
  server.routes['GET /runs/1/notes'] = { json: { notes: [] } };
  shown();
  await act(() => askCalls('list'));
  await press('p');
  await vi.waitFor(() => expect(part('call-problem')?.textContent).toContain('gnc is held by Ann'));
  await press('Escape');
  expect(part('calls')).toBeNull();
});

it('a call that waits is shown until it is read back, by one key or its button', async () => {
  const made = {
    seq: '4',
    ert_us: '0',
    note: { text: 'GNC: Parachute seen', by: 'Ann', call: 'seen', reads_back: '0' },
  };
  server.routes['GET /runs/1/notes'] = { json: { notes: [made] } };
  server.routes['GET /runs/1/notes?after=4'] = { json: { notes: [] } };
  server.routes['POST /runs/1/notes'] = { json: {} };
  const run = aStore([], aRun());
  made.ert_us = String(run.clocks?.ertUs);
  await act(() => {
    useForTest(run, words);
    render(<Calls />, root);
  });
  await vi.waitFor(() => expect(part('calls-waiting')?.textContent).toContain('GNC: Parachute seen'));
  expect(part('calls-waiting')?.textContent).toContain('Ann, not read back yet read back 6');
  await act(() => askCalls('read back'));
  await vi.waitFor(() => expect(posted()).toEqual([{ by: 'Bob', position: '', reads_back: '4' }]));
  await vi.waitFor(() => expect(callsAsked.value).toBe('nothing'));
});

it('without a list, without a run that goes on, or for observers no call is made, and it is said why', () => {
  useForTest(aStore([], aRun()), aDictionary);
  askCalls('list');
  expect([callsAsked.value, callsShown()]).toEqual(['nothing', false]);
  expect(notices.value.at(-1)?.text).toBe('No call: the mission has no standard calls.');
  useForTest(aStore([], aRun({ state: 'finished' })), words);
  askCalls('list');
  expect(notices.value.at(-1)?.text).toContain('while a run goes on');
});
