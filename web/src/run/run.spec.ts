// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ClockReplySchema } from '../gen/aeolis/v1/run_pb';
import { ENTRY_SCLK, aRun, aStore, ertUs, event, firing, samples, stage, tone } from '../testing/fixtures';
import { Series } from './series';
import type { RunStore } from './store';
import { dayOfYear, duration, fromEntry, readFromEntry, secondsOfDayOfYear, secondsOfErt } from './time';

const f = (...values: number[]) => Float64Array.from(values);
const sclks = (series: Series) => [...series.sclk.slice(0, series.length)];

describe('a series', () => {
  it('keeps late samples in their place and no sample twice', () => {
    const series = new Series();
    series.append(f(1, 2, 5), f(1, 2, 5));
    series.append(f(3, 3, 5, 6), f(3, 3, 5, 6));
    expect(sclks(series)).toEqual([1, 2, 3, 5, 6]);
  });
  it('keeps different samples of one instant, in the order of reception', () => {
    const series = new Series();
    series.append(f(1, 1, 1, 2), f(20, 21, 20, 22));
    expect([...series.value.slice(0, series.length)]).toEqual([20, 21, 22]);
    expect(series.at(1)).toEqual({ sclk: 1, value: 21 });
  });
  it('takes history without a seam: what is newer stays', () => {
    const series = new Series();
    series.append(f(10, 11, 12), f(1, 1, 1));
    series.replaceBefore(f(1, 5, 11), f(0, 0, 0));
    expect(sclks(series)).toEqual([1, 5, 11, 12]);
  });
  it('gives an exact range room where it was thinned', () => {
    const series = new Series();
    series.append(f(1, 2, 3, 4), f(1, 2, 3, 4));
    series.replace(2, 3, f(2, 2.5, 3), f(9, 9, 9));
    expect(sclks(series)).toEqual([1, 2, 2.5, 3, 4]);
  });
  it('stays bounded and keeps the extremes', () => {
    const series = new Series();
    const count = 200_000;
    series.append(
      Float64Array.from({ length: count }, (_, i) => i),
      Float64Array.from({ length: count }, (_, i) => (i === 777 ? 1e6 : 0)),
    );
    expect(series.length).toBeLessThanOrEqual(65536);
    expect(Math.max(...series.value.slice(0, series.length))).toBe(1e6);
    expect(series.sclk[series.length - 1]).toBe(count - 1);
  });
  it('finds the newest at or before an instant', () => {
    const series = new Series();
    series.append(f(1, 2, 3), f(10, 20, 30));
    expect(series.at(2.5)).toEqual({ sclk: 2, value: 20 });
    expect(series.at(0)).toBeUndefined();
  });
});

describe('Earth’s time of a run that is over', () => {
  const clock = create(ClockReplySchema, { sclk: ENTRY_SCLK, scetUs: ertUs('2012-219T05:00:00.0'), rate: 1 });
  const over = aRun({ clock, lightTimeS: 100, clocks: undefined });
  const heard = [
    event({ id: 5, name: 'X', text: 'x', sclk: 1000, ert: '2012-219T05:02:00.0' }),
    tone({ tone: 7, sclk: 1000, ertStart: '2012-219T05:03:00.0', ert: '2012-219T05:03:10.0' }),
  ];
  const words = (run: RunStore) => dayOfYear(run.ertOf(1000));

  it('is what was heard: the first tone, or else the first live event', () => {
    expect(words(aStore(heard, over))).toContain('05:03:00');
    expect(words(aStore(heard.slice(0, 1), over))).toContain('05:02:00');
  });
  it('is by clock correlation and light time where nothing was heard, but not of a followed mission', () => {
    expect(words(aStore([], over))).toContain('05:01:40');
    expect(aStore([], { ...over, entrySclk: 0 }).ertOf(1000)).toBeNaN();
  });
});

describe('a run of a followed mission', () => {
  const at = (second: number) => ({ ert: `2012-219T05:10:${String(second).padStart(2, '0')}.000` });
  const followed = (items: Parameters<typeof aStore>[0]) =>
    aStore(items, { ...aRun(), entrySclk: 0, clocks: undefined });

  it('has as newest what was received last, though its clock restarted or stands still', () => {
    const store = followed([
      samples(5010, { 3: 10, 4: 1 }, 1, at(1)),
      samples(5011, { 3: 11, 4: 2 }, 1, at(2)),
      samples(0, { 3: 12 }, 1, at(3)),
      samples(5011, { 4: 3 }, 1, at(4)),
    ]);
    expect(store.latest(3)).toMatchObject({ sclk: 0, value: 12 });
    expect(store.latest(4)).toMatchObject({ sclk: 5011, value: 3 });
    expect(store.latest(3, 5012)?.value).toBe(11); // the past goes by its clock
    expect(store.ertNow_s - (store.latest(3)?.ert_s ?? 0)).toBe(1);
  });
  it('goes back with the only clock that it has', () => {
    expect(followed([samples(5011, { 3: 1 }, 1, at(1)), samples(12, { 3: 2 }, 1, at(2))]).seenSclk).toBe(12);
  });
  it('says undefined where the newest sample is, and text exactly', () => {
    const exact = [{ id: 4, text: 'naïve' }];
    const store = followed([
      samples(1, { 3: 5, 4: NaN }, 1, { ...at(1), exact }),
      samples(2, { 3: NaN, 4: NaN }, 1, at(2)),
    ]);
    expect(store.latest(3)?.value).toBeNaN();
    expect(store.latest(4)?.text).toBeUndefined();
    expect(store.latest(4, 1.5)?.text).toBe('naïve');
  });
});

describe('a run', () => {
  it('shows an event once that came live and again with the recording', () => {
    const same = { id: 5, name: 'X', text: 'x', sclk: 990 };
    const store = aStore([
      event(same),
      event({ ...same, source: 2, duplicate: true }),
      event({ id: 6, name: 'Y', sclk: 980, source: 2 }),
    ]);
    expect(store.events.map((row) => [row.fact.name, row.live, row.recorded])).toEqual([
      ['Y', false, true],
      ['X', true, true],
    ]);
  });
  it('keeps both ways by which a firing is known', () => {
    const store = aStore([
      firing({ timepoint: 1, name: 'a', firedSclk: 950 }),
      firing({ timepoint: 1, name: 'a', firedSclk: 950, source: 2 }),
    ]);
    const pair = store.firings.get(1);
    expect([pair?.live?.firedSclk, pair?.recorded?.firedSclk]).toEqual([950, 950]);
  });
  it('looks at the past by an instant', () => {
    const store = aStore([samples(900, { 3: 100 }), samples(910, { 3: 50 }, 2)]);
    expect(store.latest(3)?.value).toBe(50);
    expect(store.latest(3, 905)?.value).toBe(100);
    expect(store.latest(3, 800)).toBeUndefined();
  });
  it('collects the stages of a command under its number', () => {
    const store = aStore([
      stage({ command: 1n, name: 'NO_OP', stage: 'queued', status: 'ok', arguments: 'a=1' }),
      stage({ command: 1n, stage: 'radiated', status: 'ok' }),
    ]);
    expect([...(store.commands.get(1)?.stages.keys() ?? [])]).toEqual(['queued', 'radiated']);
    expect(store.commands.get(1)?.arguments).toBe('a=1');
  });
  it('tells the SCLK of what was received at an ERT', () => {
    expect(aStore().sclkSeenAt(secondsOfDayOfYear('2012-219T04:59:50.0'))).toBeCloseTo(890);
  });
});

describe('times', () => {
  it('reads and writes day of year', () => {
    expect(dayOfYear(secondsOfDayOfYear('2012-219T05:10:47.400'))).toBe('2012-219T05:10:47.4');
    expect(dayOfYear(secondsOfDayOfYear('2012-219T05:10:47.400'), 3)).toBe('2012-219T05:10:47.400');
    expect(secondsOfDayOfYear('2012-08-06T05:10:47')).toBeNaN();
    expect(new Date(secondsOfDayOfYear('2012-219T05:10:47') * 1000).toISOString()).toBe('2012-08-06T05:10:47.000Z');
  });
  it('reads the microseconds of the stream, and cuts them as the server does', () => {
    expect(secondsOfErt(0n)).toBe(secondsOfDayOfYear('2000-001T12:00:00'));
    for (const [us, text] of [
      ['397847447015000', '.015'],
      ['397847447015999', '.015'],
      ['397847447999999', '.999'],
      ['397847447000000', '.000'],
    ] as const)
      expect(dayOfYear(secondsOfErt(us), 3)).toBe(`2012-223T05:10:47${text}`);
  });
  it('counts from entry', () => {
    expect(fromEntry(268.4)).toBe('E+4:28');
    expect(fromEntry(3723)).toBe('E+1:02:03');
    expect(fromEntry(-1142)).toBe('E−19:02');
    expect(fromEntry(255.93, { tenths: true })).toBe('E+4:15.9');
    expect(fromEntry(59.96, { tenths: true })).toBe('E+1:00.0');
    expect(fromEntry(NaN)).toBe('E —');
  });
  it('reads what people type', () => {
    expect(['E+3:20', '-120', '200.5', '4:28', 'e−1:00', '1:02:03', ''].map(readFromEntry)).toEqual([
      200,
      -120,
      200.5,
      268,
      -60,
      3723,
      undefined,
    ]);
    expect(readFromEntry('soon')).toBeUndefined();
  });
  it('says durations', () => {
    expect([0, 12.34, 828.1, 7300].map(duration)).toEqual(['0 s', '12.3 s', '13 m 48 s', '2 h 01 m']);
  });
});
