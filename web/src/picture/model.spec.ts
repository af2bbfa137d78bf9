// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { CHOICES, TABS, full, low, middle, showAt, showView, tab } from '../places/model';
import { pictureOf, queryOf } from '../run/address';
import type { Picture } from '../run/address';
import { cursor } from '../run/cursor';
import { useForTest } from '../run/session';
import { asked, lookAtPast, notices, pastRange, plots, replay, withRecording } from '../run/shown';
import { choice, look } from '../run/window';
import { aDictionary, aStore } from '../testing/fixtures';
import { keepAddress, linkNow, openPicture, pictureNow, timesMissing } from './model';

// The fixtures' run begins at E−1000 and is seen to E−100.
const settled = () => vi.waitFor(() => new Promise((resolve) => setTimeout(resolve, 0)));

function comesFresh(): void {
  [pastRange.value, replay.value, withRecording.value] = [undefined, undefined, false];
  [cursor.value, choice.value, notices.value, asked.value] = [undefined, 'landing', [], 0];
  showView({});
  useForTest(undefined, undefined);
}

async function opens(link: string): Promise<string[]> {
  comesFresh();
  openPicture(pictureOf(link.replace(/^[^?]*/, '')));
  useForTest(aStore(), aDictionary);
  await settled();
  await settled();
  return notices.value.map(({ text }) => text);
}

beforeEach(comesFresh);

function seeded(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

describe('a link', () => {
  it('opens the picture that it was copied from: run, instant, panels, channels, whatever they are', async () => {
    const random = seeded(7);
    const pick = <T>(...all: readonly T[]): T => all[Math.floor(random() * all.length)] as T;
    const time = () => -100 - Math.round(random() * 8000) / 10;
    for (let i = 0; i < 60; ++i) {
      comesFresh();
      useForTest(aStore(), aDictionary);
      showAt('data', pick(...TABS).id);
      showAt('middle', pick(...CHOICES));
      showAt('low', pick(...CHOICES));
      full.value = pick(undefined, 'plots', 'events', 'data');
      plots.value = pick(undefined, [['altitude_m']], [['altitude_m', 'speed_mps'], ['edl_phase']]);
      const [a, b] = [time(), time()];
      const span = { from: Math.min(a, b) - 1, to: Math.max(a, b) };
      if (random() < 0.5) lookAtPast(span, random() < 0.5);
      if (random() < 0.5) look(span.from, span.to - 0.5);
      else if (!pastRange.value) choice.value = pick('landing', 'minute', 'run');
      cursor.value = pick(undefined, time());
      const [before, link] = [pictureNow(), linkNow()];
      expect(await opens(link), link).toEqual([]);
      expect(pictureNow(), link).toEqual(before);
      expect(linkNow()).toBe(link);
    }
  });
  it('with parts that cannot be shown says so, a line each, and opens the rest', async () => {
    expect(await opens('?data=nothing&middle=links&full=moon&channels=mach+altitude_m,none&at=x')).toEqual([
      'at=x in the address is no time in seconds from entry',
      'there is no panel nothing to show there',
      'there is no panel moon to show there',
      'no channel mach, none in the dictionary',
    ]);
    expect([tab.value, middle.value, full.value, plots.value]).toEqual([
      'channels',
      'links',
      undefined,
      [['altitude_m']],
    ]);
  });
  it('to instants that the run does not have says which it has, and shows it as it goes on', async () => {
    const known = 'run 1 is known from E−16:40 to E−1:40';
    expect(await opens('?run=1&past=10,20&at=-5000&data=links')).toEqual([
      `E+0:10 to E+0:20 is not shown: ${known}`,
      `E−1:23:20 is not shown: ${known}`,
    ]);
    expect([pastRange.value, cursor.value, tab.value]).toEqual([undefined, undefined, 'links']);
    const unknown = aStore();
    unknown.run.entrySclk = 0;
    expect(Object.values(timesMissing(unknown, { run: 1, cursor: 5 }))).toEqual([
      'E+0:05 is not shown: the time of entry of run 1 is not known',
    ]);
  });
  it('to a run that is not there shows no instant of another', async () => {
    await opens('?run=9&past=-200,-150');
    expect(pastRange.value).toBeUndefined();
  });
});

describe('the address', () => {
  it('follows what is shown, with the run where it was asked for or its past is shown, and without the cursor', async () => {
    const written = vi.spyOn(history, 'replaceState');
    const now = async () => {
      await vi.waitFor(() => expect(written).toHaveBeenCalled(), { timeout: 2000 });
      const [, , address] = written.mock.lastCall ?? [];
      written.mockClear();
      return String(address).replace(/^\//, '');
    };
    useForTest(aStore(), aDictionary);
    keepAddress();
    expect(await now()).toBe('');
    showAt('data', 'links');
    cursor.value = -200;
    expect(await now()).toBe('?data=links');
    lookAtPast({ from: -300, to: -200 }, true);
    expect(await now()).toBe('?run=1&past=-300,-200&with=recording&data=links');
    pastRange.value = undefined;
    expect(await now()).toBe('?data=links');
    asked.value = 1;
    expect(await now()).toBe('?run=1&data=links');
  });
  it('is that of a picture, so that a reload shows it again', () => {
    const picture: Picture = { run: 1, past: { from: -300, to: -200, recorded: true }, data: 'links' };
    expect(pictureOf(`?${queryOf(picture)}`).picture).toEqual(picture);
  });
});

describe('a place', () => {
  it('shows a panel once: where it was before is then the other one', () => {
    showAt('middle', 'tones');
    expect([middle.value, low.value, tab.value]).toEqual(['tones', 'descent', 'channels']);
    showAt('low', 'channels');
    expect([middle.value, low.value, tab.value]).toEqual(['tones', 'channels', 'vehicle']);
    showAt('data', 'channels');
    expect([middle.value, low.value, tab.value]).toEqual(['tones', 'vehicle', 'channels']);
    showAt('data', 'descent');
    expect(tab.value).toBe('channels');
  });
});
