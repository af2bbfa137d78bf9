// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { afterEach, describe, expect, it, vi } from 'vitest';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { DictionaryChannelSchema } from '../gen/aeolis/v1/run_pb';
import { useForTest } from '../run/session';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import {
  differenceOf,
  isPredicted,
  predictForTest,
  predictedAt,
  predictedEvent,
  predictedSeries,
  prediction,
  refreshPrediction,
  windowWords,
  windowsOf,
} from './model';

const { ask } = vi.hoisted(() => ({ ask: vi.fn() }));
vi.mock('../run/connection', async (real) => ({ ...(await real<object>()), ask }));

const altitude = aDictionary.pick(['altitude_m']);
const phase = aDictionary.pick(['edl_phase']);
if (!altitude || !phase) throw new Error('no channels');
const bank = create(DictionaryChannelSchema, { id: 9, name: 'bank_deg', unit: 'deg' });
const ready = (fields = {}) => create(PredictionSchema, { state: 'ready', ...fields });

afterEach(() => ask.mockReset());

describe('the prediction', () => {
  it('is asked for until the server has flown it, and no longer; a run without one says why', async () => {
    useForTest(aStore(), aDictionary);
    ask.mockResolvedValueOnce(create(PredictionSchema, { state: 'flying' }));
    await refreshPrediction();
    expect([prediction.value, isPredicted()]).toEqual([undefined, false]);
    ask.mockRejectedValueOnce(new Error('not connected'));
    await refreshPrediction();
    ask.mockResolvedValueOnce(ready());
    await refreshPrediction();
    await refreshPrediction();
    expect([ask.mock.calls.length, isPredicted()]).toEqual([3, true]);
    expect(ask).toHaveBeenLastCalledWith('prediction', '/runs/1/prediction');
    useForTest(aStore([], aRun({ run: 2n })), aDictionary);
    expect(prediction.value, 'that of another run').toBeUndefined();
    ask.mockResolvedValueOnce(create(PredictionSchema, { state: 'none', reason: 'run 2 has no scenario' }));
    await refreshPrediction();
    await refreshPrediction();
    expect([ask.mock.calls.length, isPredicted(), predictedSeries(altitude)]).toEqual([4, false, undefined]);
  });

  it('has the channels that are drawn, all of a picture in one question, and asks again after a failure', async () => {
    useForTest(aStore([], aRun({ run: 3n })), aDictionary);
    prediction.value = ready();
    ask.mockRejectedValueOnce(new Error('not connected'));
    expect([predictedSeries(altitude), predictedSeries(phase)]).toEqual([undefined, undefined]);
    await vi.waitFor(() => expect(ask).toHaveBeenCalledTimes(1));
    expect(ask).toHaveBeenCalledWith('series', '/runs/3/prediction?channels=altitude_m,edl_phase&format=protobuf');
    await Promise.resolve();
    const columns = [{ id: 3, recorded: false, sclk: Float64Array.of(1000), value: Float64Array.of(5) }];
    ask.mockResolvedValueOnce([{ columns }]);
    await vi.waitFor(() => expect(predictedSeries(altitude)?.at(1000)?.value).toBe(5));
    expect(ask).toHaveBeenCalledTimes(2);
  });

  it('lies on the line between two samples; a label holds; nothing is in a gap, before and after the flight', () => {
    useForTest(aStore(), aDictionary);
    predictForTest(ready(), {
      3: [
        [0, 100],
        [1, 110],
        [2, 120],
        [9, 190],
      ],
      1: [
        [0, 4],
        [5, 9],
      ],
    });
    const at = (channel: typeof altitude, e_s: number) => predictedAt(channel, predictedSeries(channel), 1000 + e_s, 6);
    expect([-0.1, 0, 0.5, 2, 5, 9, 9.1].map((e_s) => at(altitude, e_s))).toEqual([
      undefined,
      100,
      105,
      120,
      undefined,
      190,
      undefined,
    ]);
    expect([0, 4.9, 5].map((e_s) => at(phase, e_s))).toEqual([4, 4, 9]);
  });

  it('goes round with angles, between samples and in differences', () => {
    useForTest(aStore(), aDictionary);
    predictForTest(ready(), {
      9: [
        [0, 170],
        [1, -170],
      ],
    });
    expect(predictedAt(bank, predictedSeries(bank), 1000.5, 6)).toBe(180);
    expect([differenceOf(bank, -179, 179), differenceOf(bank, 30, 10), differenceOf(altitude, -200, 200)]).toEqual([
      2, 20, -400,
    ]);
  });

  it('has events by name, and windows by kind and link with words for their times', () => {
    useForTest(aStore(), aDictionary);
    predictForTest(
      ready({
        events: [{ name: 'touchdown', eS: 431.5 }],
        windows: [
          { kind: 'silence', link: 'uhf_live', words: 'plasma blackout', fromES: 45, toES: 98 },
          { kind: 'silence', link: 'uhf_live', words: 'antenna hand-over', fromES: 256, toES: 256 },
          { kind: 'silence', link: 'x_band', words: 'Earth set', fromES: 297 },
          { kind: 'pass', link: 'uhf_live', words: 'odyssey', fromES: -1200, toES: 640 },
        ],
      }),
    );
    expect([predictedEvent('touchdown'), predictedEvent('sufr'), predictedEvent(undefined)]).toEqual([
      431.5,
      undefined,
      undefined,
    ]);
    expect(windowsOf('silence', 'uhf_live').map((each) => windowWords(each)[0])).toEqual([
      '◇ plasma blackout E+0:45 to E+1:38',
      '◇ antenna hand-over E+4:16',
    ]);
    expect(windowsOf('silence', 'x_band').map((each) => windowWords(each)[0])).toEqual(['◇ Earth set from E+4:57']);
    expect(windowsOf('pass', 'uhf_live').map(({ words }) => words)).toEqual(['odyssey']);
  });
});
