// SPDX-License-Identifier: Apache-2.0
// The words of the as-flown report (model.ts). tests/browser/panels_test.mjs sees them drawn.
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import {
  AsFlownEventSchema,
  AsFlownReportSchema,
  AsFlownTimepointSchema,
  SilenceSchema,
} from '../gen/aeolis/v1/run_pb';
import { flownEvent, flownRow, inOrder, silenceWords, summaryOf } from './model';

const row = (of: object) => create(AsFlownTimepointSchema, { name: 'parachute_deploy', verdict: 'nominal', ...of });

describe('a timepoint as it was flown', () => {
  it('has the times that are known, from entry, and nothing where nobody told', () => {
    expect(flownRow(row({ predictedES: 255.9 }))).toMatchObject({ planned: '', predicted: 'E+4:15.9', recorded: '' });
    expect(flownRow(row({ realtimeES: 254.05, recordedES: 254.05 }))).toMatchObject({
      planned: '',
      tone: '',
      uhf: 'E+4:14.1',
      recorded: 'E+4:14.1',
    });
  });
  it('tells what it had to spare, which is nothing where it only follows the one before', () => {
    expect(flownRow(row({ marginS: 0.1 }))).toMatchObject({ margin: '0.1 s' });
    expect(flownRow(row({ marginS: 3 }))).toMatchObject({ margin: '3.0 s' });
    expect(flownRow(row({}))).toMatchObject({ margin: '' });
  });
});

describe('the differences', () => {
  it('are flown less expected by the best source, and nothing where one of them is not known', () => {
    expect(flownRow(row({ plannedES: 255, predictedES: 255.9, realtimeES: 260, recordedES: 260.3 }))).toMatchObject({
      againstPlan: '+5.3',
      againstPrediction: '+4.4',
    });
    expect(flownRow(row({ predictedES: 255.9, toneES: 250 }))).toMatchObject({
      againstPlan: '',
      againstPrediction: '−5.9',
    });
    expect(flownRow(row({ predictedES: 10.02, recordedES: 10 }))).toMatchObject({ againstPrediction: '0.0' });
  });
  it('put the rows in order by their size, those without one last whichever way', () => {
    const rows = [
      row({ name: 'a', predictedES: 10, recordedES: 11 }),
      row({ name: 'b', predictedES: 10 }),
      row({ name: 'c', predictedES: 10, recordedES: 5 }),
    ];
    const names = (down: boolean) => inOrder(rows, { column: 'Δ prediction, s', down }).map((each) => each.name);
    expect([names(false), names(true)]).toEqual([
      ['a', 'c', 'b'],
      ['c', 'a', 'b'],
    ]);
    expect(inOrder(rows, { column: 'timepoint', down: true }).map((each) => each.name)).toEqual(['c', 'b', 'a']);
    expect(inOrder(rows, undefined)).toBe(rows);
  });
});

describe('an event as it was flown', () => {
  it('has the times that are known, and flight’s own words', () => {
    expect(
      flownEvent(
        create(AsFlownEventSchema, { name: 'bank_reversal_2', recordedES: 121.5, text: 'Bank reversal 2 begins' }),
      ),
    ).toEqual({
      name: 'bank_reversal_2',
      predicted: '',
      uhf: '',
      recorded: 'E+2:01.5',
      text: 'Bank reversal 2 begins',
    });
  });
});

describe('the report', () => {
  it('says in a sentence what came by which way', () => {
    const report = create(AsFlownReportSchema, {
      timepoints: [row({ toneES: 1, realtimeES: 2, recordedES: 2 }), row({ recordedES: 3 }), row({})],
      tonesDecoded: 40n,
      tonesErased: 3n,
    });
    expect(summaryOf(report)).toBe(
      '2 of 3 timepoints fired: 1 told by telemetry, 1 by tones, 2 in the recording. 40 tones were decoded, 3 were lost.',
    );
  });
  it('tells a silence from when to when, and why', () => {
    expect(silenceWords(create(SilenceSchema, { link: 'uhf_live', reason: 'plasma', fromES: 60, toES: 130 }))).toBe(
      'E+1:00 to E+2:10, 70 s: plasma',
    );
    expect(silenceWords(create(SilenceSchema, { link: 'x_band', reason: 'Earth has set', fromES: 300 }))).toBe(
      'E+5:00 to the end: Earth has set',
    );
    expect(silenceWords(create(SilenceSchema, { link: 'uhf_live', reason: 'lost', fromES: 397500964.8 }), false)).toBe(
      'SCLK 397500964.8 to the end: lost',
    );
  });
});
