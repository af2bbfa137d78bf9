// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h, render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import type { ToWorker } from '../stream/messages';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { reportOfRun } from './report';
import { onMessage, useForTest } from './session';
import { store } from './shown';

const asked: Extract<ToWorker, { type: 'ask' }>[] = [];
const passes = (ms: number) => act(async () => void (await vi.advanceTimersByTimeAsync(ms)));
const answer = async (
  of: { ask: number },
  what: { ok: true; value: unknown } | { ok: false; status: number; error: string },
) => {
  onMessage({ type: 'answer', ask: of.ask, ...what } as never);
  await passes(0);
};
beforeEach(() => {
  vi.useFakeTimers();
  asked.length = 0;
  useForTest(aStore(), aDictionary, (said) => said.type === 'ask' && void asked.push(said));
});
afterEach(() => void vi.useRealTimers());

it('a report of a run that is over is asked for until it has come, once, and of another run at once', async () => {
  const numbers = reportOfRun<number>('proof', 'proof', 1000);
  const place = document.createElement('div');
  const View = () => h('p', null, numbers.use() ?? numbers.problem.value ?? 'asking');
  await act(() => render(h(View, null), place));
  await passes(5000);
  expect([asked.length, place.innerText]).toEqual([1, 'asking']); // no second request beside the first
  await answer(asked[0]!, { ok: false, status: 503, error: 'the archive is busy' });
  expect(place.innerText).toBe('the archive is busy');
  await passes(1000);
  expect(asked).toHaveLength(2);
  const one = store.value;
  await act(() => {
    store.value = aStore([], aRun({ run: 2n }));
  });
  await answer(asked[1]!, { ok: true, value: 1 }); // the answer about the earlier run
  expect([store.value === one, asked.map((each) => each.path), place.innerText]).toEqual([
    false,
    ['/runs/1/proof', '/runs/1/proof', '/runs/2/proof'],
    'asking',
  ]);
  await answer(asked[2]!, { ok: true, value: 2 });
  await passes(5000);
  expect([asked.length, place.innerText]).toEqual([3, '2']);
  render(null, place);
});
