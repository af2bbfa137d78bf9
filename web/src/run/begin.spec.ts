// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { expect, it, vi } from 'vitest';
import { aServer } from '../testing/server';
import { begin } from './session';

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
  expect(listening).not.toHaveBeenCalled(); // the cookie that comes with the answer is waited for
  await vi.advanceTimersByTimeAsync(1500);
  expect(listening).toHaveBeenCalledWith(expect.objectContaining({ type: 'open', run: 0 }));
  vi.useRealTimers();
});
