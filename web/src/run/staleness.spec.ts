// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { aRun, aStore, samples } from '../testing/fixtures';
import { store } from './shown';
import { recordedStaleness, refreshStaleness, wasStale } from './staleness';

const recorded = (sclk: number) => [{ id: 3, sclk: Float64Array.of(sclk), value: Float64Array.of(2), recorded: true }];

describe('what was stale by the recording', () => {
  let asked: string[];
  let reply: () => Response;
  beforeEach(() => {
    vi.useFakeTimers({ toFake: ['performance'] });
    asked = [];
    reply = () =>
      Response.json({ packets: [{ packet: 'Navigation', stretches: [{ from_sclk: 800 + asked.length }] }] });
    vi.stubGlobal('fetch', (url: string) => {
      asked.push(url);
      return Promise.resolve(reply());
    });
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.useRealTimers();
    store.value = undefined;
  });

  it('is asked for once something recorded has come, and after the last of it, whatever size was told', async () => {
    store.value = aStore([samples(800, { 3: 1 })], aRun({ run: 5n, relayProgress: 0 }));
    await refreshStaleness();
    expect(asked).toEqual([]);
    store.value.addHistory(recorded(790));
    await refreshStaleness();
    await refreshStaleness();
    expect([asked, wasStale('Navigation', 900, 790)]).toEqual([['/api/v1/runs/5/staleness'], true]);
    store.value.completeThrough += 1;
    await refreshStaleness();
    expect(asked).toHaveLength(1); // no sooner than after five seconds
    vi.advanceTimersByTime(5000);
    await refreshStaleness();
    vi.advanceTimersByTime(5000);
    await refreshStaleness();
    expect([asked.length, recordedStaleness.value?.packets[0]?.stretches[0]?.from_sclk]).toEqual([2, 802]);
  });
  it('is asked for again after a failure, but not of a run of another dictionary', async () => {
    store.value = aStore([samples(800, { 3: 1 })], aRun({ run: 6n }));
    store.value.addHistory(recorded(790));
    reply = () => Response.json({ detail: 'busy' }, { status: 503 });
    await refreshStaleness();
    await refreshStaleness();
    expect([asked.length, wasStale('Navigation', 790, 790)]).toEqual([2, true]);
    reply = () => Response.json({ detail: 'another dictionary' }, { status: 400 });
    await refreshStaleness();
    await refreshStaleness();
    expect(asked).toHaveLength(3);
  });
});
