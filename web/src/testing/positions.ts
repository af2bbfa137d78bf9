// SPDX-License-Identifier: Apache-2.0
// The room for tests, as the server answers; times as day-of-year texts.
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { PositionActSchema, PositionBoardSchema } from '../gen/aeolis/v1/positions_pb';
import type { Answer, Board, Poll, Seat } from '../positions/model';
import { item } from './fixtures';
import { us } from './procedures';

/** Of `by` since a minute before the clocks of `aRun`; '': vacant. */
export const aSeat = (position: string, by = '', fields: Partial<Seat> = {}): Seat => ({
  position,
  by,
  ...(by !== '' && { since_us: us('2012-219T04:59:00.0') }),
  offered_to: '',
  acts: by === '' ? ['take'] : ['offer', 'leave'],
  ...fields,
});

export const anAnswer = (position: string, by: string, fields: Partial<Answer> = {}): Answer => ({
  position,
  by,
  answered: false,
  go: false,
  reason: '',
  ...fields,
});
export const said = (position: string, by: string, go: boolean, reason = ''): Answer =>
  anAnswer(position, by, { answered: true, go, reason, at_us: us('2012-219T04:59:50.0') });

export const aPoll = (fields: Partial<Poll> = {}): Poll => ({
  subject: 'do EDL',
  by: 'Ann',
  at_us: us('2012-219T04:59:30.0'),
  answers: [],
  against: '',
  overridden: '',
  ...fields,
});

export const aBoard = (seats: Seat[], fields: Partial<Board> = {}): Board => ({
  seats,
  closed: '',
  directed: seats.some(({ by }) => by !== ''),
  ...fields,
});

/** GET of a run's positions; `seq`: the number of the newest act. */
export const aRoom = (board: Board, seq = board.directed ? 1 : 0) => ({
  board,
  acts: seq === 0 ? [] : [{ seq: String(seq) }],
});
/** The answer to an act. */
export const acted = (board: Board, seq: number) => ({ seq: String(seq), position_act: { kind: 'take', board } });

/** An act on the stream. */
export const positionAct = (board: MessageInitShape<typeof PositionBoardSchema>) =>
  item(
    { case: 'positionAct', value: create(PositionActSchema, { board: create(PositionBoardSchema, board) }) },
    '2012-219T05:00:00.0',
  );
