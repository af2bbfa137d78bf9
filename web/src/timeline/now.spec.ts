// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { afterEach, describe, expect, it } from 'vitest';
import { TimepointListSchema } from '../gen/aeolis/v1/run_pb';
import { pastRange, store, withRecording } from '../run/shown';
import { ColumnCollector } from '../stream/columns';
import { aBatch, aRun, aStore, ertUs, event, firing, stage, tone } from '../testing/fixtures';
import { TimelinePace, timelineAnswer, timelineQuestion } from './asked';
import type { TimelineQuestion } from './asked';
import { moved, predicted, predictedAsOf, predictionsOf } from './now';

const at = (e_s: number) =>
  aRun({
    clocks: {
      sclk: 1000 + e_s,
      seenSclk: 1000 + e_s,
      eS: e_s,
      ertUs: ertUs('2012-219T05:00:00.0'),
      scetUs: ertUs('2012-219T05:00:00.0'),
    },
  });
const LIST = create(TimepointListSchema, {
  knownAtES: -100,
  timepoints: [
    { id: 0, name: 'vent', predictedES: -826, expectedES: -826, heardBy: 'uhf' },
    { id: 1, name: 'mortar', predictedES: 250, expectedES: 250, movedES: 260 },
    { id: 2, name: 'unknown', notPredicted: 'its anchor is not known' },
  ],
});
const answered = (list = LIST, asked: Partial<TimelineQuestion> = {}) => {
  timelineAnswer.value = { asked: { ...timelineQuestion.value, ...asked }, list, at_ms: 0 };
};

afterEach(() => {
  [store.value, pastRange.value, withRecording.value] = [undefined, undefined, false];
});

describe('the prediction of the run that is shown', () => {
  it('is the server’s, with what has fired, and without what it does not predict', () => {
    store.value = aStore([], at(-100));
    answered();
    expect(predicted.value).toEqual([
      { id: 0, name: 'vent', e_s: -826, fired: true },
      { id: 1, name: 'mortar', e_s: 250, fired: false },
    ]);
  });
  it('keeps for what is overdue the time at which the server expected it, not the one to which it has moved', () => {
    const list = create(TimepointListSchema, {
      timepoints: [
        { id: 0, name: 'sufr', predictedES: 239, expectedES: 239, heardBy: 'tone' },
        { id: 1, name: 'mortar', predictedES: 3600, expectedES: 256 },
      ],
    });
    expect(predictionsOf(list).map(({ e_s }) => e_s)).toEqual([239, 256]);
  });
  it('is that of the flights of ground’s plan where they are made, with the interval that they give', () => {
    const list = create(TimepointListSchema, {
      timepoints: [
        {
          id: 0,
          name: 'mortar',
          predictedES: 256,
          expectedES: 256,
          flights: 300,
          flightsES: 258.5,
          flightsFromES: 251,
          flightsToES: 266,
        },
        { id: 1, name: 'shield', predictedES: 280, expectedES: 280, flights: 50, flightsES: 282 },
      ],
    });
    expect(predictionsOf(list)).toEqual([
      { id: 0, name: 'mortar', e_s: 258.5, fired: false, flights: 300, within: { from_e_s: 251, to_e_s: 266 } },
      { id: 1, name: 'shield', e_s: 282, fired: false, flights: 50 },
    ]);
  });
  it('is of one run only', () => {
    store.value = aStore([], at(-100));
    answered();
    store.value = aStore([], aRun({ run: 9n }));
    expect(predicted.value).toEqual([]);
  });
  it('says of which instant it is once that is some way back', () => {
    store.value = aStore([], at(-98));
    answered();
    expect(predictedAsOf.value).toBeUndefined();
    store.value = aStore([], at(-60));
    answered();
    expect(predictedAsOf.value).toBe(-100);
  });
  it('of a past view is asked for its end, and is never one that knows what came later', () => {
    store.value = aStore([], at(300));
    pastRange.value = { from: 0, to: 240 };
    expect(timelineQuestion.value).toMatchObject({ text: '?at=1240&recorded=false', at: 1240, recorded: false });
    withRecording.value = true;
    expect(timelineQuestion.value.text).toBe('?at=1240');
    answered();
    expect(predicted.value.length).toBe(2);
    pastRange.value = { from: 0, to: 250 };
    expect(predicted.value.length).toBe(2); // the replay has advanced
    pastRange.value = { from: 0, to: 200 };
    expect(predicted.value).toEqual([]);
    pastRange.value = { from: 0, to: 240 };
    withRecording.value = false;
    expect(predicted.value).toEqual([]);
    pastRange.value = undefined;
    expect(predicted.value).toEqual([]);
  });
});

describe('the effect of a command, before it is sent', () => {
  it('is what the server would move by that very command, and nothing until it has said so', () => {
    store.value = aStore([], at(-100));
    answered();
    expect(moved.value).toBeUndefined(); // the answer belongs to a query without a command
    answered(create(TimepointListSchema, { ...LIST, commandMoves: true }));
    expect(moved.value).toEqual([{ id: 1, name: 'mortar', from_e_s: 250, to_e_s: 260 }]);
    answered(create(TimepointListSchema, { ...LIST, commandMoves: true }), { command: 'another' });
    expect(moved.value).toBeUndefined();
  });
});

describe('the timeline is asked for again', () => {
  const asked = (run = aStore([], at(-100))) => {
    const pace = new TimelinePace();
    pace.asked(run, '', run.timelineVersion, 0, false);
    return { run, pace };
  };
  it('at once for another run or question, and when a firing, a tone or a stage of a command has come', () => {
    const { run, pace } = asked();
    expect(pace.isDue(run, '', 1)).toBe(false);
    expect(pace.isDue(run, '?at=5', 1)).toBe(true);
    expect(pace.isDue(aStore([], at(-100)), '', 1)).toBe(true);
    const after = (item: Parameters<typeof aBatch>[0][number]) => {
      const one = asked();
      const collector = new ColumnCollector();
      collector.add(aBatch([item]));
      one.run.add(collector.take());
      return one.pace.isDue(one.run, '', 1);
    };
    expect(
      [firing({ timepoint: 1 }), tone({ tone: 3 }), stage({ command: 1n }), event({ sclk: 900 })].map(after),
    ).toEqual([true, true, true, false]);
  });
  it('each second while the run goes on, for what is overdue moves; after a failure less often', () => {
    const { run, pace } = asked();
    expect([999, 1000].map((ms) => pace.isDue(run, '', ms))).toEqual([false, true]);
    pace.asked(run, '', run.timelineVersion, 0, true);
    expect([1999, 2000].map((ms) => pace.isDue(run, '', ms))).toEqual([false, true]);
    const over = asked(aStore([], aRun({ state: 'finished' })));
    expect(over.pace.isDue(over.run, '', 1e6)).toBe(false);
  });
});
