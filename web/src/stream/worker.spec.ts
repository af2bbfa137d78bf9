import { create, toBinary } from '@bufbuild/protobuf';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { RunStateSchema } from '../gen/worker/aeolis/v1/run_pb';
import { ServerMessageSchema } from '../gen/worker/aeolis/v1/stream_pb';
import type { FromWorker, ToWorker } from './messages';

const said: FromWorker[] = [];
const sockets: FakeSocket[] = [];
class FakeSocket {
  static OPEN = 1;
  readyState = 0;
  sent = 0;
  onopen = () => undefined;
  onmessage = (_event: { data: ArrayBuffer }) => undefined;
  constructor() {
    sockets.push(this);
  }
  send() {
    ++this.sent;
  }
  close() {} // as over a way that is dead: no goodbye comes
  opens() {
    this.readyState = 1;
    this.onopen();
  }
  welcome(state: string) {
    const runState = create(RunStateSchema, { run: 1n, state });
    this.onmessage({ data: toBinary(ServerMessageSchema, create(ServerMessageSchema, { message: { case: 'welcome', value: { runState } } })).slice().buffer });
  }
}
const states = () => said.flatMap((message) => (message.type === 'stream' ? [message.state] : []));
const passes = (seconds: number) => vi.advanceTimersByTimeAsync(seconds * 1000);
let healthz: () => Promise<unknown>;

beforeEach(async () => {
  vi.useFakeTimers();
  vi.resetModules();
  [said.length, sockets.length] = [0, 0];
  const page = { location: { origin: 'http://console' }, postMessage: (message: FromWorker) => said.push(message), onmessage: (_event: { data: ToWorker }) => undefined };
  vi.stubGlobal('self', page);
  vi.stubGlobal('WebSocket', FakeSocket);
  vi.stubGlobal('fetch', vi.fn((path: string) => (path === '/healthz' ? healthz() : new Promise(() => undefined))));
  await import('./worker');
  page.onmessage({ data: { type: 'open', run: 0, packets: {}, plotted: [], others: [] } });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

it('after five seconds of silence asks whether the server is there, and goes the way of a loss when no answer comes', async () => {
  healthz = () => Promise.reject(new Error('timeout'));
  sockets[0]?.opens();
  sockets[0]?.welcome('running');
  await passes(4);
  expect([vi.mocked(fetch).mock.calls, states().at(-1)]).toEqual([[], 'live']);
  await passes(2);
  expect(states().at(-1)).toBe('lost');
  await passes(1);
  expect(sockets.length, 'another is tried').toBeGreaterThan(1);
  sockets[0]?.welcome('running');
  expect(states().at(-1), 'the dead one is not listened to').toBe('lost');
});
it('of a server that answers asks the socket, too, and takes that for dead when it says nothing to it; one that speaks stays', async () => {
  healthz = () => Promise.resolve({});
  sockets[0]?.opens();
  sockets[0]?.welcome('paused');
  const before = sockets[0]?.sent as number;
  await passes(12);
  expect([states().at(-1), (sockets[0]?.sent as number) - before]).toEqual(['live', 2]);
  sockets[0]?.welcome('paused');
  await passes(14);
  expect(states().at(-1)).toBe('live');
  await passes(4);
  expect(states()).toContain('lost');
});
it('leaves the socket of a run that is over in peace, as long as the server answers', async () => {
  healthz = () => Promise.resolve({});
  sockets[0]?.opens();
  sockets[0]?.welcome('finished');
  const before = sockets[0]?.sent;
  await passes(60);
  expect([states().at(-1), sockets[0]?.sent, sockets.length]).toEqual(['live', before, 1]);
});
