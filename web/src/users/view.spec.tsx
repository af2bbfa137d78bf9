// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { aServer } from '../testing/server';
import { useForTest } from '../run/session';
import { aDictionary } from '../testing/fixtures';
import {
  addToken,
  addUser,
  audit,
  auditBefore,
  message,
  newToken,
  offersFor,
  refreshUsers,
  removeUser,
  setCommands,
  setRole,
  tokens,
  users,
} from './model';
import { Users } from './view';

const server = aServer();
beforeEach(() => {
  message.value = undefined;
  newToken.value = undefined;
  server.routes['GET /users'] = {
    json: {
      users: [
        { user: 'ann', role: 'administrator' },
        { user: 'bob/../x', role: 'observer' },
      ],
    },
  };
  server.routes['GET /tokens'] = { json: { tokens: [{ name: 'plotter', role: 'observer' }] } };
  server.routes['GET /audit?order=newest&after=0&limit=100'] = {
    json: {
      entries: [
        {
          entry: '1',
          at: '2026-11-22T12:00:00Z',
          who: 'ann',
          from: '::1',
          action: 'log-in',
          detail: 'ann',
          outcome: 'done',
          hash: 'ff',
        },
      ],
    },
  };
});

describe('users', () => {
  it('are listed, added, changed and removed by their own names, whatever stands in them', async () => {
    await refreshUsers();
    expect([users.value.length, tokens.value.length]).toEqual([2, 1]);
    server.routes['POST /users'] = { json: {} };
    server.routes['PATCH /users/bob%2F..%2Fx'] = { json: {} };
    server.routes['DELETE /users/bob%2F..%2Fx'] = {};
    expect([
      await addUser('eve', 'controller', 'secret'),
      await setRole('bob/../x', 'director'),
      await removeUser('bob/../x'),
    ]).toEqual([true, true, true]);
    expect(server.asked.filter((each) => each.method !== 'GET').map((each) => each.body)).toEqual([
      { user: 'eve', role: 'controller', password: 'secret' },
      { role: 'director' },
      undefined,
    ]);
  });
  it('that cannot be changed say why', async () => {
    server.routes['POST /users'] = { status: 409, json: { error: 'ann exists' } };
    await addUser('ann', 'observer', 'x');
    expect(message.value).toEqual({ good: false, text: 'not done: ann exists' });
  });
  it('may be given a list of commands, of names that the dictionary has; an empty one takes it back', async () => {
    useForTest(undefined, aDictionary);
    server.routes['PATCH /users/eve'] = { json: {} };
    server.routes['POST /users'] = { json: {} };
    server.routes['POST /tokens'] = { json: { name: 'reader', token: 'x' } };
    expect([await setCommands('eve', 'no_op, EDL_DO_EDL no_op'), await setCommands('eve', '  ')]).toEqual([true, true]);
    expect([
      await addUser('eve', 'controller', 'secret', 'NO_OP'),
      await addToken('reader', 'controller', 'NO_OP'),
    ]).toEqual([true, true]);
    expect(server.asked.filter((each) => each.method !== 'GET').map((each) => each.body)).toEqual([
      { commands: ['NO_OP', 'EDL_DO_EDL'] },
      { all_commands: true },
      { user: 'eve', role: 'controller', password: 'secret', commands: ['NO_OP'] },
      { name: 'reader', role: 'controller', commands: ['NO_OP'] },
    ]);
    const before = server.asked.length;
    expect(await setCommands('eve', 'NO_OP DO_A_BARREL_ROLL')).toBe(false);
    expect([message.value?.text, server.asked.length]).toEqual([
      'not done: the dictionary has no command DO_A_BARREL_ROLL',
      before,
    ]);
    expect([offersFor('NO_OP edl_s', aDictionary.commands), offersFor('NO_OP ', aDictionary.commands)]).toEqual([
      ['NO_OP EDL_SET_PARAMETERS', 'NO_OP EDL_SET_TIMEPOINT_OFFSET'],
      [],
    ]);
  });
  it('have tokens that are shown once', async () => {
    server.routes['POST /tokens'] = { json: { name: 'reader', token: 'aeolis-123' } };
    await addToken('reader', 'observer');
    expect(newToken.value).toEqual({ name: 'reader', token: 'aeolis-123' });
  });
  it('leave entries in the audit', async () => {
    await refreshUsers();
    expect(audit.value.map((each) => [each.entry, each.who, each.action, each.outcome])).toEqual([
      ['1', 'ann', 'log-in', 'done'],
    ]);
  });
});

describe('the audit', () => {
  it('begins with the newest of a thousand, and goes back a page at a time', async () => {
    const COUNT = 1234;
    server.routes = new Proxy(server.routes, {
      get: (routes, key: string) => {
        const [, after = '', limit = ''] = /^GET \/audit\?order=newest&after=(\d+)&limit=(\d+)$/.exec(key) ?? [];
        if (after === '') return routes[key];
        const newest = (Number(after) || COUNT + 1) - 1;
        const length = Math.min(Number(limit), newest);
        return { json: { entries: Array.from({ length }, (_, i) => ({ entry: String(newest - i) })) } };
      },
    });
    const shownNow = () => [audit.value.length, audit.value[0]?.entry, audit.value.at(-1)?.entry];
    await refreshUsers();
    expect(shownNow()).toEqual([100, '1234', '1135']);
    expect(server.asked.filter(({ path }) => path.startsWith('/audit')).length).toBe(1);
    for (const [before, page] of [
      ['1135', [100, '1134', '1035']],
      ['51', [50, '50', '1']],
      ['2', [1, '1', '1']],
      ['', [100, '1234', '1135']],
    ] as const) {
      auditBefore.value = before;
      await refreshUsers();
      expect(shownNow()).toEqual(page);
    }
  });
});

describe('the panel', () => {
  it('shows what each may send, and sets what was typed; nobody changes their own', async () => {
    useForTest(undefined, aDictionary);
    access.value = { state: 'in', user: 'ann', role: 'administrator', rights: [] };
    server.routes['GET /users'] = {
      json: {
        users: [
          { user: 'ann', role: 'administrator' },
          { user: 'eve', role: 'controller', commands: ['NO_OP'] },
        ],
      },
    };
    server.routes['PATCH /users/eve'] = { json: {} };
    const root = shown();
    await act(() => new Promise<void>((done) => setTimeout(done, 10)));
    const field = root.querySelector<HTMLInputElement>('[aria-label="commands that eve may send"]');
    expect([
      field?.value,
      root.querySelector('[aria-label="commands that ann may send"]'),
      root.querySelector('[data-user="ann"]')?.textContent,
    ]).toEqual(['NO_OP', null, expect.stringContaining('all of the role')]);
    field!.value = 'edl_do_edl';
    act(() => void field!.dispatchEvent(new Event('input', { bubbles: true })));
    field!.form!.dispatchEvent(new Event('submit', { bubbles: true, cancelable: true }));
    await act(() => new Promise<void>((done) => setTimeout(done, 10)));
    expect(server.asked.find((each) => each.method === 'PATCH')).toMatchObject({
      path: '/users/eve',
      body: { commands: ['EDL_DO_EDL'] },
    });
  });
  const shown = () => {
    const root = document.createElement('div');
    act(() => render(<Users />, root));
    return root;
  };
  it('is for administrators, and tells everyone else why not', () => {
    access.value = { state: 'in', user: 'eve', role: 'director', rights: [] };
    expect(shown().textContent).toContain('Users are for administrators; you are eve, director.');
    access.value = { state: 'open' };
    expect(shown().textContent).toContain('without accounts');
  });
  it('removes at the second press only, and offers no one to remove themselves', () => {
    access.value = { state: 'in', user: 'ann', role: 'administrator', rights: [] };
    users.value = [
      { user: 'ann', role: 'administrator' },
      { user: 'eve', role: 'observer' },
    ];
    const root = shown();
    const before = server.asked.length;
    expect(root.querySelectorAll('[data-user="ann"] [aria-label^="remove"]')).toHaveLength(0);
    act(() => root.querySelector<HTMLButtonElement>('[aria-label="remove eve"]')?.click());
    expect(server.asked.slice(before).filter((each) => each.method === 'DELETE')).toHaveLength(0);
    act(() => root.querySelector<HTMLButtonElement>('[aria-label="really remove eve"]')?.click());
    expect(server.asked.filter((each) => each.method === 'DELETE').map((each) => each.path)).toEqual(['/users/eve']);
  });
});
