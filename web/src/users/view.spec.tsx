// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { aServer } from '../testing/server';
import { addToken, addUser, audit, message, newToken, refreshUsers, removeUser, setRole, tokens, users } from './model';
import { Users } from './view';

const server = aServer();
beforeEach(() => {
  message.value = undefined;
  newToken.value = undefined;
  server.routes['GET /users'] = { json: { users: [{ user: 'ann', role: 'administrator' }, { user: 'bob/../x', role: 'observer' }] } };
  server.routes['GET /tokens'] = { json: { tokens: [{ name: 'plotter', role: 'observer' }] } };
  server.routes['GET /audit?limit=100'] = { json: { entries: [{ entry: '1', at: '2026-11-22T12:00:00Z', who: 'ann', from: '::1', action: 'log-in', detail: 'ann', outcome: 'done', hash: 'ff' }] } };
});

describe('users', () => {
  it('are listed, added, changed and removed by their own names, whatever stands in them', async () => {
    await refreshUsers();
    expect([users.value.length, tokens.value.length]).toEqual([2, 1]);
    server.routes['POST /users'] = { json: {} };
    server.routes['PATCH /users/bob%2F..%2Fx'] = { json: {} };
    server.routes['DELETE /users/bob%2F..%2Fx'] = {};
    expect([await addUser('eve', 'controller', 'secret'), await setRole('bob/../x', 'director'), await removeUser('bob/../x')]).toEqual([true, true, true]);
    expect(server.asked.filter((each) => each.method !== 'GET').map((each) => each.body)).toEqual([{ user: 'eve', role: 'controller', password: 'secret' }, { role: 'director' }, undefined]);
  });
  it('that cannot be changed say why', async () => {
    server.routes['POST /users'] = { status: 409, json: { error: 'ann exists' } };
    await addUser('ann', 'observer', 'x');
    expect(message.value).toEqual({ good: false, text: 'not done: ann exists' });
  });
  it('have tokens that are shown once', async () => {
    server.routes['POST /tokens'] = { json: { name: 'reader', token: 'aeolis-123' } };
    await addToken('reader', 'observer');
    expect(newToken.value).toEqual({ name: 'reader', token: 'aeolis-123' });
  });
  it('leave entries in the audit', async () => {
    await refreshUsers();
    expect(audit.value.map((each) => [each.entry, each.who, each.action, each.outcome])).toEqual([['1', 'ann', 'log-in', 'done']]);
  });
});

describe('the panel', () => {
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
    users.value = [{ user: 'ann', role: 'administrator' }, { user: 'eve', role: 'observer' }];
    const root = shown();
    const before = server.asked.length;
    expect(root.querySelectorAll('[data-user="ann"] [aria-label^="remove"]')).toHaveLength(0);
    act(() => root.querySelector<HTMLButtonElement>('[aria-label="remove eve"]')?.click());
    expect(server.asked.slice(before).filter((each) => each.method === 'DELETE')).toHaveLength(0);
    act(() => root.querySelector<HTMLButtonElement>('[aria-label="really remove eve"]')?.click());
    expect(server.asked.filter((each) => each.method === 'DELETE').map((each) => each.path)).toEqual(['/users/eve']);
  });
});
