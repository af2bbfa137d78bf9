// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { fresh } from '../alarms/model';
import type { AlarmState } from '../alarms/model';
import { stream } from '../run/connection';
import { useForTest } from '../run/session';
import { lookAtPast, pastRange, store, tick } from '../run/shown';
import type { Item } from '../gen/aeolis/v1/items_pb';
import { ColumnCollector } from '../stream/columns';
import { aBatch, aDictionary, aStore, event, situation } from '../testing/fixtures';
import { alarmCall, aloud, listen, oneCall } from './calls';
import { chooseSound, nextSound, overPast, sound, toggleOverPast, whyNo } from './model';

const ERT = '2012-219T04:59:55.0';
const NEWS = { rank: 'news' as const, subject: 'computer', sentence: 'Flying on computer B since E−1:50' };
const an = (name: string, worst = 'warning'): AlarmState => ({
  name,
  kind: 'limit',
  state: 'unacknowledged',
  severity: worst,
  worst,
});

const spoken: string[] = [];
const toned: number[] = [];

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] });
  [spoken.length, toned.length] = [0, 0];
  vi.stubGlobal(
    'SpeechSynthesisUtterance',
    class {
      lang = '';
      constructor(readonly text: string) {}
    },
  );
  vi.stubGlobal('speechSynthesis', {
    speak: ({ text }: { text: string }) => spoken.push(text),
    cancel: () => undefined,
  });
  vi.stubGlobal(
    'AudioContext',
    class {
      currentTime = 0;
      destination = {};
      resume = async () => undefined;
      createGain = () => ({ gain: { value: 0 }, connect: () => undefined });
      createOscillator = () => ({
        frequency: {
          set value(hertz: number) {
            toned.push(hertz);
          },
        },
        connect: (to: unknown) => to ?? {},
        start: () => undefined,
        stop: () => undefined,
      });
    },
  );
  useForTest(aStore([situation(ERT, { rank: 'calm', sentence: 'All is well' })]), aDictionary);
  sound.value = 'words';
  listen();
  tick.value += 1;
});
afterEach(() => {
  vi.runAllTimers();
  [sound.value, overPast.value, pastRange.value, fresh.value] = ['off', false, undefined, []];
  vi.useRealTimers();
  vi.unstubAllGlobals();
  localStorage.clear();
});

function comes(...items: Item[]): void {
  const collector = new ColumnCollector();
  collector.add(aBatch(items));
  store.value?.add(collector.take());
  tick.value += 1;
  vi.advanceTimersByTime(1100);
}

describe('call-outs', () => {
  it('are the server’s own words: what is news, and the events that begin a phase, once each', () => {
    comes(situation(ERT, NEWS));
    expect(spoken).toEqual(['Flying on computer B since entry minus 1 50']);
    comes(situation(ERT, NEWS));
    expect(spoken).toHaveLength(1);
    comes(
      event({ name: 'PARACHUTE_DEPLOY', text: 'The parachute is deployed', sclk: 895 }),
      event({ name: 'SOMETHING_ELSE', text: 'x', sclk: 896 }),
    );
    expect(spoken.at(-1)).toBe('The parachute is deployed');
  });
  it('of a burst are one call, the worst first', () => {
    fresh.value = [an('a_m'), an('b_m', 'critical'), an('c_m')];
    comes(situation(ERT, NEWS));
    expect(spoken).toEqual(['3 alarms, the worst: b m, critical. Flying on computer B since entry minus 1 50']);
    expect(alarmCall([an('a_m')])).toEqual({ kind: 'caution', words: 'Alarm: a m, warning' });
    expect(alarmCall([])).toBeUndefined();
    const many = Array.from({ length: 9 }, (_, i) => ({ kind: 'news' as const, words: `${i}` }));
    expect(oneCall([...many, ...many])?.words).toBe('0. 1. 2. and 6 more');
  });
  it('are silent in a past, while what was missed still comes, and of what was there before; then nothing is made up for', () => {
    useForTest(aStore([situation(ERT, NEWS)]), aDictionary);
    tick.value += 1;
    vi.advanceTimersByTime(1100);
    lookAtPast({ from: -300, to: -200 }, false);
    comes(situation(ERT, { ...NEWS, sentence: 'Landed' }));
    pastRange.value = undefined;
    stream.value = { ...stream.value, state: 'catching_up' };
    comes(event({ name: 'TOUCHDOWN', text: 'Touchdown', sclk: 897 }));
    stream.value = { ...stream.value, state: 'live' };
    comes();
    expect(spoken).toEqual([]);
  });
  it('sound while a past is shown where that is chosen', () => {
    toggleOverPast();
    lookAtPast({ from: -300, to: -200 }, false);
    comes(situation(ERT, NEWS));
    expect(spoken).toHaveLength(1);
    expect(localStorage.getItem('aeolis-sound-past')).toBe('yes');
  });
  it('are tones instead, by their kind, and nothing when off', () => {
    sound.value = 'tones';
    fresh.value = [an('a', 'critical')];
    vi.advanceTimersByTime(1100);
    expect([toned, spoken]).toEqual([[880, 660, 880], []]);
    sound.value = 'off';
    comes(situation(ERT, NEWS));
    expect(toned).toHaveLength(3);
  });
});

describe('the choice', () => {
  it('is off at first, goes round by its key, stays over reloads, and says what the browser lacks', () => {
    sound.value = 'off';
    const round = [1, 2, 3].map(() => {
      nextSound();
      return [sound.value, localStorage.getItem('aeolis-sound')];
    });
    expect(round).toEqual([
      ['tones', 'tones'],
      ['words', 'words'],
      ['off', 'off'],
    ]);
    Reflect.deleteProperty(globalThis, 'SpeechSynthesisUtterance');
    expect(whyNo('words')).toBe('this browser does not speak');
    chooseSound('tones');
    nextSound();
    expect(sound.value).toBe('off');
  });
  it('is said as it is spoken', () => {
    expect(aloud('E+1:40 altitude_m')).toBe('entry plus 1 40 altitude m');
  });
});
