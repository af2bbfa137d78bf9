// SPDX-License-Identifier: Apache-2.0
// Who holds which position of the control room, and the flight director's poll, as the server has them at the instant
// shown. The page judges neither: what can be done is the server's word, and only who does it is compared with the
// person at this browser.
import { computed, signal } from '@preact/signals';
import { mayAct, mayDirect } from '../access/model';
import { myName } from '../commands/signature';
import { wordsFor } from '../run/api';
import { AsOf } from '../run/as_of';
import { change } from '../run/connection';
import { cutoff, signalOfRun, store, takesActs, tick } from '../run/shown';

export const DIRECTOR = 'flight_director';

export type ActKind = 'take' | 'offer' | 'leave' | 'poll' | 'go' | 'no_go';
export interface Seat {
  position: string;
  by: string; // '': vacant
  since_us?: string; // none: vacant
  offered_to: string;
  acts: ActKind[];
}
export interface Answer {
  position: string;
  by: string;
  answered: boolean;
  go: boolean;
  reason: string;
  at_us?: string; // none: not answered
}
export interface Poll {
  subject: string;
  by: string;
  at_us: string;
  answers: Answer[];
  decision?: Answer;
  against: string;
  overridden: string;
}
/** How the room stands. */
export interface Board {
  seats: Seat[];
  poll?: Poll;
  closed: string;
  directed: boolean;
}
interface ActItem {
  seq: string;
  position_act: { board: Board };
}

// ---- How the room stands -------------------------------------------------------------------------------------------

/** `seq`: the number of the newest act; 0: nobody has taken a position. */
interface Room {
  seq: number;
  board: Board | undefined;
}
const room = new AsOf<{ board: Board; acts: { seq: string }[] }, Room>(
  'positions',
  ({ board, acts }) => ({ seq: Number(acts.at(-1)?.seq ?? 0), board }),
  { seq: 0, board: undefined },
);

export const refreshPositions = (): Promise<void> => room.refresh();

/** The newest that is known, also while a past is shown. */
export const boardNow = computed<Board | undefined>(() => {
  void tick.value;
  const [known, heard] = [room.value.value, store.value?.positions];
  return heard && heard.seq > (known?.seq ?? 0) ? heard.board : known?.board;
});
/** The room at the instant shown; undefined: not known, or the server has no positions. */
export const board = computed<Board | undefined>(() =>
  cutoff.value === Infinity ? boardNow.value : room.value.value?.board,
);

/** Whether nobody has taken a position yet. */
export const isEmpty = ({ seats, poll, directed }: Board): boolean =>
  !directed && poll === undefined && seats.every(({ by }) => by === '');

// ---- The person at this browser ------------------------------------------------------------------------------------

/** Without accounts whoever acts gives a name. */
export const lacksName = (): boolean => myName() === '';

/** The positions that this person holds now. */
export const mySeats = computed<string[]>(() => {
  const me = myName();
  return me === '' ? [] : (boardNow.value?.seats ?? []).filter(({ by }) => by === me).map(({ position }) => position);
});

/** The positions from which this person acts in procedures: a flight director stands in for those that are vacant. */
export const myPositions = computed<string[]>(() => {
  const mine = mySeats.value;
  if (!mine.includes(DIRECTOR)) return mine;
  const vacant = (boardNow.value?.seats ?? []).filter(({ by }) => by === '').map(({ position }) => position);
  return [...mine, ...vacant];
});

/** Whether the seat is the flight director's and another's, who did not offer it: it is taken with a reason. */
export const isRelief = ({ position, by, offered_to }: Seat): boolean =>
  position === DIRECTOR && by !== '' && offered_to !== myName();

/** Which of the acts that a seat is open for this person has a part in. The server judges each. */
export function offeredOf(seat: Seat): ActKind[] {
  const { position, by, offered_to, acts } = seat;
  if (!takesActs() || !mayAct()) return [];
  const me = myName();
  const holds = me !== '' && by === me;
  const has: Record<ActKind, boolean> = {
    take:
      (by === '' || (me !== '' && offered_to === me) || (isRelief(seat) && !holds)) &&
      (position !== DIRECTOR || mayDirect()),
    offer: holds,
    leave: holds || (by !== '' && mySeats.value.includes(DIRECTOR)),
    poll: holds,
    go: holds,
    no_go: holds,
  };
  return acts.filter((kind) => has[kind]);
}

// ---- What people do ------------------------------------------------------------------------------------------------

export const problem = signalOfRun('');
/** Whether an act is under way: one at a time, so that none is sent twice. */
export const busy = signal(false);

export interface Deed {
  kind: ActKind;
  position: string;
  to?: string;
  subject?: string;
  reason?: string;
}
/** Does one thing with a position; true if the server took it. */
export async function act({ kind, position, to = '', subject = '', reason = '' }: Deed): Promise<boolean> {
  const run = store.value;
  if (!run || busy.value) return false;
  busy.value = true;
  problem.value = '';
  try {
    const said = { to: to.trim(), subject: subject.trim(), reason: reason.trim() };
    const item = await change<ActItem>(`/runs/${run.id}/positions`, { kind, position, by: myName(), ...said });
    const done = { seq: Number(item.seq), board: item.position_act.board };
    if (store.value === run) room.renew((known) => (known.seq >= done.seq ? known : done));
    return true;
  } catch (error) {
    const what = `${kind} of ${position}`.replaceAll('_', ' ');
    if (store.value === run) problem.value = `${what}: not done: ${wordsFor(error)}`;
    return false;
  } finally {
    busy.value = false;
  }
}

// ---- How it looks --------------------------------------------------------------------------------------------------

interface Look {
  shape: string;
  token: string;
  word: string;
}
/** An answer of a poll. */
export const answerLook = ({ answered, go }: Pick<Answer, 'answered' | 'go'>): Look =>
  !answered
    ? { shape: '□', token: 'dim', word: 'not answered' }
    : go
      ? { shape: '✓', token: 'good', word: 'go' }
      : { shape: '✕', token: 'caution', word: 'no go' };

/** What became of a poll: the flight director's word, or that it goes on. */
export function decisionLook({ decision }: Poll): Look {
  if (!decision?.answered) return { shape: '□', token: 'accent', word: 'polling' };
  const look = answerLook(decision);
  return { ...look, word: look.word.toUpperCase() };
}
