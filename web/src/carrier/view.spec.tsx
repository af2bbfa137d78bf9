// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { afterEach, describe, expect, it } from 'vitest';
import type { Palette } from '../draw/palette';
import { DictionaryReplySchema } from '../gen/aeolis/v1/run_pb';
import { Dictionary } from '../run/dictionary';
import { dictionary, store } from '../run/shown';
import { choice } from '../run/window';
import { aRun, aStore, event, samples, silent } from '../testing/fixtures';
import { featuresSeen } from '../timeline/model';
import { carrierWords, isKnown, residualLines } from './model';
import { draw } from './view';

const words = new Dictionary(
  create(DictionaryReplySchema, {
    channels: [
      {
        id: 1,
        name: 'carrier_lock',
        packet: 'StationCarrier',
        labels: ['locked', 'fluctuating', 'coasting', 'searching'].map((label, i) => ({ value: BigInt(i), label })),
      },
      ...['carrier_residual_hz', 'carrier_sigma_hz', 'carrier_rate_hz_s', 'carrier_cn0_dbhz'].map((name, i) => ({
        id: 2 + i,
        name,
      })),
    ],
  }),
);
/** An estimate; not found: undefined values, as the dictionary has them. */
const estimate = (sclk: number, hz = NaN, lock = Number.isNaN(hz) ? 2 : 0) =>
  samples(sclk, { 1: lock, 2: hz, 3: hz * 0 + 0.07, 4: hz * 0 - 0.4, 5: hz * 0 + 22.1 });
const eighths = (from: number, count: number, hz: number) =>
  Array.from({ length: count }, (_, i) => estimate(from + i / 8, hz));

afterEach(() => {
  [store.value, dictionary.value, choice.value] = [undefined, undefined, 'landing'];
});

describe('the carrier', () => {
  it('is told with its deviation while it is found, and as old or lost when it is', () => {
    expect(carrierWords(aStore(), words, Infinity, false)).toBe('no carrier was followed yet');
    const found = aStore([estimate(899, -12.345)]);
    expect(carrierWords(found, words, Infinity, false)).toBe(
      'locked · −12.35 Hz from the predict (deviation 0.07 Hz) · −0.4 Hz/s · C/N0 22.1 dB-Hz',
    );
    const old = aStore([estimate(890, 3), silent('StationCarrier')]);
    expect(carrierWords(old, words, Infinity, false)).toContain('last at E−1:50: locked · +3.00 Hz');
    expect(carrierWords(found, words, Infinity, true), 'without a connection').toContain('last at E−1:41: locked');
    expect(carrierWords(aStore([estimate(899, 3)], aRun({ state: 'finished' })), words, Infinity, false)).toContain(
      'last at',
    );
    const missed = aStore([estimate(898.875, 3), estimate(899)]);
    expect(carrierWords(missed, words, Infinity, false)).toBe('coasting, not found at E−1:41');
    const lost = aStore([estimate(890, 3), estimate(892, NaN, 3)]);
    expect(carrierWords(lost, words, Infinity, false)).toBe('lost since E−1:48');
    expect(carrierWords(lost, words, 890.5, false)).toContain('locked · +3.00 Hz');
  });
  it('is drawn through estimates alone: not over a gap, and not where it was not found', () => {
    const store = aStore([...eighths(800, 8, 1), estimate(801), ...eighths(801.125, 8, 2), ...eighths(820, 8, 3)]);
    expect(residualLines(store, words, -200, 0, Infinity).map((line) => [line.length, line[0]?.hz])).toEqual([
      [8, 1],
      [8, 2],
      [8, 3],
    ]);
    expect(residualLines(store, words, -200, 0, 801.5)).toHaveLength(2);
  });
  it('has shown features by the time that ground recognised them', () => {
    const seen = { name: 'SEEN_BY_DOPPLER', text: 'parachute seen by Doppler' };
    const store = aStore([
      event({ sclk: 850, ...seen, ert: '2012-219T04:59:12.0' }),
      event({ sclk: 851, name: 'PARACHUTE_DEPLOY', ert: '2012-219T04:59:12.0' }),
    ]);
    expect(featuresSeen(store, Infinity)).toEqual([
      { e_s: -150, told_e_s: expect.closeTo(-148), text: 'parachute seen by Doppler' },
    ]);
    expect(featuresSeen(store, 851)).toEqual([]); // recognised two seconds after it was seen
    expect(featuresSeen(store, 853)).toHaveLength(1);
  });
  it('is not shown where the dictionary has none, and its picture draws what is known', () => {
    expect([isKnown(words), isKnown(new Dictionary(create(DictionaryReplySchema))), isKnown(undefined)]).toEqual([
      true,
      false,
      false,
    ]);
    const drawn: string[] = [];
    const texts: string[] = [];
    const context = {
      ...Object.fromEntries(['save', 'restore', 'beginPath', 'stroke', 'rect', 'clip'].map((each) => [each, () => 0])),
      moveTo: () => drawn.push('move'),
      lineTo: () => drawn.push('line'),
      fillText: (text: string) => texts.push(text),
      fillRect: () => drawn.push('mark'),
    };
    store.value = aStore([
      ...eighths(880, 16, 40),
      event({ sclk: 881, name: 'SEEN_BY_DOPPLER', text: 'parachute', ert: '2012-219T04:59:42.0' }),
    ]);
    dictionary.value = words;
    choice.value = { from: -130, to: -100 };
    draw({ context: context as unknown as CanvasRenderingContext2D, width: 600, height: 140, colours: {} as Palette });
    expect(drawn.filter((each) => each === 'mark')).toHaveLength(1);
    expect(drawn.slice(drawn.indexOf('mark')).filter((each) => each === 'line')).toHaveLength(16);
    expect(texts).toEqual(expect.arrayContaining(['0', '40', 'E−2:00']));
  });
});
