// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { aServer } from '../testing/server';
import { readAll } from './pages';

const server = aServer();

it('a list is read page by page to its end, with what its last page says besides', async () => {
  server.routes['GET /layouts'] = {
    json: { layouts: [{ name: 'a' }, { name: 'b' }], layouts_max: 32, next_after: '2' },
  };
  server.routes['GET /layouts?after=2'] = { json: { layouts: [{ name: 'c' }], layouts_max: 32, next_after: '0' } };
  const list = await readAll<{ layouts: { name: string }[]; layouts_max: number }, 'layouts'>('/layouts', 'layouts');
  expect(list.layouts.map(({ name }) => name)).toEqual(['a', 'b', 'c']);
  expect(list.layouts_max).toBe(32);
});

it('a list without rows is an empty list', async () => {
  server.routes['GET /users'] = { json: {} };
  expect((await readAll<{ users: unknown[] }, 'users'>('/users', 'users')).users).toEqual([]);
});
