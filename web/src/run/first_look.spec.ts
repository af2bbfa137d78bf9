// SPDX-License-Identifier: Apache-2.0
import { create, toBinary } from '@bufbuild/protobuf';
import { describe, expect, it, vi } from 'vitest';
import { ChannelSeriesListSchema } from '../gen/aeolis/v1/run_pb';
import type { NamedRun } from '../stream/names';
import { aServer } from '../testing/server';
import { askFirst, firstAnswers, firstLook } from './first_look';

const server = aServer();
const octets = toBinary(
  ChannelSeriesListSchema,
  create(ChannelSeriesListSchema, { channels: [{ id: 3, sclk: [1, 2], value: [5, NaN], source: [1, 2] }] }),
);
const runs = (...of: [number, string][]) => of.map(([run, state]) => ({ run: BigInt(run), state }) as NamedRun);
const asking = (run: number, names: string) => `GET /runs/${run}/channels?names=${names}&points=1000&format=protobuf`;

describe('the first look', () => {
  it('is at the run that goes on, else the newest, and keeps live and recorded apart', async () => {
    server.routes[asking(8, 'a,b')] = { octets };
    expect(await firstLook(runs([9, 'finished'], [8, 'running']), 0, ['a', 'b'])).toEqual({
      run: 8,
      columns: [
        { id: 3, sclk: Float64Array.of(1), value: Float64Array.of(5), recorded: false },
        { id: 3, sclk: Float64Array.of(2), value: Float64Array.of(NaN), recorded: true },
      ],
    });
    const over = runs([9, 'finished'], [7, 'finished']);
    server.routes[asking(9, 'a')] = { octets: new Uint8Array() };
    expect(await firstLook(over, 0, ['a'])).toEqual({ run: 9, columns: [] });
    server.routes[asking(7, 'a')] = { octets: new Uint8Array() };
    expect(await firstLook(over, 7, ['a'])).toEqual({ run: 7, columns: [] });
  });
  it('that is refused, unknown or empty is none', async () => {
    expect(await firstLook(runs([9, 'running']), 0, ['a'])).toBeUndefined();
    server.routes[asking(9, 'a')] = { octets: Uint8Array.of(0xff) };
    expect(await firstLook(runs([9, 'running']), 0, ['a'])).toBeUndefined();
    expect(await firstLook([], 0, ['a'])).toBeUndefined();
  });
  it('is asked for once before all else, and anew when it must be asked for again', async () => {
    server.routes['GET /runs'] = { json: { runs: [{ run: '8', state: 'running' }] } };
    askFirst();
    const { runs: known } = firstAnswers();
    expect(await known).toMatchObject([{ run: 8n }]);
    await vi.waitFor(() =>
      expect(server.asked.map(({ path }) => path.split('?')[0])).toEqual(['/runs', '/runs/8/channels']),
    );
    server.routes['GET /runs'] = { status: 401, json: { error: 'log in' } };
    const again = firstAnswers();
    await expect(again.runs).rejects.toThrow('log in');
    expect(await again.look).toBeUndefined();
  });
});
