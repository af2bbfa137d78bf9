// SPDX-License-Identifier: Apache-2.0
import { fromBinary, toBinary } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { BatchSchema } from '../gen/aeolis/v1/stream_pb';
import { aBatch, event, samples } from '../testing/fixtures';
import { ColumnCollector } from './columns';
import { SequenceCheck, backoffSeconds } from './sequence';

describe('the stream', () => {
  it('makes one column of many samples, recording and real time apart', () => {
    const collector = new ColumnCollector();
    const octets = toBinary(
      BatchSchema,
      aBatch([samples(1, { 3: 10, 4: 20 }), samples(2, { 3: 11 }), samples(1, { 3: 10 }, 2)]),
    );
    collector.add(fromBinary(BatchSchema, octets));
    const taken = collector.take();
    expect(taken.columns.map((c) => [c.id, c.recorded, [...c.sclk], [...c.value]])).toEqual([
      [3, false, [1, 2], [10, 11]],
      [4, false, [1], [20]],
      [3, true, [1], [10]],
    ]);
    expect(collector.empty).toBe(true);
  });

  it('keeps undefined samples, exact texts, and which sample was received last', () => {
    const collector = new ColumnCollector();
    const ert = '2012-219T05:10:00.000';
    collector.add(
      aBatch([
        samples(5, { 3: NaN, 4: 2 ** 53 }, 1, { exact: [{ id: 4, text: '9007199254740993' }], ert }),
        samples(2, { 3: 7, 4: NaN }, 1, { ert, sclkByReception: true }),
      ]),
    );
    const [three, four] = collector.take().columns;
    expect(three).toMatchObject({ sclk: Float64Array.of(5, 2), value: Float64Array.of(NaN, 7) });
    expect(three?.texts).toBeUndefined();
    expect(three?.newest).toMatchObject({ sclk: 2, value: 7, byReception: true });
    expect(four?.texts).toEqual(['9007199254740993', undefined]);
    expect(four?.newest).toMatchObject({ sclk: 2, value: NaN, text: undefined });
  });

  it('keeps facts in order of their sequence number', () => {
    const collector = new ColumnCollector();
    collector.add(aBatch([event({ name: 'A' }), event({ name: 'B' })]));
    expect(collector.take().facts.map((fact) => fact.kind === 'event' && fact.fact.name)).toEqual(['A', 'B']);
  });

  it('finds a gap, and is not moved by it', () => {
    const check = new SequenceCheck();
    expect(check.judge(0, 10, 1)).toBe('continues');
    expect(check.judge(12, 20, 13)).toBe('gap');
    expect([check.gaps, check.completeThrough]).toEqual([1, 10]);
    expect(check.judge(10, 20, 11)).toBe('continues');
  });

  it('takes no batch twice', () => {
    const check = new SequenceCheck(20);
    expect(check.judge(10, 20, 11)).toBe('repeats');
    expect(check.judge(20, 20, undefined)).toBe('continues'); // clocks only
  });

  it('waits longer after each failure, and never more than five seconds', () => {
    expect([0, 1, 2, 3, 4, 5, 50].map(backoffSeconds)).toEqual([0.25, 0.5, 1, 2, 4, 5, 5]);
  });
});
