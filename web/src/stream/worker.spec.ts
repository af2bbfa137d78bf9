// SPDX-License-Identifier: Apache-2.0
import { create, toBinary } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { RunStateSchema, RunState_State } from '../gen/aeolis/v1/run_pb';
import { ServerMessageSchema } from '../gen/aeolis/v1/stream_pb';
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
  close() {} // as over a dead connection: no close event
  opens() {
    this.readyState = 1;
    this.onopen();
  }
  welcome(state: keyof typeof RunState_State) {
    this.says({ case: 'welcome', value: { runState: aRun(state) } });
  }
  says(message: MessageInitShape<typeof ServerMessageSchema>['message']) {
    this.onmessage({ data: toBinary(ServerMessageSchema, create(ServerMessageSchema, { message })).slice().buffer });
  }
}
const aRun = (state: keyof typeof RunState_State, venue = 'rehearsal') =>
  create(RunStateSchema, { run: 1n, state: RunState_State[state], venue });
const states = () => said.flatMap((message) => (message.type === 'stream' ? [message.state] : []));
const passes = (seconds: number) => vi.advanceTimersByTimeAsync(seconds * 1000);
let healthz: () => Promise<unknown>;

beforeEach(async () => {
  vi.useFakeTimers();
  vi.resetModules();
  [said.length, sockets.length] = [0, 0];
  const page = {
    location: { origin: 'http://console' },
    postMessage: (message: FromWorker) => said.push(message),
    onmessage: (_event: { data: ToWorker }) => undefined,
  };
  vi.stubGlobal('self', page);
  vi.stubGlobal('WebSocket', FakeSocket);
  vi.stubGlobal(
    'fetch',
    vi.fn((path: string) => (path === '/healthz' ? healthz() : new Promise(() => undefined))),
  );
  await import('./worker');
  page.onmessage({ data: { type: 'open', run: 0, plotted: [], others: [] } });
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
it('of a server that answers takes the socket for dead where a rehearsal that goes on is silent for fifteen seconds; one that speaks stays', async () => {
  healthz = () => Promise.resolve({});
  sockets[0]?.opens();
  sockets[0]?.welcome('running');
  await passes(14);
  sockets[0]?.says({ case: 'runState', value: aRun('running') });
  await passes(14);
  expect(states()).not.toContain('lost');
  await passes(5);
  expect(states()).toContain('lost');
});
it('takes a socket for dead that does not open, or brings nothing of what was asked, for fifteen seconds', async () => {
  healthz = () => Promise.resolve({});
  await passes(20);
  expect(sockets.length).toBe(2);
  sockets[1]?.opens();
  await passes(20);
  expect([states().includes('catching_up'), sockets.length]).toEqual([true, 3]);
});
it('leaves the socket in peace where silence is in order, as long as the server answers: paused, over, of a real venue, its archive refusing', async () => {
  healthz = () => Promise.resolve({});
  sockets[0]?.opens();
  sockets[0]?.welcome('running');
  const before = sockets[0]?.sent;
  for (const silent of [
    aRun('paused'),
    aRun('finished'),
    aRun('running', 'downlink'),
    { ...aRun('running'), archiveFault: 'a.db: disk full' },
  ]) {
    sockets[0]?.says({ case: 'runState', value: silent });
    await passes(60);
  }
  expect([states().at(-1), sockets[0]?.sent, sockets.length]).toEqual(['live', before, 1]);
});

it('takes samples up where their subscription is welcomed: what comes before lacks them, and history is asked for only then', async () => {
  const batch = (afterSeq: bigint, completeThrough: bigint) =>
    sockets[0]?.says({
      case: 'batch',
      value: { run: 1n, afterSeq, completeThrough, items: [{ seq: completeThrough }] },
    });
  const history = () => vi.mocked(fetch).mock.calls.filter(([path]) => String(path).includes('/channels')).length;
  const through = () =>
    said.flatMap((message) => (message.type === 'batch' ? [message.batch.completeThrough] : [])).at(-1);
  vi.resetModules(); // a new worker, with a plotted channel
  await import('./worker');
  (self as unknown as { onmessage: (event: { data: ToWorker }) => void }).onmessage({
    data: { type: 'open', run: 0, plotted: ['altitude_m'], others: [] },
  });
  const socket = sockets.at(-1);
  sockets[0] = socket as FakeSocket;
  socket?.opens();
  socket?.says({ case: 'welcome', value: { runState: aRun('running'), lastSeq: 2n } });
  batch(0n, 2n); // all facts have arrived: samples are subscribed
  expect([socket?.sent, history()]).toEqual([2, 0]);
  batch(2n, 5n); // still from the subscription without samples
  await passes(1);
  expect([history(), through()]).toEqual([0, 2]);
  socket?.says({ case: 'welcome', value: { runState: aRun('running'), lastSeq: 5n } });
  expect(history()).toBe(1);
  batch(2n, 5n); // with samples
  await passes(1);
  expect(through()).toBe(5);
  expect(socket?.sent, 'nothing was missing').toBe(2);

  // The last before a silence may be among those left out: the archive is asked once it is quiet, and once.
  for (const through of [6n, 7n, 8n]) {
    socket?.says({
      case: 'batch',
      value: { run: 1n, afterSeq: through - 1n, completeThrough: through, leftOut: 1n, items: [] },
    });
    await passes(1);
    socket?.says({ case: 'batch', value: { run: 1n, afterSeq: through, completeThrough: through, items: [] } });
    expect(history()).toBe(1);
  }
  await passes(3);
  expect(history()).toBe(2);
  await passes(10);
  expect(history()).toBe(2);
});

it('says that a run is followed live when the page has been given all that came before, and not earlier', () => {
  sockets[0]?.opens();
  sockets[0]?.says({ case: 'welcome', value: { runState: aRun('running'), lastSeq: 2n } });
  expect(states().at(-1)).toBe('catching_up');
  sockets[0]?.says({
    case: 'batch',
    value: { run: 1n, afterSeq: 0n, completeThrough: 2n, items: [{ seq: 2n }] },
  });
  expect(said.slice(-2).map(({ type }) => type)).toEqual(['batch', 'stream']);
  expect(states().at(-1)).toBe('live');
});

it('fetches the history of a channel that is plotted from now on, of live samples too where a past as heard is shown', () => {
  const tell = (data: ToWorker) =>
    (self as unknown as { onmessage: (event: { data: ToWorker }) => void }).onmessage({ data });
  const asked = () =>
    vi.mocked(fetch).mock.calls.flatMap(([path]) => /\/runs\/1\/channels\?(\S+)/.exec(String(path))?.[1] ?? []);
  sockets[0]?.opens();
  sockets[0]?.welcome('running');
  tell({ type: 'plot', plotted: ['mach'], others: [], live: false });
  expect(asked()).toEqual(['names=mach&points=6000&format=protobuf']);
  tell({ type: 'plot', plotted: ['mach', 'bank_deg'], others: [], live: true });
  expect(asked().slice(1)).toEqual([
    'names=bank_deg&points=6000&format=protobuf',
    'names=bank_deg&points=6000&format=protobuf&source=realtime',
  ]);
});
