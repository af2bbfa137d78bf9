// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { AnchorRowSchema, TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import { aRun, aStore, firing, stage, tone } from '../testing/fixtures';
import { changeOf, changesMade, movedBy, predictions } from './predict';

const row = (id: number, name: string, anchor: string, desiredOffsetS: number, minimumOffsetS = 0, toneName = '') =>
  create(TimepointRowSchema, {
    id,
    name,
    anchor,
    desiredOffsetS,
    minimumOffsetS,
    tone: toneName,
    ...(anchor === 'entry' && { plannedES: desiredOffsetS }),
  });
const PLAN = [
  row(0, 'vent', 'entry', -50),
  row(1, 'interface', 'entry', 0),
  row(2, 'mortar', 'parachute', 0, 0, 'mortar'),
  row(3, 'radar', 'parachute', 6),
  row(4, 'shield', 'heatshield', 0, 20),
  row(5, 'beams', '', 2, 2),
  row(6, 'unknown', 'nobody_knows', 0),
];
const ROWS = [
  ['root', ''],
  ['entry', 'root'],
  ['parachute', 'root'],
  ['heatshield', 'entry'],
].map(([name, parent], id) => create(AnchorRowSchema, { id, name, parent }));
const ANCHORS = [
  ['entry', 0],
  ['parachute', 250],
  ['heatshield', 270],
] as const;
const at = (e_s: number) =>
  aRun({
    clocks: {
      sclk: 1000 + e_s,
      seenSclk: 1000 + e_s,
      eS: e_s,
      ert: '2012-219T05:00:00.0',
      scet: '2012-219T05:00:00.0',
    },
  });
const times = (all: ReturnType<typeof predictions>) => Object.fromEntries(all.map((each) => [each.name, each.e_s]));
const predict = (
  e_s: number,
  items: Parameters<typeof aStore>[0] = [],
  changes: Parameters<typeof predictions>[4] = [],
) => predictions(aStore(items, at(e_s)), PLAN, ANCHORS, Infinity, changes);

describe('the prediction', () => {
  it('is the timeline’s rule over predicted anchors, minimum offsets included; what nobody predicts is left out', () => {
    expect(times(predict(-100))).toEqual({ vent: -50, interface: 0, mortar: 250, radar: 256, shield: 276, beams: 278 });
  });
  it('moves with an anchor that was heard of by UHF, and everything after it', () => {
    const moved = predict(243, [firing({ timepoint: 2, firedSclk: 1241, triggeredSclk: 1240 })]);
    expect(times(moved)).toMatchObject({ radar: 246, shield: 266 });
    expect(moved.find((each) => each.name === 'mortar')).toMatchObject({ e_s: 250, fired: true });
  });
  it('moves with a tone where UHF is silent', () => {
    expect(times(predict(262, [tone({ name: 'mortar', tone: 3, sclk: 1255 })]))).toMatchObject({
      radar: 261,
      shield: 281,
    });
  });
  it('of an anchor that is overdue is now, and what hangs from it follows', () => {
    expect(times(predict(280))).toMatchObject({ mortar: 280, radar: 286, shield: 306 });
  });
  it('knows nothing later than the past view', () => {
    const store = aStore([firing({ timepoint: 2, firedSclk: 1241, triggeredSclk: 1240 })], at(300));
    expect(times(predictions(store, PLAN, ANCHORS, 1200))).toMatchObject({ mortar: 250, radar: 256 });
  });
  it('has what the vehicle has carried out of commands that move timepoints, and not what it has refused', () => {
    const sent = (status: string) =>
      aStore(
        [
          stage({
            command: 1n,
            name: 'EDL_SET_TIMEPOINT_OFFSET',
            stage: 'queued',
            status: 'ok',
            arguments: 'timepoint=3 desired_offset_s=9 minimum_offset_s=0',
          }),
          stage({ command: 1n, stage: 'executed', status, at: '2012-219T04:59:00.0' }),
        ],
        at(-100),
      );
    const made = (status: string) => changesMade(sent(status), ROWS, Infinity);
    expect([made('ok'), made('failed')]).toEqual([[{ timepoint: { id: 3, desired_s: 9, minimum_s: 0 } }], []]);
    expect(times(predict(-100, [], made('ok')))).toMatchObject({ radar: 259 });
  });
});

describe('the effect of a command, before it is sent', () => {
  const before = predict(-100);
  const effect = (command: string, values: [string, number][]) => {
    const change = changeOf(command, new Map(values), aStore([], at(-100)), ROWS);
    return (
      change && movedBy(before, predict(-100, [], [change])).map((each) => [each.name, each.to_e_s - each.from_e_s])
    );
  };
  it('of an offset is on that timepoint and on those that its predecessors hold back', () => {
    expect(
      effect('EDL_SET_TIMEPOINT_OFFSET', [
        ['timepoint', 3],
        ['desired_offset_s', 16],
        ['minimum_offset_s', 0],
      ]),
    ).toEqual([
      ['radar', 10],
      ['shield', 10],
      ['beams', 10],
    ]);
  });
  it('of another time of entry is on all', () => {
    expect(effect('EDL_SET_PARAMETERS', [['entry_sclk', 1005]])).toEqual([
      ['vent', 5],
      ['interface', 5],
      ['mortar', 5],
      ['radar', 5],
      ['shield', 5],
      ['beams', 5],
    ]);
  });
  it('of an anchor’s offset is on what hangs from it: after the clock’s zero, or after another anchor', () => {
    expect(
      effect('EDL_SET_ANCHOR_OFFSET', [
        ['anchor', 2],
        ['offset_s', 1260],
      ]),
    ).toEqual([
      ['mortar', 10],
      ['radar', 10],
      ['shield', 10],
      ['beams', 10],
    ]);
    expect(
      effect('EDL_SET_ANCHOR_OFFSET', [
        ['anchor', 3],
        ['offset_s', 300],
      ]),
    ).toEqual([
      ['shield', 24],
      ['beams', 24],
    ]);
    expect(
      effect('EDL_SET_ANCHOR_OFFSET', [
        ['anchor', 1],
        ['offset_s', 1005],
      ]),
    ).toEqual(effect('EDL_SET_PARAMETERS', [['entry_sclk', 1005]]));
    expect([
      effect('EDL_SET_ANCHOR_OFFSET', [
        ['anchor', 0],
        ['offset_s', 5],
      ]),
      effect('EDL_SET_ANCHOR_OFFSET', [
        ['anchor', 9],
        ['offset_s', 5],
      ]),
    ]).toEqual([undefined, undefined]);
  });
  it('of an anchor’s offset lasts until the vehicle itself finds the anchor', () => {
    const made = [{ anchor: { name: 'parachute', after: '', by_s: 260, since_e_s: -90 } }];
    expect(times(predict(-80, [], made))).toMatchObject({ mortar: 260, radar: 266 });
    expect(times(predict(243, [firing({ timepoint: 2, firedSclk: 1241, triggeredSclk: 1240 })], made))).toMatchObject({
      radar: 246,
    });
  });
  it('is none where nothing moves, and has no word on other commands or empty fields', () => {
    expect(effect('EDL_SET_PARAMETERS', [['entry_sclk', 1000]])).toEqual([]);
    expect([effect('NO_OP', []), effect('EDL_SET_TIMEPOINT_OFFSET', [['timepoint', 3]])]).toEqual([
      undefined,
      undefined,
    ]);
  });
  it('is never on what has fired', () => {
    const store = aStore([firing({ timepoint: 0, firedSclk: 950, triggeredSclk: 950 })], at(-40));
    const [now, then] = [[], [{ timepoint: { id: 0, desired_s: -10, minimum_s: 0 } }]].map((changes) =>
      predictions(store, PLAN, ANCHORS, Infinity, changes),
    );
    expect(movedBy(now ?? [], then ?? [])).toEqual([]);
  });
});
