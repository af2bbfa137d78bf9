// SPDX-License-Identifier: Apache-2.0
// The served description is true of a running run too, and for each role by cookie and by token: every answer must be
// one that is described, in the described shape. The examples in its text run unchanged.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import path from 'node:path';
import { test } from 'node:test';
import { documented } from '../openapi.mjs';
import { temporaryFolder, waitFor, workplace } from '../support.mjs';

const { serve } = workplace();

test('during a live run every route answers as it says, and the examples of the document run as they stand', async (t) => {
  const server = await serve(t, 'openapi_live', ['--scenario', 'nominal', '--pace', '1']);
  await waitFor(
    () =>
      server
        .get('/runs/latest/channels?names=edl_phase&points=10')
        .then((list) => list.channels?.[0]?.sclk?.length ?? 0),
    (samples) => samples > 0,
  );
  const { text, callAll } = await documented(server);
  const examples = [...text.matchAll(/^ +(curl .*)$/gm)].map(([, line]) => line);
  assert.ok(examples.length >= 9, text.slice(0, 2000));
  for (const example of examples) {
    const here = example
      .replaceAll('http://127.0.0.1:8080', server.address)
      .replace(/^curl /, "curl -s -w '\\n%{http_code}' ");
    const said = execFileSync('bash', ['-e', '-c', here], { encoding: 'utf8' });
    const [, answer, status] = /^([^]*)\n(\d+)$/.exec(said);
    assert.match(status, /^20[012]$/, `${example}: ${said.slice(0, 300)}`);
    if (example.includes('format=csv')) assert.match(answer, /^seq,event\.id,event\.name,/, example);
    else if (example.includes('format=jsonl'))
      answer
        .split('\n')
        .filter(Boolean)
        .map((line) => JSON.parse(line));
    else JSON.parse(answer);
  }
  const { wrong, statuses } = await callAll({}, ['delete /api/v1/rehearsals/current']);
  assert.deepEqual(wrong, []);
  assert.equal(statuses.get('post /api/v1/runs/{run}/commands'), 202, 'the run listens');
});

test('with accounts every route answers each role, by cookie and by token, as it says', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const server = await serve(t, 'openapi_accounts', [
    '--scenario',
    'nominal',
    '--pace',
    '1',
    '--accounts',
    path.join(folder, 'accounts.json'),
  ]);
  await waitFor(async () => server.said(), /administrator with \S+/);
  const first = /administrator with (\S+)/.exec(server.said())[1];
  const ask = (method, route, body, headers = {}) =>
    fetch(`${server.address}/api/v1${route}`, { method, headers, body: body && JSON.stringify(body) });
  /** Logs in and sets a password of one's own. */
  const cookieOf = async (user, given) => {
    const password = `a password of ${user}`;
    const opened = await ask('POST', '/session', { user, password: given });
    const cookie = opened.headers.get('set-cookie').split(';')[0];
    assert.equal((await ask('PATCH', `/users/${user}`, { current_password: given, password }, { cookie })).status, 200);
    const again = await ask('POST', '/session', { user, password });
    return again.headers.get('set-cookie').split(';')[0];
  };
  const { callAll } = await documented({ ...server, address: server.address });
  const administrator = { cookie: await cookieOf('administrator', first) };
  // Calls left out: they would end the session, add a user twice, or pause the run for later calls.
  const once = [
    'delete /api/v1/session',
    'post /api/v1/session',
    'post /api/v1/users',
    'delete /api/v1/rehearsals/current',
  ];
  const seen = {};
  const { wrong: unknown, statuses: nobody } = await callAll({}, once);
  assert.deepEqual(unknown, []);
  assert.equal(nobody.get('get /api/v1/runs'), 401);
  for (const role of ['observer', 'controller', 'director', 'instructor', 'administrator']) {
    const user = `one_${role}`;
    assert.equal(
      (await ask('POST', '/users', { user, role, password: 'given by another' }, administrator)).status,
      201,
    );
    const cookie = await cookieOf(user, 'given by another');
    const token = (await (await ask('POST', '/tokens', { name: `of-${role}`, role }, administrator)).json()).token;
    for (const [by, headers] of [
      ['cookie', { cookie }],
      ['token', { authorization: `Bearer ${token}` }],
    ]) {
      const { wrong, statuses } = await callAll(headers, once);
      assert.deepEqual(wrong, [], `${role} by ${by}`);
      seen[`${role} ${by}`] = statuses;
    }
  }
  for (const by of ['cookie', 'token']) {
    assert.equal(seen[`observer ${by}`].get('get /api/v1/runs'), 200, by);
    assert.equal(seen[`observer ${by}`].get('post /api/v1/runs/{run}/commands'), 403, by);
    assert.equal(seen[`controller ${by}`].get('post /api/v1/runs/{run}/notes'), 201, by);
  }
});
