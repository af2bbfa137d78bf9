// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, it } from 'vitest';
import { AnchorRowSchema, DictionaryReplySchema, TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import { Dictionary } from '../run/dictionary';
import { aDictionary, aStore, firing, samples, tone } from '../testing/fixtures';
import { anchorTree } from './anchors';

const ROWS = (
  [
    ['root', '', undefined],
    ['early', 'entry', -400],
    ['entry', 'root', undefined],
    ['parachute', 'root', undefined],
    ['nobody_knows', 'root', undefined],
  ] as const
).map(([name, parent, offsetS], id) =>
  create(AnchorRowSchema, { id, name, parent, ...(offsetS !== undefined && { offsetS }) }),
);
const PLAN = [
  create(TimepointRowSchema, { id: 0, name: 'vent', anchor: 'entry', desiredOffsetS: -50, plannedES: -50 }),
  create(TimepointRowSchema, { id: 1, name: 'mortar', anchor: 'parachute', desiredOffsetS: 2, tone: 'mortar' }),
];
const tree = (
  items: Parameters<typeof aStore>[0] = [],
  changes: Parameters<typeof anchorTree>[6] = [],
  words = aDictionary,
  cutoff = Infinity,
) =>
  anchorTree(
    aStore(items),
    words,
    ROWS,
    PLAN,
    [
      ['entry', 0],
      ['parachute', 250],
    ],
    cutoff,
    changes,
  );
const of = (lines: ReturnType<typeof tree>, name: string) => lines.find((line) => line.name === name);

it('each anchor stands under its parent, with its offset; what is only planned, predicted or unknown says so', () => {
  expect(tree().map((line) => [line.name, line.depth, line.offset_s, line.e_s, line.state])).toEqual([
    ['root', 0, undefined, undefined, 'defined'],
    ['entry', 1, undefined, 0, 'predicted'],
    ['early', 2, -400, -400, 'predicted'],
    ['parachute', 1, undefined, 250, 'predicted'],
    ['nobody_knows', 1, undefined, undefined, 'undefined'],
  ]);
});
it('an anchor is defined by what fired after it, by the vehicle’s own report, or by a command; and it says which', () => {
  const fired = firing({ timepoint: 1, firedSclk: 890, triggeredSclk: 889 });
  expect(of(tree([fired]), 'parachute')).toMatchObject({
    e_s: -113,
    state: 'defined',
    by: 'mortar fired, by UHF, live',
  });
  expect(of(tree([tone({ name: 'mortar', tone: 3, sclk: 889 })]), 'parachute')).toMatchObject({
    e_s: -113,
    by: 'mortar fired, by tone',
  });
  const words = new Dictionary(
    create(DictionaryReplySchema, { channels: [{ id: 9, name: 'parachute_anchor_sclk', packet: 'Status' }] }),
  );
  expect(of(tree([fired, samples(895, { 9: 887.5 })], [], words), 'parachute')).toMatchObject({
    e_s: -112.5,
    by: 'the vehicle, parachute_anchor_sclk',
  });
  expect(
    of(tree([], [{ anchor: { name: 'parachute', after: '', by_s: 260, since_e_s: -90 } }]), 'parachute'),
  ).toMatchObject({ e_s: 260, offset_s: 1260, state: 'defined', by: 'a command, carried out' });
});
it('a past view knows nothing of what came later', () => {
  expect(
    of(tree([firing({ timepoint: 1, firedSclk: 890, triggeredSclk: 889 })], [], aDictionary, 880), 'parachute')?.state,
  ).toBe('predicted');
});
