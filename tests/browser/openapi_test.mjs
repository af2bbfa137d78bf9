// The description that the server serves is a valid OpenAPI document, and what it says is so: each route is called on a run that was
// flown, and its answer is one that is described, of the shape that is described.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { root, waitFor, workplace } from './support.mjs';

const web = createRequire(path.join(root, 'web/package.json'));
const { Validator } = await import(pathToFileURL(web.resolve('@seriousme/openapi-schema-validator')));
const fromValidator = createRequire(web.resolve('@seriousme/openapi-schema-validator'));
const Ajv = fromValidator('ajv');
const YAML = fromValidator('yaml');

const { serve } = workplace();

/** What a call needs beyond its path; a route that is not here is called bare. */
const QUERY = { '/api/v1/runs/{run}/channels': '?names=altitude_m&points=10' };
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
    'post /api/v1/tokens': { name: 'reader', role: 'observer' },
};

test('the OpenAPI document is valid, and every route answers as it says', { timeout: 60_000 }, async (t) => {
    const server = await serve(t, 'openapi', ['--scenario', 'nominal_auto', '--pace', '0']);
    await waitFor(() => server.get('/runs/latest').then((run) => run.state), /finished/, 40_000);
    const text = await (await fetch(`${server.address}/api/v1/openapi.yaml`)).text();
    const description = YAML.parse(text);
    const { valid, errors } = await new Validator().validate(structuredClone(description));
    assert.ok(valid, JSON.stringify(errors, null, 1));

    const ajv = new Ajv({ strict: false, validateFormats: false });
    ajv.addSchema({ $id: 'aeolis', components: description.components });
    const resolved = (part) => (part?.$ref ? part.$ref.slice(2).split('/').reduce((from, name) => from[name], description) : part);
    const wrong = [];
    let calls = 0;
    for (const [route, operations] of Object.entries(description.paths)) {
        for (const [method, operation] of Object.entries(operations).filter(([name]) => name !== 'parameters')) {
            const target = route.replace('{run}', 'latest').replace(/\{\w+\}/, 'nobody') + (method === 'get' ? QUERY[route] ?? '' : '');
            const body = BODY[`${method} ${route}`];
            const answer = await fetch(server.address + target, { method: method.toUpperCase(), body: body && JSON.stringify(body) });
            const said = await answer.text();
            const name = `${method} ${target} -> ${answer.status}`;
            ++calls;
            const described = resolved(operation.responses[answer.status]);
            if (!described) {
                wrong.push(`${name}: this status is not described; ${said.slice(0, 200)}`);
                continue;
            }
            const schema = described.content?.['application/json']?.schema;
            if (!schema) continue;
            const fits = ajv.compile(JSON.parse(JSON.stringify(schema).replaceAll('"#/', '"aeolis#/')));
            if (!fits(JSON.parse(said))) wrong.push(`${name}: ${ajv.errorsText(fits.errors)}; ${said.slice(0, 200)}`);
        }
    }
    assert.deepEqual(wrong, []);
    assert.ok(calls > 30);
});
