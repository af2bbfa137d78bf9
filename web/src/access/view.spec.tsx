// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, describe, expect, it } from 'vitest';
import { call } from '../run/api';
import { useForTest } from '../run/session';
import { takesCommands } from '../run/shown';
import { aDictionary, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import {
  access,
  choosePassword,
  learnAccess,
  logIn,
  mayAct,
  mayInstruct,
  mayRehearse,
  problem,
  whyNotInstruct,
} from './model';
import { ExpiredBar, LogIn } from './log_in';
import { Who } from './view';

const server = aServer();
const session = (user: string, role = 'controller') => ({ json: { accounts: true, user, role, rights: ['command'] } });

beforeEach(() => {
  access.value = { state: 'asking' };
  problem.value = '';
});

describe('access', () => {
  it('is open to all where there are no accounts, and where the server knows of none', async () => {
    await learnAccess();
    expect([access.value.state, mayAct()]).toEqual(['none', true]);
    server.routes['GET /session'] = { json: { accounts: false, user: '', role: 'administrator', rights: [] } };
    await learnAccess();
    expect([access.value.state, mayAct()]).toEqual(['open', true]);
  });
  it('needs a log-in with accounts, is refused in the server’s words, and is then that of the user', async () => {
    server.routes['GET /session'] = session('');
    await learnAccess();
    expect(access.value).toEqual({ state: 'out', expired: false, user: '' });
    server.routes['POST /session'] = { status: 401, json: { error: 'wrong user or password' } };
    await logIn('ann', 'x');
    expect([access.value.state, problem.value]).toEqual(['out', 'wrong user or password']);
    server.routes['POST /session'] = {};
    server.routes['GET /session'] = session('ann');
    await logIn('ann', 'y');
    expect(access.value).toEqual({ state: 'in', user: 'ann', role: 'controller', rights: ['command'] });
    expect(server.asked.filter((each) => each.method === 'POST').map((each) => each.body)).toEqual([
      { user: 'ann', password: 'x' },
      { user: 'ann', password: 'y' },
    ]);
  });
  it('with a password that another gave asks for one of their own before anything else', async () => {
    server.routes['GET /session'] = {
      json: { accounts: true, user: 'ann', role: 'director', rights: [], choose_password: true },
    };
    await learnAccess();
    expect(access.value).toEqual({ state: 'choose', user: 'ann' });
    await choosePassword('given', 'one of my own', 'one of my won');
    expect([problem.value, server.asked.length]).toEqual(['the two are not the same: type them again', 1]);
    server.routes['PATCH /users/ann'] = {};
    server.routes['GET /session'] = session('ann', 'director');
    await choosePassword('given', 'one of my own', 'one of my own');
    expect(access.value.state).toBe('in');
    expect(server.asked[1]?.body).toEqual({ current_password: 'given', password: 'one of my own' });
  });
  it('of an observer sends nothing', async () => {
    useForTest(aStore(), aDictionary);
    server.routes['GET /session'] = session('eve', 'observer');
    await learnAccess();
    expect(takesCommands()).toBe(false);
    server.routes['GET /session'] = session('ann');
    await learnAccess();
    expect(takesCommands()).toBe(true);
  });
  it('of a director starts rehearsals and does not instruct; an instructor’s does both, and so does everybody’s without accounts', () => {
    const may = (rights: string[]) => {
      access.value = { state: 'in', user: 'dan', role: 'director', rights };
      return [mayRehearse(), mayInstruct()];
    };
    expect(may(['watch', 'rehearse'])).toEqual([true, false]);
    expect(whyNotInstruct('faults')).toBe('faults need the right to instruct; you are dan, director');
    expect(may(['watch', 'rehearse', 'instruct'])).toEqual([true, true]);
    access.value = { state: 'open' };
    expect([mayRehearse(), mayInstruct(), whyNotInstruct('faults')]).toEqual([true, true, '']);
  });
  it('that ends in the middle of something says so in place, and what was under way is not sent again', async () => {
    server.routes['GET /session'] = session('ann');
    await learnAccess();
    server.routes['POST /runs/1/notes'] = { status: 401, json: { error: 'log in' } };
    await expect(call('POST', '/runs/1/notes', { text: 'a' })).rejects.toThrow('log in');
    expect(access.value).toEqual({ state: 'out', expired: true, user: 'ann' });
    server.routes['POST /session'] = {};
    await logIn('ann', 'y');
    expect(access.value.state).toBe('in');
    expect(server.asked.filter((each) => each.path === '/runs/1/notes')).toHaveLength(1);
  });
});

describe('what is shown of it', () => {
  const shown = (element: preact.ComponentChild) => {
    const root = document.createElement('div');
    act(() => render(element, root));
    return root;
  };
  it('is the form, a bar over what is old, or who I am', () => {
    access.value = { state: 'out', expired: true, user: 'ann' };
    expect(shown(<ExpiredBar />).textContent).toContain('Your session has ended');
    expect(shown(<ExpiredBar />).querySelector<HTMLInputElement>('[data-testid="log-in-user"]')?.value).toBe('ann');
    expect(shown(<LogIn />).querySelector<HTMLInputElement>('[data-testid="log-in-password"]')?.type).toBe('password');
    access.value = { state: 'in', user: '<b>ann</b>', role: 'observer', rights: [] };
    expect(shown(<Who />).textContent).toMatch(/<b>ann<\/b>observer, only looks/);
    access.value = { state: 'open' };
    expect(shown(<Who />).textContent).toContain('no accounts');
  });
});
