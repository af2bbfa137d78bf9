// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act as settled } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { access } from '../access/model';
import { uplink } from '../commands/line';
import { AT_ONCE } from '../commands/model';
import { Commands } from '../commands/view';
import { PositionAct_Kind } from '../gen/aeolis/v1/positions_pb';
import { choosePosition, position } from '../procedures/position';
import { library, problem as procedureProblem } from '../procedures/model';
import { Procedures } from '../procedures/view';
import { onMessage, useForTest } from '../run/session';
import { lookAtPast, pastRange, store, tick } from '../run/shown';
import { ColumnCollector } from '../stream/columns';
import { aBatch, aDictionary, aRun, aStore, ertUs } from '../testing/fixtures';
import { aBoard, aPoll, aRoom, aSeat, acted, anAnswer, positionAct, said } from '../testing/positions';
import { anExecution, aStep, inItem } from '../testing/procedures';
import { aServer } from '../testing/server';
import { AskedHere } from './asked';
import { board, myPositions, offeredOf, problem, refreshPositions } from './model';
import type { Answer, Board } from './model';
import css from './style.css?raw';
import { Room } from './view';

const server = aServer();
let root: HTMLElement;

const words = () => root.textContent?.replace(/\s+/g, ' ') ?? '';
const seat = (name: string) => root.querySelector<HTMLElement>(`[data-seat="${name}"]`);
const seatWords = (name: string) => seat(name)?.textContent?.replace(/\s+/g, ' ');
const button = (label: string) =>
  [...root.querySelectorAll('button')].find(
    (each) => each.textContent?.trim() === label || each.getAttribute('aria-label') === label,
  );
const click = (label: string) => settled(async () => void button(label)?.click());
const offers = () =>
  [...root.querySelectorAll<HTMLElement>('[data-position-act]')].map((each) => each.getAttribute('aria-label'));
const posted = () => server.asked.filter(({ method }) => method === 'POST').map(({ path, body }) => [path, body]);
const said_ = { by: 'Ann', to: '', subject: '', reason: '' };
const ask = () => root.querySelector<HTMLFormElement>('[data-testid="position-ask"]');
const submit = () => root.querySelector<HTMLButtonElement>('[data-testid="position-ask"] [type="submit"]');
/** Types into the field that asks, and sends it. */
async function answer(text: string): Promise<void> {
  const field = root.querySelector<HTMLInputElement>('[data-testid="position-ask"] input')!;
  field.value = text;
  await settled(async () => void field.dispatchEvent(new Event('input', { bubbles: true })));
  await settled(async () => void ask()?.dispatchEvent(new Event('submit', { bubbles: true })));
}

/** Shows the room as the server has it. */
async function shows(of: Board, seq?: number): Promise<void> {
  server.routes['GET /runs/1/positions'] = { json: aRoom(of, seq) };
  settled(() => render(<Room />, root));
  await vi.waitFor(() => {
    settled(() => undefined);
    expect(root.querySelector('[data-testid="room"]')).not.toBeNull();
  });
}
/** The server takes the next act; the room stands so behind it. */
const takes = (of: Board, seq = 2) => {
  server.routes['POST /runs/1/positions'] = { status: 201, json: acted(of, seq) };
};

beforeEach(() => {
  localStorage.clear();
  choosePosition('');
  [problem.value, procedureProblem.value, library.value] = ['', '', undefined];
  access.value = { state: 'open' };
  uplink.value = { ...AT_ONCE, controller: 'Ann' };
  pastRange.value = undefined;
  useForTest(aStore(), aDictionary);
  root = document.body.appendChild(document.createElement('div'));
});
afterEach(() => {
  settled(() => render(null, root));
  root.remove();
  useForTest(undefined, undefined);
});

describe('while nobody has taken a position', () => {
  const nobody = aBoard([aSeat('flight_director'), aSeat('gnc')]);
  it('one quiet line says so, and one is taken under a name', async () => {
    uplink.value = AT_ONCE;
    await shows(nobody);
    expect([words(), offers()]).toEqual(['Positions: nobody has taken onetake one …', []]);
    await click('take one …');
    expect(root.querySelector<HTMLButtonElement>('[type="submit"]')?.disabled).toBe(true);
    await settled(async () => {
      uplink.value = { ...AT_ONCE, controller: 'Ann' };
    });
    root.querySelector<HTMLSelectElement>('[data-testid="position-taken"]')!.value = 'gnc';
    takes(aBoard([aSeat('flight_director'), aSeat('gnc', 'Ann')]));
    await settled(async () => void root.querySelector('form')?.dispatchEvent(new Event('submit', { bubbles: true })));
    await vi.waitFor(() => expect(seatWords('gnc')).toContain('GNCAnn since E−2:40'));
    expect(posted()).toEqual([['/runs/1/positions', { ...said_, kind: 'take', position: 'gnc' }]]);
  });
  it('an observer is offered none', async () => {
    access.value = { state: 'in', user: 'eve', role: 'observer', rights: [] };
    await shows(nobody);
    expect(words()).toBe('Positions: nobody has taken one');
  });
});
it('a server without positions has no room', async () => {
  settled(() => render(<Room />, root));
  await refreshPositions();
  settled(() => undefined);
  expect([words(), board.value]).toEqual(['', undefined]);
});

describe('the seats', () => {
  it('show who holds each since when, which are vacant, and to whom one is offered', async () => {
    const offered = aSeat('command', 'Ben', { offered_to: 'Cy' });
    await shows(aBoard([aSeat('flight_director', 'Dee'), offered, aSeat('gnc')]));
    expect([seatWords('flight_director'), seatWords('command'), seatWords('gnc')]).toEqual([
      'Flight directorDee since E−2:40',
      'CommandBen since E−2:40▷ offered to Cy',
      'GNC○ vacanttake',
    ]);
    expect(words()).toContain('The roomrights follow positions');
  });
  it('have buttons only where the server has an act and the person a part in it', async () => {
    const all = ['offer', 'leave', 'poll', 'go', 'no_go'] as const;
    const seats = [
      aSeat('flight_director', 'Dee', { acts: ['offer', 'leave', 'poll', 'go', 'no_go'] }),
      aSeat('command', 'Ben', { acts: ['take', 'offer', 'leave', 'go', 'no_go'], offered_to: 'Cy' }),
      aSeat('gnc', 'Ben', { acts: ['offer'] }),
      aSeat('systems'),
      aSeat('navigation', '', { acts: [] }),
    ];
    const has = (name: string) => {
      uplink.value = { ...AT_ONCE, controller: name };
      return seats.map(offeredOf);
    };
    await shows(aBoard(seats));
    expect(has('Dee')).toEqual([[...all], ['leave'], [], ['take'], []]);
    expect(has('Ben')).toEqual([[], ['offer', 'leave', 'go', 'no_go'], ['offer'], ['take'], []]);
    expect(has('Cy')).toEqual([[], ['take'], [], ['take'], []]);
    expect(has('')).toEqual([[], [], [], ['take'], []]);
    access.value = { state: 'in', user: 'Dee', role: 'observer', rights: [] };
    expect(seats.flatMap(offeredOf)).toEqual([]);
  });
  it('without a name are not taken', async () => {
    uplink.value = AT_ONCE;
    await shows(aBoard([aSeat('command', 'Ben'), aSeat('gnc')]));
    expect([button('take: GNC')?.disabled, button('take: GNC')?.title]).toEqual([true, 'type your name first']);
  });
  it('are handed over by an offer that names a person, who takes it with one press', async () => {
    await shows(aBoard([aSeat('gnc', 'Ann')]));
    await click('offer: GNC');
    expect([ask()?.textContent, submit()?.disabled]).toEqual([expect.stringContaining('Offer GNC: to whom?'), true]);
    takes(aBoard([aSeat('gnc', 'Ann', { offered_to: 'Ben', acts: ['take', 'offer', 'leave'] })]));
    await answer(' Ben ');
    await vi.waitFor(() => expect(ask()).toBeNull());
    expect(posted().at(-1)?.[1]).toEqual({ ...said_, kind: 'offer', position: 'gnc', to: 'Ben' });
    await settled(async () => {
      uplink.value = { ...AT_ONCE, controller: 'Ben' };
    });
    expect([offers(), button('take: GNC')?.hasAttribute('data-first')]).toEqual([['take: GNC'], true]);
    takes(aBoard([aSeat('gnc', 'Ben')]), 3);
    await click('take: GNC');
    await vi.waitFor(() => expect(seatWords('gnc')).toContain('GNCBen since'));
  });
  it('are left with a reason or without; the flight director makes another’s vacant with a reason alone', async () => {
    const seats = [aSeat('flight_director', 'Ann'), aSeat('gnc', 'Ben')];
    await shows(aBoard(seats));
    await click('leave: Flight director');
    expect(submit()?.disabled).toBe(false);
    await click('make vacant: GNC');
    expect([ask()?.textContent, submit()?.textContent, submit()?.disabled]).toEqual([
      expect.stringContaining('Make GNC vacant: why?'),
      'make vacant',
      true,
    ]);
    takes(aBoard([seats[0]!, aSeat('gnc')]));
    await answer('gone home');
    expect(posted()).toEqual([
      ['/runs/1/positions', { ...said_, kind: 'leave', position: 'gnc', reason: 'gone home' }],
    ]);
  });
});

describe('a flight director', () => {
  const away = aSeat('flight_director', 'Dee', { acts: ['take', 'offer', 'leave'] });
  const seats = [away, aSeat('command', 'Ben'), aSeat('gnc')];

  it('who is away is relieved by another director alone, with a reason', async () => {
    await shows(aBoard(seats));
    await click('relieve: Flight director');
    expect([ask()?.textContent, submit()?.disabled]).toEqual([
      expect.stringContaining('Relieve Dee as Flight director: why?'),
      true,
    ]);
    takes(aBoard([aSeat('flight_director', 'Ann')]));
    await answer('no answer on the loop');
    const act = { kind: 'take', position: 'flight_director', reason: 'no answer on the loop' };
    expect(posted()).toEqual([['/runs/1/positions', { ...said_, ...act }]]);
    access.value = { state: 'in', user: 'Cy', role: 'controller', rights: ['watch', 'command'] };
    expect([offeredOf(away), offeredOf(aSeat('flight_director'))]).toEqual([[], []]);
    expect(offeredOf(aSeat('gnc'))).toEqual(['take']);
  });
  it('stands in for what is vacant in procedures, and nobody else does', async () => {
    await shows(aBoard(seats));
    uplink.value = { ...AT_ONCE, controller: 'Dee' };
    expect(myPositions.value).toEqual(['flight_director', 'gnc']);
    uplink.value = { ...AT_ONCE, controller: 'Ben' };
    expect(myPositions.value).toEqual(['command']);
  });
  it('decides against what speaks against a go now, not when the question was opened', async () => {
    const director = aSeat('flight_director', 'Ann', { acts: ['poll', 'go', 'no_go'] });
    const room = (against: string) => aBoard([director, aSeat('gnc', 'Ben')], { poll: aPoll({ against }) });
    await shows(room('GNC has not answered'));
    await click('go: Flight director');
    expect(ask()?.textContent).toContain('Go, against “GNC has not answered”');
    const collector = new ColumnCollector();
    collector.add(
      aBatch([
        positionAct({ seats: [] }),
        positionAct({
          seats: [{ position: 'flight_director', by: 'Ann', acts: [PositionAct_Kind.go] }],
          poll: { subject: 'do EDL', by: 'Ann', against: 'GNC said no go' },
        }),
      ]),
    );
    await settled(async () => {
      store.value?.add(collector.take());
      tick.value += 1;
    });
    expect(ask()?.textContent).toContain('Go, against “GNC said no go”');
  });
});

describe('the poll', () => {
  const director = aSeat('flight_director', 'Ann', { acts: ['offer', 'leave', 'poll', 'go', 'no_go'] });
  const gnc = aSeat('gnc', 'Ben', { acts: ['offer', 'leave', 'go', 'no_go'] });
  const three = [director, gnc, aSeat('command', 'Cy'), aSeat('systems', 'Eli')];
  const decision = () => root.querySelector('[data-testid="room-decision"]')?.textContent;

  it('is called by the flight director, about a subject', async () => {
    await shows(aBoard([{ ...director, acts: ['poll'] }], { closed: 'no poll has been called' }));
    expect(words()).toContain('▲ Commanding is closed: no poll has been called');
    await click('call a poll: Flight director');
    expect([ask()?.textContent, submit()?.disabled]).toEqual([expect.stringContaining('about what?'), true]);
    takes(aBoard([director], { poll: aPoll() }));
    await answer('do EDL');
    expect(posted().at(-1)?.[1]).toEqual({ ...said_, kind: 'poll', position: 'flight_director', subject: 'do EDL' });
  });
  it('shows who called it about what, and each answer by a sign and a word', async () => {
    const answers = [said('gnc', 'Old', false, 'no fix'), said('command', 'Cy', true), anAnswer('systems', 'Eli')];
    await shows(aBoard(three, { poll: aPoll({ answers, against: 'GNC has said no go' }) }));
    expect(decision()).toBe('□ polling');
    expect(words()).toContain('do EDL poll called by Ann, E−2:10');
    expect(words()).toContain('against a go: GNC has said no go');
    expect([seatWords('gnc'), seatWords('command'), seatWords('systems')]).toEqual([
      expect.stringContaining('✕ no go Old, E−1:50: “no fix”'), // by whoever held it then
      expect.stringContaining('✓ go E−1:50'),
      expect.stringContaining('□ not answered'),
    ]);
    expect(seat('flight_director')?.querySelector('[data-answer]')).toBeNull();
  });
  it.each([
    [true, '✓ GO'],
    [false, '✕ NO GO'],
  ])(
    'shows the flight director’s decision, %s, in large words, and what it went against with its reason',
    async (go, word) => {
      const poll = aPoll({
        answers: [said('gnc', 'Ben', false)],
        decision: said('flight_director', 'Ann', go, 'one fix is enough'),
        overridden: go ? 'GNC has said no go' : '',
      });
      await shows(aBoard(three, { poll }));
      expect(decision()).toBe(word);
      expect(words()).toContain('decided by Ann, E−1:50: “one fix is enough”');
      expect(words().includes('▲ overridden: GNC has said no go')).toBe(go);
    },
  );
  it('is answered go at once, no go with a reason or without', async () => {
    uplink.value = { ...AT_ONCE, controller: 'Ben' };
    const open = aBoard(three, { poll: aPoll({ answers: [anAnswer('gnc', 'Ben')] }) });
    await shows(open);
    expect(button('go: GNC')?.hasAttribute('data-first')).toBe(true);
    takes(aBoard(three, { poll: aPoll({ answers: [said('gnc', 'Ben', true)] }) }));
    await click('go: GNC');
    await vi.waitFor(() => expect(seatWords('gnc')).toContain('✓ go'));
    await click('no go: GNC');
    expect(submit()?.disabled).toBe(false);
    takes(open, 3);
    await answer('');
    const by = { ...said_, by: 'Ben', position: 'gnc' };
    expect(posted().map(([, body]) => body)).toEqual([
      { ...by, kind: 'go', subject: 'do EDL' },
      { ...by, kind: 'no_go', subject: 'do EDL' },
    ]);
  });
  it('is decided go at once when nothing speaks against it, else for a reason alone', async () => {
    const against = 'GNC has not answered';
    await shows(aBoard(three, { poll: aPoll({ answers: [anAnswer('gnc', 'Ben')], against }) }));
    expect(button('go: Flight director')?.hasAttribute('data-first')).toBe(false);
    await click('go: Flight director');
    expect([posted(), ask()?.textContent, submit()?.disabled]).toEqual([
      [],
      expect.stringContaining('Go, against “GNC has not answered”: why?'),
      true,
    ]);
    takes(aBoard(three, { poll: aPoll({ answers: [said('gnc', 'Ben', true)] }) }));
    await answer('heard on the loop');
    await vi.waitFor(() => expect(ask()).toBeNull());
    await click('go: Flight director');
    const by = { ...said_, kind: 'go', position: 'flight_director', subject: 'do EDL' };
    expect(posted().map(([, body]) => body)).toEqual([{ ...by, reason: 'heard on the loop' }, by]);
  });
  it('is refused in the server’s own sentence, and what was typed stays', async () => {
    await shows(aBoard([gnc], { poll: aPoll() }));
    uplink.value = { ...AT_ONCE, controller: 'Ben' };
    await settled(async () => undefined);
    server.routes['POST /runs/1/positions'] = { status: 409, json: { error: 'no poll is open' } };
    await click('no go: GNC');
    await answer('no fix');
    await vi.waitFor(() => expect(words()).toContain('✖ no go of gnc: not done: no poll is open'));
    expect(ask()?.querySelector('input')?.value).toBe('no fix');
    await settled(async () => {
      ask()?.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
    });
    expect([ask(), posted().length]).toEqual([null, 1]);
  });
});

describe('the stream', () => {
  const wire = {
    seats: [{ position: 'gnc', by: 'Ben', sinceUs: ertUs('2012-219T04:59:00.0'), acts: [PositionAct_Kind.take] }],
    closed: 'nobody holds command',
    directed: true,
  };
  const heard = aBoard([aSeat('gnc', 'Ben', { acts: ['take'] })], { closed: 'nobody holds command' });

  it('brings the newest act alone, whose room is as the server answers it; nothing is asked for again', async () => {
    await shows(aBoard([aSeat('gnc')]));
    const acts = [positionAct({ seats: [] }), positionAct(wire)];
    const collector = new ColumnCollector();
    collector.add(aBatch(acts));
    const taken = collector.take();
    expect(taken.facts.map(({ kind, seq }) => [kind, seq])).toEqual([['positionAct', Number(acts[1]?.seq)]]);
    expect(collector.take().facts).toEqual([]);
    const before = server.asked.length;
    await settled(async () => {
      store.value?.add(taken);
      tick.value += 1;
    });
    expect(board.value).toEqual(heard);
    expect(seatWords('gnc')).toContain('GNCBen');
    expect(server.asked.length).toBe(before);
  });
  it('is not put back by an older answer', async () => {
    useForTest(aStore([positionAct(wire)]), aDictionary);
    await shows(aBoard([aSeat('gnc', 'Old')]), 1);
    expect(board.value).toEqual(heard);
  });
  it('of another run leaves nothing of this one', async () => {
    await shows(heard);
    server.routes['GET /runs/2/positions'] = { status: 404, json: { error: 'no such route' } };
    useForTest(aStore([], aRun({ run: 2n })), aDictionary);
    expect(board.value).toBeUndefined();
    await refreshPositions();
    await settled(async () => undefined);
    expect(words()).toBe('');
  });
});

describe('in the past and afterwards', () => {
  it('the room of that instant is asked for, nothing can be done, and nothing later is shown', async () => {
    useForTest(aStore([positionAct({ seats: [{ position: 'gnc', by: 'Later' }] })]), aDictionary);
    await shows(aBoard([aSeat('gnc', 'Ann')]));
    lookAtPast({ from: -300, to: -150 }, false);
    expect(board.value).toBeUndefined();
    server.routes['GET /runs/1/positions?at=850'] = { json: aRoom(aBoard([aSeat('gnc', 'Ann'), aSeat('command')])) };
    await vi.waitFor(async () => {
      await settled(async () => void (await refreshPositions()));
      expect(seatWords('gnc')).toBe('GNCAnn since E−2:40');
    });
    expect(offers()).toEqual([]);
  });
  it('what can be done is gone as soon as the run has ended', async () => {
    await shows(aBoard([aSeat('gnc', 'Ann')]));
    await click('offer: GNC');
    await settled(async () => {
      store.value?.update(aRun({ state: 'finished' }));
      tick.value += 1;
    });
    expect([offers(), ask()]).toEqual([[], null]);
  });
});

describe('a seat and procedures', () => {
  it('the seat is the person’s position; their own choice holds while they hold none', async () => {
    choosePosition('systems');
    const seats = [aSeat('command', 'Ben'), aSeat('gnc', 'Ann'), aSeat('navigation', 'Ben')];
    await shows(aBoard(seats));
    const of = (name: string) => {
      uplink.value = { ...AT_ONCE, controller: name };
      return position.value;
    };
    expect([of('Ann'), of('Ben'), of('Cy'), of('')]).toEqual(['gnc', 'command', 'systems', 'systems']);
    choosePosition('navigation'); // one of several seats
    expect([of('Ann'), of('Ben')]).toEqual(['gnc', 'navigation']);
    access.value = { state: 'in', user: 'Ann', role: 'controller', rights: [] };
    expect(position.value).toBe('gnc');
  });
  it('the panel has the room above the procedures, and says the seat instead of asking for a position', async () => {
    access.value = { state: 'in', user: 'Ann', role: 'controller', rights: [] };
    server.routes['GET /procedures'] = { json: { procedures: [], positions: ['command', 'gnc'] } };
    const one = anExecution({ steps: [aStep('poll', { state: 'active', acts: ['tick'] })] });
    server.routes['GET /runs/1/procedures'] = { json: { procedures: [inItem(one)] } };
    server.routes['GET /runs/1/positions'] = { json: aRoom(aBoard([aSeat('gnc', 'Ann')])) };
    settled(() => render(<Procedures />, root));
    await vi.waitFor(() => {
      settled(() => undefined);
      expect(root.querySelector('[data-testid="position-held"]')?.textContent).toBe('I am GNC');
    });
    expect(root.querySelector('[data-testid="position"]')).toBeNull();
    const [room, tools] = ['[data-testid="room"]', '.table-tools'].map((each) => root.querySelector(each)!);
    expect(room!.compareDocumentPosition(tools!)).toBe(Node.DOCUMENT_POSITION_FOLLOWING);
    server.routes['POST /runs/1/procedures/1/acts'] = { status: 201, json: inItem(one, 2) };
    await click('tick step poll');
    expect(posted()).toEqual([
      ['/runs/1/procedures/1/acts', expect.objectContaining({ kind: 'tick', position: 'gnc', by: 'Ann' })],
    ]);
  });
});

describe('the command panel', () => {
  const closed = () => root.querySelector('[data-testid="commanding-closed"]')?.textContent;
  it('says why the room lets nothing leave before anything is armed, and nothing once it may', async () => {
    onMessage({ type: 'stream', state: 'connecting', attempt: 0, gaps: 0, serverVersion: '' });
    useForTest(aStore([positionAct({ closed: 'the flight director has not said go' })]), aDictionary);
    settled(() => render(<Commands />, root));
    expect(closed()).toBe('▲ Commanding is closed: the flight director has not said go');
    const collector = new ColumnCollector();
    collector.add(aBatch([positionAct({ closed: '' })]));
    await settled(async () => {
      store.value?.add(collector.take());
      tick.value += 1;
    });
    expect(closed()).toBeUndefined();
  });
  it('says who sends where another holds command', () => {
    onMessage({ type: 'stream', state: 'connecting', attempt: 0, gaps: 0, serverVersion: '' });
    useForTest(aStore([positionAct({ seats: [{ position: 'command', by: 'Ben' }] })]), aDictionary);
    settled(() => render(<Commands />, root));
    expect(closed()).toBe('▲ Commands are sent by another: command is held by Ben');
    settled(() => {
      uplink.value = { ...AT_ONCE, controller: ' Ben ' };
    });
    expect(closed()).toBeUndefined();
  });
  it('of a run in which nobody has taken a position says nothing', () => {
    settled(() => render(<Commands />, root));
    expect(closed()).toBeUndefined();
  });
});

it('on a telephone each row of the room wraps, and none is wider than the panel or cuts off what is in it', () => {
  const rule = (selector: string) =>
    [...css.replace(/\/\*[^]*?\*\//g, '').matchAll(/([^{}]+)\{([^}]*)\}/g)]
      .filter(([, selectors]) => selectors?.split(',').some((each) => each.trim() === selector))
      .map(([, , body]) => body)
      .join('');
  for (const row of ['.room-head', '.room-poll', '.seat']) expect(rule(row)).toContain('flex-wrap: wrap');
  expect(rule('.seats')).toContain('minmax(min(100%, 230px), 1fr)');
  expect(css).not.toMatch(/overflow: (hidden|clip)|(?<![\w-])(min-)?width: [1-9]/);
});

describe('the banner', () => {
  const heard = (seats: Board['seats'], fields: Partial<Board> = {}) => {
    const run = aStore();
    run.positions = { seq: 3, board: aBoard(seats, fields) };
    useForTest(run, aDictionary);
    settled(() => render(<AskedHere />, root));
    return words();
  };
  const seats = [aSeat('flight_director', 'Ben'), aSeat('command', 'Ann')];
  const polled = (...answers: Answer[]) => ({
    poll: aPoll({ by: 'Ben', answers }),
  });
  it('asks the position that has not answered a poll, and nobody else', () => {
    const asked = '▷ Command, go or no go: “do EDL”?answer 8';
    expect(heard(seats, polled(anAnswer('command', 'Ann')))).toBe(asked);
    expect(heard(seats, polled(said('command', 'Ann', true))), 'it has answered').toBe('');
    expect(heard(seats, polled(anAnswer('gnc', 'Carl'))), 'another is asked').toBe('');
    const decided = {
      poll: { ...polled(anAnswer('command', 'Ann')).poll, decision: said('flight_director', 'Ben', true) },
    };
    expect(heard(seats, decided), 'it is decided').toBe('');
    pastRange.value = { from: 0, to: 10 };
    expect(heard(seats, polled(anAnswer('command', 'Ann'))), 'nothing can be said in a past view').toBe('');
  });
  it('asks the flight director once all have answered', () => {
    uplink.value = { ...AT_ONCE, controller: 'Ben' };
    expect(heard(seats, polled(anAnswer('command', 'Ann')))).toBe('');
    expect(heard(seats, polled(said('command', 'Ann', false)))).toBe(
      '▷ Flight director, all have answered: “do EDL”?answer 8',
    );
  });
  it('tells of a position that is offered, to the one to whom it is', () => {
    expect(heard([aSeat('gnc', 'Ben', { offered_to: 'Ann' })])).toBe('▷ Ben offers you GNCanswer 8');
    expect(heard([aSeat('gnc', 'Ben', { offered_to: 'Carl' })])).toBe('');
  });
});
