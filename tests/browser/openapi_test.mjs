// SPDX-License-Identifier: Apache-2.0
// The served description is a valid OpenAPI document, and it is true of a finished run: each route and each example of
// a parameter is called, every answer must be one that is described, and its body must have no field that is not.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { documented } from './openapi.mjs';
import { landed, workplace } from './support.mjs';

const { serve } = workplace();

let flown;
/** One landing for all tests here. */
const aLanding = () => (flown ??= landed(serve));

test('series that are too long to be held are sent in parts, as those of each channel alone', async () => {
  const server = await aLanding();
  const names = ['altitude_m', 'speed_mps', 'horizontal_speed_mps', 'edl_phase'];
  const ask = async (of, format) => {
    const answer = await fetch(`${server.address}/api/v1/runs/latest/channels?names=${of.join(',')}&format=${format}`);
    assert.equal(answer.status, 200);
    return { parts: answer.headers.get('content-length') === null, octets: Buffer.from(await answer.arrayBuffer()) };
  };
  const alone = await Promise.all(names.map((name) => ask([name], 'json')));
  const list = await ask(names, 'json');
  assert.ok(list.parts, `${list.octets.length} octets were sent whole`);
  const channels = (one) => JSON.parse(one.octets.toString()).channels;
  assert.deepEqual(channels(list), alone.flatMap(channels));
  const count = channels(list).reduce((sum, { value }) => sum + value.length, 0);
  assert.equal((await ask(names, 'csv')).octets.toString().trimEnd().split('\n').length, count + 1);
  const protobuf = await Promise.all(names.map((name) => ask([name], 'protobuf')));
  assert.deepEqual((await ask(names, 'protobuf')).octets, Buffer.concat(protobuf.map(({ octets }) => octets)));
});

test('the OpenAPI document is valid, and every route and every example is answered as it says', async () => {
  const server = await aLanding();
  const { validate, callAll, callExamples } = await documented(server);
  const { valid, errors } = await validate();
  assert.ok(valid, JSON.stringify(errors, null, 1));
  const examples = await callExamples();
  assert.deepEqual(examples.wrong, []);
  assert.ok(examples.called > 60, String(examples.called));
  const { wrong, statuses } = await callAll();
  assert.deepEqual(wrong, []);
  assert.ok(statuses.size > 50, String(statuses.size));
});
