// SPDX-License-Identifier: Apache-2.0
import { create, toBinary } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { ChannelSeriesListSchema } from '../gen/aeolis/v1/run_pb';
import { readSeriesList } from './series_answer';

const octetsOf = (channels: object[]) =>
  toBinary(ChannelSeriesListSchema, create(ChannelSeriesListSchema, { channels }));

describe('samples in Protobuf', () => {
  it('keep every bit, with their name, unit and count', () => {
    const sclk = [0.1, 397501174.984375, 1e300];
    const value = [NaN, -0, 5e-324];
    const [series] = readSeriesList(
      octetsOf([
        { id: 300, name: 'höhe', unit: 'm', samples: 5_000_000_000n, thinned: true, sclk, value, source: [1, 1, 1] },
      ]),
    );
    expect(series).toEqual({
      id: 300,
      name: 'höhe',
      unit: 'm',
      samples: 5_000_000_000,
      thinned: true,
      columns: [{ id: 300, recorded: false, sclk: Float64Array.from(sclk), value: Float64Array.from(value) }],
    });
  });
  it('come apart by real time and recording, each in its order', () => {
    const [series] = readSeriesList(octetsOf([{ id: 7, sclk: [1, 2, 3], value: [10, 20, 30], source: [1, 2, 1] }]));
    expect(series?.columns).toEqual([
      { id: 7, recorded: false, sclk: Float64Array.of(1, 3), value: Float64Array.of(10, 30) },
      { id: 7, recorded: true, sclk: Float64Array.of(2), value: Float64Array.of(20) },
    ]);
  });
  it('bring exact texts, undefined ones too, and the sample received last', () => {
    const newest = { sclk: 1, value: NaN, text: '', ertUs: 397_501_174_984_375n, sclkByReception: true };
    const text = [{ text: '9007199254740993' }, {}];
    const [series] = readSeriesList(octetsOf([{ id: 7, sclk: [1, 2], value: [1, NaN], source: [1, 1], text, newest }]));
    expect(series?.columns[0]?.texts).toEqual(['9007199254740993', undefined]);
    expect(series?.columns[0]?.newest).toEqual({
      sclk: 1,
      value: NaN,
      text: '',
      ert_s: 946728000 + 397501174.984375,
      byReception: true,
    });
  });
  it('of a prediction have no source, and are read by the same reader', () => {
    const answer = create(PredictionSchema, {
      state: 'ready',
      channels: [{ id: 7, name: 'x', sclk: [1, 2], value: [5, 6] }],
    });
    expect(readSeriesList(toBinary(PredictionSchema, answer))[0]).toMatchObject({
      name: 'x',
      columns: [{ id: 7, recorded: false, sclk: Float64Array.of(1, 2), value: Float64Array.of(5, 6) }],
    });
  });
  it('of a channel without any are no column, and of no channel no series', () => {
    expect(readSeriesList(octetsOf([{ name: 'quiet' }]))).toMatchObject([{ id: 0, name: 'quiet', columns: [] }]);
    expect(readSeriesList(new Uint8Array())).toEqual([]);
  });
  it('that are cut off anywhere, or are something else, are refused', () => {
    const whole = octetsOf([{ id: 1, name: 'a', sclk: [1, 2], value: [3, 4], source: [1, 1] }]);
    for (let length = 1; length < whole.length; ++length)
      expect(() => readSeriesList(whole.subarray(0, length)), String(length)).toThrow('samples');
    expect(() => readSeriesList(octetsOf([{ id: 1, sclk: [1, 2], value: [3] }]))).toThrow('2 times, 1 values');
    expect(() => readSeriesList(new TextEncoder().encode('{"error":"no"}'))).toThrow();
  });
});
