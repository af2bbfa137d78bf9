// SPDX-License-Identifier: Apache-2.0
// The description that a server gives of itself, with functions that call what it describes and compare the answers.
import { createRequire } from 'node:module';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { root } from './support.mjs';

const web = createRequire(path.join(root, 'web/package.json'));
const { Validator } = await import(pathToFileURL(web.resolve('@seriousme/openapi-schema-validator')));
const fromValidator = createRequire(web.resolve('@seriousme/openapi-schema-validator'));
const Ajv = fromValidator('ajv');
const YAML = fromValidator('yaml');

/** What a call needs besides its required parameters, of which the description has examples. */
const ALSO = { '/api/v1/runs/{run}/channels': ['names'], '/api/v1/runs/{run}/samples': ['names'] };
/** Parameters that are alternatives to those, or that only go with another. */
const INSTEAD = { expression: 'names' };
const WITH = { arguments: 'command' };

/** Schemas in which a field that is not described is a fault. */
function strict(part) {
  if (Array.isArray(part)) return part.map(strict);
  if (part === null || typeof part !== 'object') return part;
  const all = Object.fromEntries(Object.entries(part).map(([key, value]) => [key, strict(value)]));
  return part.type === 'object' && part.properties && part.additionalProperties === undefined
    ? { ...all, additionalProperties: false }
    : all;
}

/** The server's own document, with functions that call its routes and give the deviations of the answers from it. */
export async function documented(server) {
  const text = await (await fetch(`${server.address}/api/v1/openapi.yaml`)).text();
  const description = YAML.parse(text);
  const ajv = new Ajv({ strict: false, validateFormats: false, allErrors: true });
  ajv.addSchema({ $id: 'aeolis', components: strict(description.components) });
  const resolved = (part) =>
    part?.$ref
      ? part.$ref
          .slice(2)
          .split('/')
          .reduce((from, name) => from[name], description)
      : part;
  const compiled = new Map();
  const fitsOf = (schema) => {
    const key = JSON.stringify(strict(schema)).replaceAll('"#/', '"aeolis#/');
    if (!compiled.has(key)) compiled.set(key, ajv.compile(JSON.parse(key)));
    return compiled.get(key);
  };
  const operations = Object.entries(description.paths).flatMap(([route, of]) =>
    Object.entries(of)
      .filter(([method]) => method !== 'parameters')
      .map(([method, operation]) => ({
        route,
        method,
        operation,
        parameters: [...(of.parameters ?? []), ...(operation.parameters ?? [])].map(resolved),
      })),
  );

  /** Calls an operation with these parameters. @returns the status, and the deviation or undefined */
  async function call({ route, method, operation, parameters }, given, headers) {
    const query = new URLSearchParams();
    let target = route;
    for (const { name, in: place, example } of parameters) {
      if (place === 'path') target = target.replace(`{${name}}`, encodeURIComponent(example));
      else if (given.includes(name)) query.set(name, example);
    }
    if (query.size > 0) target += `?${query}`;
    const body = resolved(operation.requestBody)?.content['application/json'].example;
    const answer = await fetch(server.address + target, {
      method: method.toUpperCase(),
      headers,
      body: body && JSON.stringify(body),
    });
    const said = await answer.text();
    const { status } = answer;
    const wrong = (why) => ({ status, wrong: `${method} ${target} -> ${status}: ${why}; ${said.slice(0, 200)}` });
    const described = resolved(operation.responses[status]);
    if (!described) return wrong('this status is not described');
    if (status === 204) return { status };
    const type = answer.headers.get('content-type').split(';')[0];
    const content = described.content?.[type];
    if (!content) return wrong(`${type} is not described`);
    for (const name of Object.keys(described.headers ?? {}))
      if (name !== 'Link' && !answer.headers.has(name)) return wrong(`the header ${name} is missing`);
    if (type === 'application/x-ndjson') for (const line of said.split('\n')) if (line) JSON.parse(line);
    if (type !== 'application/json' && type !== 'application/problem+json') return { status };
    const fits = fitsOf(content.schema);
    return fits(JSON.parse(said)) ? { status } : wrong(ajv.errorsText(fits.errors.slice(0, 3)));
  }

  const neededBy = ({ route, parameters }) => [
    ...parameters.filter(({ in: place, required }) => place === 'query' && required).map(({ name }) => name),
    ...(ALSO[route] ?? []),
  ];

  return {
    text,
    validate: () => new Validator().validate(structuredClone(description)),
    /** Calls every route once. @returns deviations from the description, and the status by "method route" */
    callAll: async (headers = {}, leftOut = []) => {
      const wrong = [],
        statuses = new Map();
      for (const each of operations) {
        const name = `${each.method} ${each.route}`;
        if (leftOut.includes(name)) continue;
        const done = await call(each, neededBy(each), headers);
        if (done.wrong) wrong.push(done.wrong);
        statuses.set(name, done.status);
      }
      return { wrong, statuses };
    },
    /**
     * Calls every route of reading once for each parameter that has an example.
     * @returns what was not answered as described, with 200
     */
    callExamples: async () => {
      const wrong = [];
      let called = 0;
      for (const each of operations.filter(({ method }) => method === 'get')) {
        for (const { name, in: place, required, example } of each.parameters) {
          if (place !== 'query' || required || example === undefined) continue;
          const given = [...neededBy(each).filter((needed) => needed !== INSTEAD[name]), name];
          if (WITH[name]) given.push(WITH[name]);
          const done = await call(each, given, {});
          ++called;
          if (done.wrong) wrong.push(done.wrong);
          else if (done.status !== 200 && !each.route.includes('{campaign}') && done.status !== 409)
            wrong.push(`${each.route} with ${given.join(', ')}: ${done.status}`);
        }
      }
      return { wrong, called };
    },
  };
}
