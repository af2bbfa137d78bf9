// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { refreshAlarms } from '../alarms/model';
import { choose, forward, line, message, step, tryOut, type } from '../commands/line';
import { CommandReplySchema } from '../gen/aeolis/v1/run_pb';
import type { NamedRun } from '../stream/names';
import type { CommandIntent, ToWorker } from '../stream/messages';
import { aDictionary, aRun, aStore, samples } from '../testing/fixtures';
import { ask, change, control, read, sendCommand } from './connection';
import { backToLive, onMessage, refreshRuns, useForTest } from './session';
import { dismissNotice, lookAtPast, notices, pastRange, runs, store, watched } from './shown';

const soon = () => vi.advanceTimersByTimeAsync(0);

describe('a server that does not answer', () => {
  let sent: { request: number; intent: CommandIntent }[];
  const answer = (
    request: number,
    fields: { accepted: boolean; command?: bigint; reason?: string; dryRun?: boolean },
  ) => onMessage({ type: 'reply', reply: create(CommandReplySchema, { request: BigInt(request), ...fields }) });
  beforeEach(() => {
    vi.useFakeTimers();
    sent = [];
    dismissNotice();
    useForTest(aStore(), aDictionary, (said: ToWorker) => said.type === 'command' && void sent.push(said));
    onMessage({ type: 'stream', state: 'live', attempt: 0, gaps: 0, serverVersion: '' });
  });
  afterEach(() => void vi.useRealTimers());
  /** Reviewed, accepted by the ground, and sent. */
  const send = async () => {
    type('no_op');
    choose('NO_OP');
    void tryOut();
    answer(sent.at(-1)!.request, { accepted: true, dryRun: true });
    await soon();
    void forward();
    await soon();
    const last = sent.at(-1)!;
    expect([last.intent.dryRun, step.value]).toEqual([undefined, 'sending']);
    return last.request;
  };
  it('leaves a command not known, sends nothing again whatever is pressed, and is put right by an answer that comes late', async () => {
    for (const [late, words] of [
      [{ accepted: true, command: 7n }, 'NO_OP: the answer has come late. It was taken as #7.'],
      [
        { accepted: false, reason: 'no pass' },
        'NO_OP: the answer has come late. It was refused: no pass; nothing was sent.',
      ],
    ] as const) {
      const request = await send();
      const before = sent.length;
      await vi.advanceTimersByTimeAsync(29_900);
      expect(step.value).toBe('sending');
      await vi.advanceTimersByTimeAsync(200);
      expect([message.value?.good, message.value?.text]).toEqual([
        false,
        'NO_OP: no answer came in 30 s: whether it was taken is not known; the history below will say',
      ]);
      void forward();
      void forward();
      await soon();
      expect([line.value, sent.length]).toEqual(['', before]);
      answer(request, late);
      expect(notices.value.at(-1)?.text).toBe(words);
      answer(request, late);
      expect(notices.value.filter((notice) => notice.text === words)).toHaveLength(1);
    }
  });
  it('to what is only tried out is not told of later', async () => {
    choose('NO_OP');
    void tryOut();
    await vi.advanceTimersByTimeAsync(31_000);
    answer(sent.at(-1)!.request, { accepted: true, dryRun: true });
    expect(notices.value).toEqual([]);
  });
});

describe('history', () => {
  const column = (recorded: boolean, ...sclk: number[]) => ({
    id: 3,
    recorded,
    sclk: Float64Array.from(sclk),
    value: Float64Array.from(sclk),
  });
  const answer = (live: boolean, ...columns: ReturnType<typeof column>[]) =>
    onMessage({ type: 'history', run: 1, names: ['altitude_m'], columns, live });
  const answers = {
    whole: () => answer(false, column(false, 800, 892), column(true, 850, 880, 891)),
    live: () => answer(true, column(false, 800, 860, 885, 890)),
  };
  it('of live samples alone stays as fine as it came, in whatever order the archive answers', () => {
    for (const order of [
      ['whole', 'live'],
      ['live', 'whole'],
      ['live', 'whole', 'live', 'whole'],
    ] as const) {
      useForTest(aStore([samples(892, { 3: 892 }), samples(893, { 3: 893 })]), aDictionary);
      for (const which of order) answers[which]();
      const [live, recorded] = [store.value?.live.get(3), store.value?.recorded.get(3)];
      expect([...(live?.sclk.subarray(0, live.length) ?? [])], order.join()).toEqual([800, 860, 885, 890, 892, 893]);
      expect(recorded?.length).toBe(3);
    }
  });
});

describe('a run', () => {
  const one = { started: '2026-01-01T10:00:00Z', seed: 1n };
  const state = (now: 'live' | 'catching_up' | 'lost') =>
    onMessage({ type: 'stream', state: now, attempt: 0, gaps: 0, serverVersion: '' });
  let heard: ToWorker[];
  beforeEach(() => {
    vi.spyOn(location, 'reload').mockImplementation(() => undefined);
    vi.stubGlobal(
      'fetch',
      vi.fn(async () => new Response('{}')),
    );
    sessionStorage.clear();
    dismissNotice();
    heard = [];
    useForTest(aStore([], aRun(one)), aDictionary, (message) => void (message.type !== 'ask' && heard.push(message)));
  });
  afterEach(() => {
    vi.restoreAllMocks();
    vi.unstubAllGlobals();
  });
  const posted = () => vi.mocked(fetch).mock.calls.filter(([, how]) => how?.method !== 'GET');
  const all = () =>
    Promise.allSettled(
      [sendCommand({ command: 'NO_OP' }), change('/runs/1/notes', { text: 'x' })].map((sent) =>
        sent.catch((error: Error) => Promise.reject(error.message)),
      ),
    );
  it('is another one though it has the number of the one that is shown, if it was started at another time or with another seed', async () => {
    const [shown, told] = [store.value, vi.mocked(location.reload)];
    onMessage({ type: 'run', run: aRun({ ...one, pace: 7 }), fresh: false });
    expect([told.mock.calls.length, store.value?.run.pace]).toEqual([0, 7]);
    const others: Partial<NamedRun>[] = [{ started: '2026-01-02T10:00:00Z' }, { seed: 2n }];
    for (const [i, other] of others.entries()) {
      state('live');
      onMessage({
        type: 'run',
        run: aRun({ ...one, ...other, scenario: 'tones_only', $typeName: undefined } as never),
        fresh: false,
      });
      expect([told.mock.calls.length, store.value === shown, shown?.run.scenario]).toEqual([i + 1, true, 'nominal']);
      expect(sessionStorage.getItem('aeolis-left')).toBe(
        'The server has another archive now: run 1, nominal, which was shown here, is not in it.',
      );
      control({ action: 'stop' });
      await all();
      expect([heard, posted()]).toEqual([[], []]);
    }
    state('live');
    onMessage({ type: 'other_archive' });
    expect(told).toHaveBeenCalledTimes(3);
  });
  it('is sent nothing while the server has not said that it still has it: no command, no pace, no end, no note', async () => {
    for (const [now, words] of [
      ['catching_up', 'catching up: nothing was sent'],
      ['lost', 'not connected: nothing was sent'],
    ] as const) {
      state(now);
      control({ action: 'pace', pace: 100 });
      control({ action: 'stop' });
      expect(await all()).toEqual([
        { status: 'rejected', reason: words },
        { status: 'rejected', reason: words },
      ]);
      expect([heard, posted(), notices.value.at(-1)?.text]).toEqual([[], [], words]);
    }
    state('live');
    control({ action: 'stop' });
    expect(heard).toHaveLength(1);
  });
  it('of it nothing is asked from when the connection broke until the server that came back has said that it has it', async () => {
    const asked: string[] = [];
    useForTest(
      aStore([], aRun(one)),
      aDictionary,
      (message) => void (message.type === 'ask' && asked.push(message.path)),
    );
    const askAll = async () => {
      asked.length = vi.mocked(fetch).mock.calls.length = 0;
      void ask('packets', '/runs/1/packets').catch(() => undefined);
      const answers = await Promise.allSettled([read('/runs/1/notes'), refreshAlarms()]);
      return [asked, vi.mocked(fetch).mock.calls.map(([path]) => path), answers[0].status];
    };
    const every = [['/runs/1/packets'], ['/api/v1/runs/1/notes', '/api/v1/runs/1/alarms?state=current'], 'fulfilled'];
    const none = [[], [], 'rejected'];
    expect(await askAll()).toEqual(every);
    for (const now of ['lost', 'catching_up', 'live'] as const) {
      state(now); // "live" alone may refer to the server's current run
      expect(await askAll(), now).toEqual(none);
    }
    onMessage({ type: 'run', run: aRun({ ...one, seed: 2n }), fresh: false });
    expect(await askAll(), 'another run of its number').toEqual(none);
    onMessage({ type: 'run', run: aRun(one), fresh: false });
    expect(await askAll(), 'the same').toEqual(every);
  });
  it('waits for no answer over a connection that is lost, so that what asks again can', async () => {
    vi.stubGlobal(
      'fetch',
      vi.fn(
        (_path: string, { signal }: RequestInit) =>
          new Promise((_, reject) => signal?.addEventListener('abort', () => reject(signal.reason as Error))),
      ),
    );
    state('live');
    const said = read('/runs/1/alarms').catch((error: Error) => error.message);
    state('lost');
    expect(await said).toBe('no answer came');
  });
  it('is left at once when the server that came back refuses it and has no such run', async () => {
    vi.stubGlobal(
      'fetch',
      vi.fn(async () => new Response(JSON.stringify({ runs: [] }))),
    );
    const left = vi.mocked(location.reload);
    for (const [now, times] of [
      ['live', 0],
      ['lost', 1],
    ] as const) {
      state(now);
      onMessage({ type: 'refusal', reason: 'no run 1' });
      await new Promise((resolve) => setTimeout(resolve));
      expect(
        [vi.mocked(fetch).mock.calls.filter(([path]) => path === '/api/v1/runs').length, left.mock.calls.length],
        now,
      ).toEqual([times, times]);
    }
  });
  it('that begins while the past of another is looked at is told once, and shown when who looks comes back', () => {
    state('live');
    watched.value = 0;
    const shown = store.value;
    lookAtPast({ from: -100, to: 0 }, true);
    const next = aRun({ run: 2n, started: '2026-01-01T12:00:00Z', seed: 2n });
    for (let i = 0; i < 2; ++i) onMessage({ type: 'run', run: next, fresh: true });
    const words = 'Run 2, nominal, has begun; Esc leaves the past of run 1 for it.';
    expect([store.value === shown, notices.value.map((notice) => notice.text), runs.value[0]?.run]).toEqual([
      true,
      [words],
      2n,
    ]);
    dismissNotice();
    onMessage({ type: 'run', run: next, fresh: false });
    expect(notices.value).toEqual([]);
    backToLive();
    expect([store.value, pastRange.value, heard.at(-1)]).toEqual([undefined, undefined, { type: 'watch', run: 0 }]);
  });
  it('that is over is not going again by an answer from before its end; one that was cut off may go on', async () => {
    for (const [held, polled, then] of [
      ['finished', 'running', 'finished'],
      ['interrupted', 'running', 'running'],
      ['interrupted', 'interrupted', 'interrupted'],
    ] as const) {
      useForTest(aStore([], aRun({ ...one, state: held })), aDictionary);
      runs.value = [];
      vi.stubGlobal(
        'fetch',
        vi.fn(
          async () =>
            new Response(
              JSON.stringify({ runs: [{ run: '1', started: one.started, seed: '1', state: polled, last_seq: '0' }] }),
            ),
        ),
      );
      await refreshRuns();
      expect([runs.value[0]?.state, store.value?.run.state]).toEqual([then, then]);
    }
  });
});
