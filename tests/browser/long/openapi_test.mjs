// SPDX-License-Identifier: Apache-2.0
// The served description is a valid OpenAPI document, and it is true: each route is called on a finished run, on a
// running one, and as each role by cookie and by token; every answer must be one that is described, in the described
// shape. The examples in its text run unchanged.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import path from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { root, temporaryFolder, waitFor, workplace } from '../support.mjs';

const web = createRequire(path.join(root, 'web/package.json'));
const { Validator } = await import(pathToFileURL(web.resolve('@seriousme/openapi-schema-validator')));
const fromValidator = createRequire(web.resolve('@seriousme/openapi-schema-validator'));
const Ajv = fromValidator('ajv');
const YAML = fromValidator('yaml');

const { serve } = workplace();

/** What a call needs beyond its path; other routes are called without parameters. */
const QUERY = {
  '/api/v1/runs/{run}/channels': '?names=altitude_m&points=10&provenance=true',
  '/api/v1/runs/{run}/prediction': '?channels=altitude_m',
};
const BODY = {
  'post /api/v1/runs/{run}/commands': { command: 'NO_OP', dry_run: true },
  'post /api/v1/runs/{run}/sequences': { dry_run: true, commands: [{ command: 'NO_OP' }] },
  'post /api/v1/runs/{run}/alarms': { channel: 'altitude_m', action: 'shelve', shelve_s: 60, by: 'Ada' },
  'post /api/v1/runs/{run}/notes': { text: 'seen', by: 'Ada' },
  'post /api/v1/rehearsals': { scenario: 'none of this name' },
  'post /api/v1/rehearsals/current': { pause: true },
  'patch /api/v1/rehearsals/current': { pause: true },
  'post /api/v1/session': { user: 'ann', password: 'x' },
  'post /api/v1/users': { user: 'ann', role: 'observer', password: 'x' },
  'patch /api/v1/users/{user}': { role: 'observer' },
  'put /api/v1/layouts/{layout}': { view: 'data=links' },
  'post /api/v1/tokens': { name: 'reader', role: 'observer' },
};

/** The server's own document, with a function that calls every route and compares the answers with the description. */
async function documented(server) {
  const text = await (await fetch(`${server.address}/api/v1/openapi.yaml`)).text();
  const description = YAML.parse(text);
  const ajv = new Ajv({ strict: false, validateFormats: false });
  ajv.addSchema({ $id: 'aeolis', components: description.components });
  const resolved = (part) =>
    part?.$ref
      ? part.$ref
          .slice(2)
          .split('/')
          .reduce((from, name) => from[name], description)
      : part;
  /** @returns deviations from the description, and the status by "method route" */
  const callAll = async (headers = {}, leftOut = []) => {
    const wrong = [],
      statuses = new Map();
    for (const [route, operations] of Object.entries(description.paths)) {
      for (const [method, operation] of Object.entries(operations).filter(([name]) => name !== 'parameters')) {
        if (leftOut.includes(`${method} ${route}`)) continue;
        const target =
          route.replace('{run}', 'latest').replace(/\{\w+\}/, 'nobody') +
          (method === 'get' ? (QUERY[route] ?? '') : '');
        const body = BODY[`${method} ${route}`];
        const answer = await fetch(server.address + target, {
          method: method.toUpperCase(),
          headers,
          body: body && JSON.stringify(body),
        });
        const said = await answer.text();
        statuses.set(`${method} ${route}`, answer.status);
        const name = `${method} ${target} -> ${answer.status}`;
        const described = resolved(operation.responses[answer.status]);
        if (!described) {
          wrong.push(`${name}: this status is not described; ${said.slice(0, 200)}`);
          continue;
        }
        const schema = (described.content?.['application/json'] ?? described.content?.['application/problem+json'])
          ?.schema;
        if (!schema) continue;
        const fits = ajv.compile(JSON.parse(JSON.stringify(schema).replaceAll('"#/', '"aeolis#/')));
        if (!fits(JSON.parse(said))) wrong.push(`${name}: ${ajv.errorsText(fits.errors)}; ${said.slice(0, 200)}`);
      }
    }
    return { wrong, statuses };
  };
  return { text, description, callAll };
}

test('the OpenAPI document is valid, and every route answers as it says', async (t) => {
  const server = await serve(t, 'openapi', ['--scenario', 'nominal_auto', '--pace', '0']);
  await waitFor(() => server.get('/runs/latest').then((run) => run.state), /finished/);
  const { description, callAll } = await documented(server);
  const { valid, errors } = await new Validator().validate(structuredClone(description));
  assert.ok(valid, JSON.stringify(errors, null, 1));
  const { wrong, statuses } = await callAll();
  assert.deepEqual(wrong, []);
  assert.ok(statuses.size > 30);
});

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
  for (const role of ['observer', 'controller', 'director', 'administrator']) {
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
