// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { expect, it } from 'vitest';
import { AnchorRowSchema, TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import { anchorTree } from './anchors';

const anchor = (id: number, name: string, parent: string, known: MessageInitShape<typeof AnchorRowSchema>) =>
  create(AnchorRowSchema, { id, name, parent, ...known });
const ROWS = [
  anchor(0, 'root', '', { state: 'defined', basis: 'clock' }),
  anchor(1, 'early', 'entry', { state: 'predicted', basis: 'parent', eS: -400, currentOffsetS: -400 }),
  anchor(2, 'entry', 'root', { state: 'predicted', basis: 'plan', eS: 0 }),
  anchor(3, 'parachute', 'root', { state: 'defined', basis: 'firing', fired: 'mortar', eS: 252 }),
  anchor(4, 'nobody_knows', 'root', { state: 'undefined' }),
];
const PLAN = [create(TimepointRowSchema, { id: 1, name: 'mortar', anchor: 'parachute', heardBy: 'tone' })];

it('each anchor stands under its parent, with its offset and the server’s word on when it is and what says so', () => {
  expect(
    anchorTree(ROWS, PLAN).map((line) => [line.name, line.depth, line.offset_s, line.e_s, line.state, line.by]),
  ).toEqual([
    ['root', 0, undefined, undefined, 'defined', 'zero of the clock on board'],
    ['entry', 1, undefined, 0, 'predicted', 'ground’s plan'],
    ['early', 2, -400, -400, 'predicted', 'offset from entry'],
    ['parachute', 1, undefined, 252, 'defined', 'mortar fired, by tone'],
    ['nobody_knows', 1, undefined, undefined, 'undefined', 'nothing yet'],
  ]);
});
it('a basis that is not known has no words of its own', () => {
  const by = (basis: string) => anchorTree([anchor(0, 'root', '', { basis })], [])[0]?.by;
  expect(['report', 'command', 'design', 'overdue', 'new'].map(by)).toEqual([
    'the vehicle’s own report',
    'a command, carried out',
    'prediction',
    'prediction; it is overdue',
    'nothing yet',
  ]);
});
