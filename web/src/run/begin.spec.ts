// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { expect, it, vi } from 'vitest';
import { aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { begin, onMessage } from './session';
import { lookAtPast, store } from './shown';

const server = aServer();

it('a page begins to listen though the server does not say who it is', async () => {
  const listening = vi.fn();
  vi.stubGlobal(
    'Worker',
    class {
      postMessage = listening;
    },
  );
  vi.useFakeTimers();
  server.routes['GET /session'] = () => new Promise(() => undefined);
  server.routes['GET /dictionary'] = { json: { channels: [], commands: [], tones: [] } };
  server.routes['GET /runs'] = { json: { runs: [] } };
  void begin();
  await vi.advanceTimersByTimeAsync(4000);
  expect(listening).not.toHaveBeenCalled(); // the worker waits for the cookie that comes with the answer
  await vi.advanceTimersByTimeAsync(1500);
  expect(listening).toHaveBeenCalledWith(expect.objectContaining({ type: 'open', run: 0 }));

  // A past as heard asks for its live samples once, and again if the connection broke before all had arrived.
  const asked = () =>
    listening.mock.calls.filter(([message]) => message.type === 'refresh_history' && message.live).length;
  const connection = (state: 'live' | 'lost') =>
    onMessage({ type: 'stream', state, attempt: 0, gaps: 0, serverVersion: '' });
  store.value = aStore([], aRun({ state: 'finished' }));
  connection('live');
  lookAtPast({ from: -100, to: 0 }, false);
  connection('live');
  expect(asked()).toBe(1);
  connection('lost');
  connection('live');
  expect(asked()).toBe(2);
  vi.useRealTimers();
});
