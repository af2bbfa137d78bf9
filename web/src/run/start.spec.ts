// SPDX-License-Identifier: Apache-2.0
import { create, fromJson, toJson } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { DictionaryReplySchema, RunListSchema, RunState_State } from '../gen/aeolis/v1/run_pb';
import { aServer } from '../testing/server';
import { namedRun } from '../stream/names';
import { askDictionary, askRuns } from './start';

const server = aServer();
const asServed = { useProtoFieldName: true, alwaysEmitImplicit: true };
/** The fields of a message that were sent, without the name of its type. */
const plain = (message: unknown): unknown =>
  JSON.parse(
    JSON.stringify(message, (name, value: unknown) =>
      name === '$typeName' ? undefined : typeof value === 'bigint' ? `${value}n` : value,
    ),
  );

describe('what the page must know first', () => {
  it('is read from JSON as the schema reads it', async () => {
    const words = toJson(
      DictionaryReplySchema,
      create(DictionaryReplySchema, {
        mission: 'M',
        id: 3,
        channels: [
          {
            id: 1,
            name: 'phase',
            expectedRateHz: 0.5,
            labels: [{ value: -9007199254740993n, label: 'value' }],
            limits: [{ severity: 'watch', above: 3 }],
            packet: 'P',
          },
        ],
        commands: [
          {
            opcode: 7,
            name: 'DO',
            reasonForWarning: 'it moves',
            arguments: [{ name: 'x', min: -1, defaultValue: 2.5, integer: true }],
            conditions: [{ channel: 1, comparison: '==', value: 4 }],
          },
        ],
        tones: [{ id: 1, name: 't' }],
      }),
      asServed,
    );
    const list = toJson(
      RunListSchema,
      create(RunListSchema, {
        runs: [
          { run: 1n, state: RunState_State.finished, seed: 18446744073709551615n, lastSeq: 5n, title: '12' },
          {
            run: 12n,
            state: RunState_State.running,
            clocks: { seenSclk: 2, ertUs: 5n },
            solution: [{ name: 'run', value: 7 }],
          },
        ],
      }),
      asServed,
    );
    server.routes['GET /dictionary'] = { json: words };
    server.routes['GET /runs'] = { json: list };
    expect(plain(await askDictionary())).toEqual(plain(fromJson(DictionaryReplySchema, words)));
    expect(plain(await askRuns())).toEqual(plain(fromJson(RunListSchema, list).runs.map(namedRun).reverse()));
  });
});
