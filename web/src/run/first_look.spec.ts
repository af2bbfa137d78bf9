import { describe, expect, it } from 'vitest';
import { aServer } from '../testing/server';
import { firstLook } from './first_look';

const server = aServer();
const series = { channels: [{ id: 3, sclk: [1, 2], value: [5, 'NaN'], source: ['SOURCE_REALTIME', 'SOURCE_RECORDED'] }] };

describe('the first look', () => {
  it('is at the run that goes on, else the newest, and keeps live and recorded apart', async () => {
    server.routes['GET /runs'] = { json: { runs: [{ run: '9', state: 'finished' }, { run: '8', state: 'running' }] } };
    server.routes['GET /runs/8/channels?names=a,b&points=500'] = { json: series };
    expect(await firstLook(0, ['a', 'b'])).toEqual({ run: 8, columns: [
      { id: 3, sclk: Float64Array.of(1), value: Float64Array.of(5), recorded: false }, { id: 3, sclk: Float64Array.of(2), value: Float64Array.of(NaN), recorded: true }] });
    server.routes['GET /runs'] = { json: { runs: [{ run: '7', state: 'finished' }, { run: '9', state: 'finished' }] } };
    server.routes['GET /runs/9/channels?names=a&points=500'] = { json: {} };
    expect(await firstLook(0, ['a'])).toEqual({ run: 9, columns: [] });
    server.routes['GET /runs/7/channels?names=a&points=500'] = { json: {} };
    expect(await firstLook(7, ['a'])).toEqual({ run: 7, columns: [] });
  });
  it('that is refused, unknown or empty is none', async () => {
    expect(await firstLook(0, ['a'])).toBeUndefined();
    server.routes['GET /runs'] = { status: 401, json: { error: 'log in' } };
    expect(await firstLook(0, ['a'])).toBeUndefined();
    server.routes['GET /runs'] = { json: {} };
    expect(await firstLook(0, ['a'])).toBeUndefined();
  });
});
