// SPDX-License-Identifier: Apache-2.0
// The room: who holds which position, the poll with its answers and the decision, and what the person at this browser
// can do with them.
import { signal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { mayAct } from '../access/model';
import { Signature, myName } from '../commands/signature';
import { position, positionWords } from '../procedures/position';
import { clockOf } from '../procedures/step';
import { runNow, signalOfRun, takesActs } from '../run/shown';
import type { RunStore } from '../run/store';
import { POSITION_VIEWS } from './layout';
import {
  DIRECTOR,
  act,
  answerLook,
  board,
  busy,
  decisionLook,
  isEmpty,
  isRelief,
  lacksName,
  mySeats,
  offeredOf,
  problem,
  refreshPositions,
} from './model';
import type { ActKind, Answer, Board, Deed, Poll, Seat } from './model';
import { showLayoutOf } from './own_layout';
import './style.css';

const LOOK_MS = 300; // chosen: the interval of looks for another instant; only that is asked for

// ---- What is asked before an act -----------------------------------------------------------------------------------

interface Asked {
  words: string;
  question: string;
  field: 'to' | 'subject' | 'reason';
  needed: boolean;
}
/** For which act: one at a time. What it needs follows the room. */
const asked = signalOfRun<{ kind: ActKind; position: string } | undefined>(undefined);
const answer = signal('');

const WORDS: Record<ActKind, string> = {
  take: 'take',
  offer: 'offer',
  leave: 'leave',
  poll: 'call a poll',
  go: 'go',
  no_go: 'no go',
};
const wordsOf = (kind: ActKind, seat: Seat): string =>
  kind === 'leave' && seat.by !== myName()
    ? 'make vacant'
    : kind === 'take' && isRelief(seat)
      ? 'relieve'
      : WORDS[kind];

/** What an act needs to be told; undefined: nothing, it is done at once. */
function askedOf(kind: ActKind, seat: Seat, poll: Poll | undefined): Asked | undefined {
  const words = positionWords(seat.position);
  const about = { words: wordsOf(kind, seat) };
  switch (kind) {
    case 'offer':
      return { ...about, question: `Offer ${words}: to whom?`, field: 'to', needed: true };
    case 'poll':
      return { ...about, question: 'Poll the room: about what?', field: 'subject', needed: true };
    case 'leave':
      return seat.by === myName()
        ? { ...about, question: `Leave ${words}: why?`, field: 'reason', needed: false }
        : { ...about, question: `Make ${words} vacant: why?`, field: 'reason', needed: true };
    case 'no_go':
      return { ...about, question: `No go of ${words}: why?`, field: 'reason', needed: false };
    case 'go':
      return seat.position === DIRECTOR && poll && poll.against !== ''
        ? { ...about, question: `Go, against “${poll.against}”: why?`, field: 'reason', needed: true }
        : undefined;
    case 'take':
      return isRelief(seat)
        ? { ...about, question: `Relieve ${seat.by} as ${words}: why?`, field: 'reason', needed: true }
        : undefined;
  }
}

/** The seat has the focus after an act, unless the person went elsewhere: a second press then does nothing. */
function stayAt(place: string): void {
  requestAnimationFrame(() => {
    if (document.activeElement && document.activeElement !== document.body) return;
    document.querySelector<HTMLElement>(`.room [data-seat="${place}"]`)?.focus();
  });
}

async function does(deed: Deed): Promise<boolean> {
  const done = await act(deed);
  if (done) {
    asked.value = undefined;
    stayAt(deed.position);
  }
  return done;
}

/** An answer says to which poll it is one, so that it counts for no other. */
const subjectOf = (kind: ActKind, poll: Poll | undefined): string =>
  kind === 'go' || kind === 'no_go' ? (poll?.subject ?? '') : '';

/** Does it at once, or asks first for what it needs. */
function start(kind: ActKind, seat: Seat, poll: Poll | undefined): void {
  problem.value = '';
  const wanted = askedOf(kind, seat, poll);
  if (!wanted) {
    void does({ kind, position: seat.position, subject: subjectOf(kind, poll) });
    return;
  }
  answer.value = '';
  asked.value = { kind, position: seat.position };
}

function Ask({ of }: { of: Board }) {
  const deed = asked.value;
  const input = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => input.current?.focus(), [deed]);
  const seat = of.seats.find(({ position }) => position === deed?.position);
  if (!deed || !seat || !takesActs()) return null;
  const { kind, position } = deed;
  const nothing: Asked = { words: wordsOf(kind, seat), question: 'Why?', field: 'reason', needed: false };
  const wants = askedOf(kind, seat, of.poll) ?? nothing;
  const close = () => {
    asked.value = undefined;
    stayAt(position);
  };
  return (
    <form
      class="step-reason"
      data-testid="position-ask"
      onSubmit={(event) => {
        event.preventDefault();
        void does({ kind, position, subject: subjectOf(kind, of.poll), [wants.field]: answer.value });
      }}
      onKeyDown={(event) => {
        if (event.key !== 'Escape') return;
        event.preventDefault();
        event.stopPropagation();
        close();
      }}
    >
      <label>
        {wants.question}{' '}
        <input
          ref={input}
          maxLength={{ to: 64, subject: 200, reason: 500 }[wants.field]}
          placeholder={wants.needed ? '' : 'may stay empty'}
          spellcheck={wants.field !== 'to'}
          value={answer.value}
          onInput={(event) => (answer.value = event.currentTarget.value)}
        />
      </label>
      <button type="submit" disabled={(wants.needed && answer.value.trim() === '') || busy.value}>
        {wants.words}
      </button>
      <button type="button" class="quiet" onClick={close}>
        not <kbd>Esc</kbd>
      </button>
    </form>
  );
}

// ---- The room ------------------------------------------------------------------------------------------------------

function Act({ kind, seat, poll, first }: { kind: ActKind; seat: Seat; poll: Poll | undefined; first: boolean }) {
  const words = wordsOf(kind, seat);
  const asks = askedOf(kind, seat, poll) !== undefined;
  const isMain = kind === 'take' ? first || mySeats.value.length === 0 : ['poll', 'go', 'no_go'].includes(kind);
  return (
    <button
      type="button"
      class={isMain ? '' : 'quiet'}
      data-position-act={kind}
      data-first={first || undefined}
      disabled={busy.value || lacksName()}
      title={lacksName() ? 'type your name first' : undefined}
      aria-label={`${words}: ${positionWords(seat.position)}`}
      onClick={() => start(kind, seat, poll)}
    >
      {words}
      {asks && ' …'}
    </button>
  );
}

/** An answer of the poll, with its reason; the name only where another holds the position by now. */
function Said({ of, seat, run }: { of: Answer; seat: Seat; run: RunStore }) {
  const { shape, token, word } = answerLook(of);
  return (
    <span class="seat-answer" data-answer={of.answered ? (of.go ? 'go' : 'no_go') : 'none'}>
      <b class={`status-${token}`}>
        {shape} {word}
      </b>
      {of.answered && (
        <small>
          {' '}
          {of.by !== seat.by && `${of.by}, `}
          {clockOf(run, of.at_us)}
          {of.reason && `: “${of.reason}”`}
        </small>
      )}
    </span>
  );
}

function SeatOf({ seat, poll, run }: { seat: Seat; poll: Poll | undefined; run: RunStore }) {
  const said = poll?.answers.find((each) => each.position === seat.position);
  const acts = offeredOf(seat).filter((kind) => ['take', 'offer', 'leave'].includes(kind));
  const isOffered = seat.offered_to !== '' && seat.offered_to === myName();
  return (
    <li
      class={`seat ${seat.by !== '' && seat.by === myName() ? 'seat-mine' : ''}`}
      data-seat={seat.position}
      data-by={seat.by}
      tabIndex={-1}
    >
      <b>{positionWords(seat.position)}</b>
      {seat.by === '' ? (
        <span class="status-dim">○ vacant</span>
      ) : (
        <span class="seat-who">
          {seat.by} <small>since {clockOf(run, seat.since_us)}</small>
        </span>
      )}
      {seat.offered_to !== '' && <span class="status-caution">▷ offered to {seat.offered_to}</span>}
      {said && <Said of={said} seat={seat} run={run} />}
      {acts.map((kind) => (
        <Act key={kind} kind={kind} seat={seat} poll={poll} first={kind === 'take' && isOffered} />
      ))}
      {takesActs() && seat.by !== '' && seat.by === myName() && seat.position in POSITION_VIEWS && (
        <button
          type="button"
          class="quiet"
          data-testid="position-layout"
          title={`a layout of yours named ${positionWords(seat.position)} stands for it`}
          onClick={() => void showLayoutOf(seat.position)}
        >
          layout
        </button>
      )}
    </li>
  );
}

/** What this person says from a position that they hold: a poll, go, no go. */
function Mine({ seat, poll }: { seat: Seat; poll: Poll | undefined }) {
  const acts = offeredOf(seat).filter((kind) => ['poll', 'go', 'no_go'].includes(kind));
  if (acts.length === 0) return null;
  const directs = seat.position === DIRECTOR;
  const said = directs ? poll?.decision : poll?.answers.find((each) => each.position === seat.position);
  const isAwaited = poll !== undefined && !said?.answered && !(directs && poll.against !== '');
  return (
    <div class="step-acts" role="group" aria-label={`what ${positionWords(seat.position)} can say`}>
      <b>{positionWords(seat.position)}</b>
      {(['go', 'no_go', 'poll'] as const)
        .filter((kind) => acts.includes(kind))
        .map((kind) => (
          <Act key={kind} kind={kind} seat={seat} poll={poll} first={kind === 'go' && isAwaited} />
        ))}
      {directs && poll && !poll.decision && poll.against !== '' && <small>against a go: {poll.against}</small>}
    </div>
  );
}

function PollOf({ poll, run }: { poll: Poll; run: RunStore }) {
  const { shape, token, word } = decisionLook(poll);
  const { decision } = poll;
  return (
    <div class="room-poll" data-testid="room-poll">
      <output class={`room-decision status-${token}`} data-testid="room-decision">
        {shape} {word}
      </output>
      <span>
        <b>{poll.subject}</b>{' '}
        <small>
          poll called by {poll.by}, {clockOf(run, poll.at_us)}
          {decision && `; decided by ${decision.by}, ${clockOf(run, decision.at_us)}`}
          {decision?.reason && `: “${decision.reason}”`}
        </small>
      </span>
      {poll.overridden !== '' && <span class="status-caution">▲ overridden: {poll.overridden}</span>}
    </div>
  );
}

function Standing({ of, run }: { of: Board; run: RunStore }) {
  return (
    <>
      <div class="room-head">
        <h3>The room</h3>
        {of.directed && <small>rights follow positions</small>}
        {of.closed !== '' && (
          <span class="status-caution" data-testid="room-closed">
            ▲ Commanding is closed: {of.closed}
          </span>
        )}
      </div>
      {of.poll && <PollOf poll={of.poll} run={run} />}
      {of.seats
        .filter((seat) => mySeats.value.includes(seat.position))
        .map((seat) => (
          <Mine key={seat.position} seat={seat} poll={of.poll} />
        ))}
      <ul class="seats" aria-label="positions">
        {of.seats.map((seat) => (
          <SeatOf key={seat.position} seat={seat} poll={of.poll} run={run} />
        ))}
      </ul>
      <Ask of={of} />
    </>
  );
}

// ---- While nobody has taken a position -----------------------------------------------------------------------------

const isTaking = signalOfRun(false);

/** Takes one of the positions, of which none was taken yet. */
function Taking({ of }: { of: Board }) {
  const select = useRef<HTMLSelectElement>(null);
  useLayoutEffect(() => select.current?.focus(), []);
  const open = of.seats.filter((seat) => offeredOf(seat).includes('take'));
  const wished = open.find((seat) => seat.position === position.value) ?? open[0];
  const close = () => {
    isTaking.value = false;
  };
  return (
    <form
      class="procedure-me"
      onSubmit={(event) => {
        event.preventDefault();
        const place = select.current?.value ?? '';
        void does({ kind: 'take', position: place }).then((done) => done && close());
      }}
      onKeyDown={(event) => {
        if (event.key !== 'Escape') return;
        event.preventDefault();
        event.stopPropagation();
        close();
      }}
    >
      <select ref={select} data-testid="position-taken" aria-label="the position that you take">
        {open.map((seat) => (
          <option key={seat.position} value={seat.position} selected={seat === wished}>
            {positionWords(seat.position)}
          </option>
        ))}
      </select>
      <Signature />
      <button type="submit" disabled={busy.value || lacksName() || open.length === 0}>
        take
      </button>
      <button type="button" class="quiet" onClick={close}>
        not <kbd>Esc</kbd>
      </button>
    </form>
  );
}

function Nobody({ of }: { of: Board }) {
  const may = takesActs() && mayAct();
  return (
    <div class="room-head">
      <span class="status-dim">Positions: nobody has taken one</span>
      {may &&
        (isTaking.value ? (
          <Taking of={of} />
        ) : (
          <button type="button" class="quiet" data-testid="position-take" onClick={() => (isTaking.value = true)}>
            take one …
          </button>
        ))}
    </div>
  );
}

/** Above the procedures. A server without positions has no room. */
export function Room() {
  const run = runNow();
  useEffect(() => {
    const look = () => void refreshPositions();
    look();
    const timer = setInterval(look, LOOK_MS);
    return () => clearInterval(timer);
  }, []);
  const stands = board.value;
  if (!run || !stands) return null;
  return (
    <section class="room" aria-label="the room" data-testid="room">
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="position-problem">
          ✖ {problem.value}
        </p>
      )}
      {isEmpty(stands) ? <Nobody of={stands} /> : <Standing of={stands} run={run} />}
    </section>
  );
}
