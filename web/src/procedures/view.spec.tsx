// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act as settled } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { access } from '../access/model';
import { back, forward, line, otherwise, purposeNow, step as lineStep, tryOut, type, uplink } from '../commands/line';
import { AT_ONCE } from '../commands/model';
import { ProcedureAct_Kind, ProcedureStatusSchema, ProcedureStep_State } from '../gen/aeolis/v1/procedures_pb';
import { CommandReplySchema } from '../gen/aeolis/v1/run_pb';
import { stream } from '../run/connection';
import { onMessage, useForTest } from '../run/session';
import { lookAtPast, pastRange, store, tick } from '../run/shown';
import type { ToWorker } from '../stream/messages';
import { ColumnCollector } from '../stream/columns';
import { aBatch, aDictionary, aRun, aStore, item, stage } from '../testing/fixtures';
import { aStep, aWatchdog, anExecution, inItem, us } from '../testing/procedures';
import { aServer } from '../testing/server';
import { act, executions, library, lookOf, offered, offeredOfWhole, problem, refreshProcedures } from './model';
import type { Execution } from './model';
import { byWords, choosePosition, position, positionWords } from './position';
import { show, shownNow } from './shown';
import { untied, wanting } from './step';
import { UnderWay } from './under_way';
import { Procedures } from './view';

const server = aServer();
const POSITIONS = ['flight_director', 'command', 'gnc'];
const ENTRY = {
  procedure: 'poll',
  title: 'A poll',
  purpose: 'To know.',
  begin_when: 'Somebody asks.',
  revision: 2,
  approvals: [],
  findings: [],
};
let root: HTMLElement;

const answers = (...all: Execution[]) => {
  server.routes['GET /runs/1/procedures'] = { json: { procedures: all.map((one) => inItem(one)) } };
};
const words = () => root.textContent?.replace(/\s+/g, ' ') ?? '';
const button = (label: string) =>
  [...root.querySelectorAll('button')].find(
    (each) => each.textContent?.trim() === label || each.getAttribute('aria-label') === label,
  );
const posted = () => server.asked.filter(({ method }) => method === 'POST').map(({ path, body }) => [path, body]);
/** Shows the panel with what the server answers. */
async function shows(what = <Procedures />, testId = 'procedures'): Promise<void> {
  settled(() => render(what, root));
  await vi.waitFor(() => {
    settled(() => undefined);
    expect(root.querySelector(`[data-testid="${testId}"]`)).not.toBeNull();
  });
}
const click = (label: string) => settled(async () => void button(label)?.click());

beforeEach(() => {
  localStorage.clear();
  choosePosition('');
  [library.value, problem.value, lineStep.value] = [undefined, '', 'type'];
  access.value = { state: 'open' };
  uplink.value = { ...AT_ONCE, controller: 'Ann' };
  pastRange.value = undefined;
  useForTest(aStore(), aDictionary);
  server.routes['GET /procedures'] = { json: { procedures: [ENTRY], positions: POSITIONS } };
  answers();
  root = document.body.appendChild(document.createElement('div'));
});
afterEach(() => {
  settled(() => render(null, root));
  root.remove();
  useForTest(undefined, undefined);
  stream.value = { ...stream.value, state: 'live' };
});

describe('the library', () => {
  it('is shown while nothing is under way; one is begun by a person with a name and a position, which the browser keeps', async () => {
    uplink.value = AT_ONCE;
    await shows();
    expect(words()).toContain('A pollrevision 2, a draft');
    expect(words()).toContain('choose your position first');
    expect(button('begin A poll')?.disabled).toBe(true);
    const select = root.querySelector<HTMLSelectElement>('[data-testid="position"]')!;
    select.value = 'gnc';
    await settled(async () => void select.dispatchEvent(new Event('change', { bubbles: true })));
    expect(localStorage.getItem('aeolis-position')).toBe('gnc');
    expect(words()).toContain('type your name first');
    await settled(async () => {
      uplink.value = { ...AT_ONCE, controller: 'Ann' };
    });
    const begun = anExecution({ number: 4, title: 'A poll that runs' });
    server.routes['POST /runs/1/procedures'] = { status: 201, json: inItem(begun) };
    await click('begin A poll');
    await vi.waitFor(() => expect(typeof shownNow.value).toBe('object'));
    await shows();
    expect(posted()).toEqual([['/runs/1/procedures', { procedure: 'poll', position: 'gnc', by: 'Ann' }]]);
    expect(words()).toContain('▷ under way#4, revision 1, a draft');
  });
  it('names the first rule that a file breaks, and does not offer to begin it', async () => {
    const broken = { ...ENTRY, findings: ['poll.yaml:3:1: no title', 'poll.yaml:9:1: no who'] };
    server.routes['GET /procedures'] = { json: { procedures: [broken], positions: POSITIONS } };
    await shows();
    expect(words()).toContain('▲ It breaks 2 rules and cannot be begun: poll.yaml:3:1: no title');
    expect(button('begin A poll')).toBeUndefined();
  });
  it('of a server without procedures says that there are none', async () => {
    server.routes['GET /procedures'] = { status: 404, json: { error: 'no such route' } };
    server.routes['GET /runs/1/procedures'] = { status: 404, json: { error: 'no such route' } };
    await shows();
    expect(words()).toContain('This server has no procedures.');
  });
});

describe('a procedure under way', () => {
  it('shows what holds, what does not, and what is not known, each with its evidence', async () => {
    const verdicts = ['holds', 'does_not_hold', 'not_known'] as const;
    const conditions = verdicts.map((verdict) => ({ text: `x ${verdict}`, verdict, evidence: `seen ${verdict}` }));
    answers(anExecution({ steps: [aStep('look', { state: 'active', conditions })] }));
    await shows();
    const lines = [...root.querySelectorAll('[data-verdict]')].map((each) => [
      each.querySelector('[role="img"]')?.getAttribute('aria-label'),
      each.querySelector('small')?.textContent?.trim(),
    ]);
    expect(lines).toEqual([
      ['holds', 'seen holds'],
      ['is missing', 'seen does_not_hold'],
      ['not known', 'seen not_known'],
    ]);
  });
  it('is renewed by the stream, whose status is as the server answers it; nothing is asked for again', async () => {
    const steps = [aStep('poll', { state: 'active', acts: ['tick'] })];
    answers(anExecution({ steps }));
    await shows();
    expect(root.querySelector('[data-step="poll"]')?.getAttribute('data-state')).toBe('active');
    const status = (number: number, state: ProcedureStep_State, by = '') =>
      create(ProcedureStatusSchema, {
        number,
        procedure: 'poll',
        title: `Poll ${number}`,
        revision: 1,
        begunUs: BigInt(us('2012-219T04:50:00.0')),
        begunBy: 'Ann (flight_director)',
        part: 1,
        steps: [{ step: 'poll', part: 1, who: 'gnc', text: 'Do poll.', state, by }],
        acts: [ProcedureAct_Kind.hold, ProcedureAct_Kind.stop],
      });
    const at = '2012-219T05:00:00.0';
    const heard = [
      status(2, ProcedureStep_State.active),
      status(1, ProcedureStep_State.active),
      status(1, ProcedureStep_State.ticked, 'Ben (gnc)'),
    ].map((value) => item({ case: 'procedure', value }, at));
    const collector = new ColumnCollector();
    collector.add(aBatch(heard));
    const { facts } = collector.take();
    expect(facts.map(({ kind, seq, fact }) => [kind, seq, (fact as { number: number }).number])).toEqual([
      ['procedure', Number(heard[0]?.seq), 2],
      ['procedure', Number(heard[2]?.seq), 1], // the older one of the same procedure is left out
    ]);
    collector.add(aBatch(heard));
    const before = server.asked.length;
    store.value?.add(collector.take());
    await refreshProcedures();
    expect(server.asked.length).toBe(before);
    const poll = aStep('poll', { state: 'ticked', by: 'Ben (gnc)' });
    expect(executions.value).toEqual([
      anExecution({ title: 'Poll 1', steps: [poll] }),
      anExecution({ number: 2, title: 'Poll 2', steps: [{ ...poll, state: 'active', by: '' }] }),
    ]);
    // an answer of before does not put the older one back
    server.routes['POST /runs/1/procedures/1/acts'] = { status: 201, json: inItem(anExecution({ steps }), 1) };
    choosePosition('gnc');
    await act(1, { kind: 'tick', step: 'poll' });
    expect(executions.value?.[0]?.steps).toEqual([poll]);
  });
  it('counts a time limit down by the clock of the run, and says by how much a step is late', async () => {
    const limits = 'within 120 s';
    answers(
      anExecution({
        steps: [
          aStep('soon', { state: 'active', limits, limit_us: us('2012-219T05:01:15.0') }),
          aStep('late', { state: 'late', limits, limit_us: us('2012-219T04:59:50.0') }),
          aStep('free', { state: 'active', limits }),
        ],
      }),
    );
    await shows();
    const when = [...root.querySelectorAll('.step-when')].map((each) => each.textContent?.trim());
    expect(when).toEqual(['1 m 15 s left', '▲ late by 10 s', 'now']);
  });
  it('offers each position its acts alone, and says for whom it waits', async () => {
    const steps = [aStep('poll', { state: 'active', acts: ['tick', 'skip'] })];
    answers(anExecution({ steps }));
    for (const [mine, offers] of [
      ['command', ['hold', 'stop'].slice(0, 1)],
      ['gnc', ['hold', 'tick']],
      ['flight_director', ['hold', 'stop', 'tick', 'skip']],
    ] as const) {
      choosePosition(mine);
      await shows();
      const shown = [...root.querySelectorAll<HTMLElement>('[data-act]')].map((each) => each.dataset.act);
      expect(shown, mine).toEqual([...offers]);
    }
    choosePosition('command');
    await shows();
    expect(words()).toContain('waits for GNC');
  });
  it('is ticked at once where its conditions hold, else with a reason that is asked for in place', async () => {
    choosePosition('gnc');
    const step = aStep('poll', { state: 'active', acts: ['tick'] });
    answers(anExecution({ steps: [step, aStep('odd', { state: 'active', acts: ['tick'], reason_wanted: true })] }));
    await shows();
    const done = anExecution({ steps: [{ ...step, state: 'ticked', acts: [], by: 'Ann (gnc)' }] });
    server.routes['POST /runs/1/procedures/1/acts'] = { status: 201, json: inItem(done, 2) };
    await click('tick step odd');
    expect(posted()).toEqual([]);
    const field = root.querySelector<HTMLInputElement>('[data-testid="procedure-reason"] input')!;
    expect(root.querySelector<HTMLButtonElement>('form [type="submit"]')?.disabled).toBe(true);
    field.value = ' seen by eye ';
    await settled(async () => void field.dispatchEvent(new Event('input', { bubbles: true })));
    await settled(async () => void root.querySelector('form')?.dispatchEvent(new Event('submit', { bubbles: true })));
    await vi.waitFor(() => expect(wanting.value).toBeUndefined());
    const said = { position: 'gnc', by: 'Ann' };
    expect(posted()).toEqual([
      ['/runs/1/procedures/1/acts', { ...said, kind: 'tick', step: 'odd', reason: 'seen by eye' }],
    ]);
    await shows();
    expect(root.querySelector('[data-step="poll"]')?.getAttribute('data-state')).toBe('ticked');
  });
  it('keeps the words of a refusal, and what was typed', async () => {
    choosePosition('flight_director');
    answers(anExecution());
    await shows();
    server.routes['POST /runs/1/procedures/1/acts'] = { status: 409, json: { error: 'the procedure is over' } };
    expect(await act(1, { kind: 'hold', reason: 'wait' })).toBe(false);
    expect(problem.value).toBe('hold: not done: the procedure is over');
  });
  it('whose watchdog tripped says so first, with what to begin', async () => {
    choosePosition('systems');
    const dog = aWatchdog('restarted', {
      tripped_us: us('2012-219T04:59:00.0'),
      acts: ['acknowledge'],
      begin: 'computer_reset',
    });
    const one = anExecution({ watchdogs: [aWatchdog('other'), dog] });
    answers(one);
    await shows();
    expect(lookOf(one)).toMatchObject({ shape: '▲', word: 'watchdog restarted' });
    expect(root.querySelector('[aria-label="watchdogs that tripped"]')?.textContent).toMatch(/restarted.*acknowledge/);
    expect([button('acknowledge watchdog restarted'), button('begin computer reset')].map(Boolean)).toEqual([
      true,
      true,
    ]);
  });
  it('is grey without a connection, and says so', async () => {
    answers(anExecution());
    await shows();
    await settled(async () => {
      stream.value = { ...stream.value, state: 'lost' };
    });
    expect(root.querySelector('.is-old')).not.toBeNull();
    expect(words()).toContain('◌ Not connected: as they stood');
  });
  it('stands beside the timeline with its step, who is awaited, and the time left', async () => {
    answers(
      anExecution({
        steps: [
          aStep('sign_it', {
            state: 'active',
            acts: ['sign'],
            signatures_wanted: ['gnc', 'systems'],
            signatures: [{ position: 'gnc', by: 'Ann', at_us: us('2012-219T04:59:00.0') }],
            limit_us: us('2012-219T05:00:30.0'),
          }),
          aStep('other', { state: 'active' }),
        ],
      }),
    );
    await shows(<UnderWay />, 'under-way');
    expect(words()).toBe('Procedures 8▷ A poll30 s leftsign it: Systems +1 more');
  });
});

describe('the command of a step', () => {
  const command = {
    name: 'EDL_SET_PARAMETERS',
    arguments: [{ name: 'parachute_speed_mps', value: 400, text: '400' }],
    to_fill: ['solution_id'],
    from_solution: false,
    until: 'executed',
    command: '0',
    evidence: '',
  };
  const since_us = us('2012-219T04:59:00.0');
  const step = aStep('send', { who: 'command', state: 'active', acts: ['sent'], since_us, command });

  const heard: Extract<ToWorker, { type: 'command' }>[] = [];
  /** A ground that takes each command, as number 7. */
  const ground = (message: ToWorker) => {
    if (message.type !== 'command') return;
    heard.push(message);
    const request = BigInt(message.request);
    queueMicrotask(() =>
      onMessage({ type: 'reply', reply: create(CommandReplySchema, { request, accepted: true, command: 7n }) }),
    );
  };
  it('goes into the command line, is reviewed and sent as any other, and its number is told to the step once', async () => {
    choosePosition('command');
    useForTest(aStore(), aDictionary, ground);
    answers(anExecution({ steps: [step] }));
    const input = document.createElement('input');
    input.dataset.testid = 'command-line';
    root.before(input);
    await shows();
    await click('send the command of step send');
    input.remove();
    expect([line.value, lineStep.value, purposeNow.value?.words, otherwise.value]).toEqual([
      'edl_set_parameters parachute_speed_mps=400',
      'review',
      'step send of A poll',
      [],
    ]);
    expect(posted()).toEqual([]);
    type('edl_set_parameters parachute_speed_mps=410 solution_id=3');
    await forward();
    expect([purposeNow.value?.words, otherwise.value]).toEqual(['step send of A poll', ['parachute_speed_mps']]);
    await tryOut();
    server.routes['POST /runs/1/procedures/1/acts'] = { status: 201, json: inItem(anExecution({ steps: [step] }), 2) };
    await forward();
    expect(heard.at(-1)?.intent.dryRun).toBeUndefined();
    await vi.waitFor(() => expect(posted()).toHaveLength(1));
    const said = { position: 'command', by: 'Ann', reason: '' };
    expect(posted()).toEqual([['/runs/1/procedures/1/acts', { ...said, kind: 'sent', step: 'send', command: '7' }]]);

    type('edl_set_parameters solution_id=4'); // the next one is for no step
    await forward();
    expect(purposeNow.value).toBeUndefined();
    back(true);
    type('');
  });
  it('that left while its step could not be told of it is tied by hand', async () => {
    choosePosition('command');
    useForTest(aStore([stage({ command: 7n, name: command.name, ert: '2012-219T04:59:30.0' })]), aDictionary);
    answers(anExecution({ steps: [step] }));
    await shows();
    server.routes['POST /runs/1/procedures/1/acts'] = { status: 201, json: inItem(anExecution({ steps: [step] }), 2) };
    await click('it was sent as #7');
    expect(posted().map(([, body]) => (body as { command: string }).command)).toEqual(['7']);
  });
  it('that was sent is sent again for a reason alone, which is asked for before the command line has it', async () => {
    choosePosition('command');
    const sent = { ...step, command: { ...command, command: '7', evidence: 'received unknown: no word of it' } };
    answers(anExecution({ steps: [sent] }));
    const input = document.createElement('input');
    input.dataset.testid = 'command-line';
    root.before(input);
    await shows();
    expect(root.querySelector('[data-act="sent"]')?.hasAttribute('data-first')).toBe(false);
    await click('send the command of step send again');
    expect([lineStep.value, root.querySelector('[data-testid="procedure-reason"]')?.textContent]).toEqual([
      'type',
      expect.stringContaining('send again: why?'),
    ]);
    const field = root.querySelector<HTMLInputElement>('[data-testid="procedure-reason"] input')!;
    field.value = 'no word of it';
    await settled(async () => void field.dispatchEvent(new Event('input', { bubbles: true })));
    await settled(async () => void root.querySelector('form')?.dispatchEvent(new Event('submit', { bubbles: true })));
    expect([lineStep.value, purposeNow.value?.command, wanting.value, posted()]).toEqual([
      'review',
      'EDL_SET_PARAMETERS',
      undefined,
      [],
    ]);
    input.remove();
    back(true);
    type('');
  });
  it('is offered by its number where it was sent without the step, unless a step has it', () => {
    const at = (command_: number, name: string, ert: string) => stage({ command: BigInt(command_), name, ert });
    const run = aStore([
      at(1, 'EDL_SET_PARAMETERS', '2012-219T04:58:00.0'),
      at(2, 'EDL_SET_PARAMETERS', '2012-219T04:59:30.0'),
      at(3, 'NO_OP', '2012-219T04:59:30.0'),
      at(4, 'EDL_SET_PARAMETERS', '2012-219T04:59:40.0'),
    ]);
    const other = anExecution({ number: 2, steps: [{ ...step, command: { ...command, command: '4' } }] });
    expect(untied(run, step, [anExecution({ steps: [step] }), other])).toEqual([2]);
  });
});

describe('in the past and afterwards', () => {
  it('the statuses of that instant are asked for and nothing can be done; no later status is shown', async () => {
    choosePosition('flight_director');
    answers(anExecution({ steps: [aStep('poll', { state: 'ticked' })], part: 'confirmed', over: true }));
    await shows();
    lookAtPast({ from: -300, to: -150 }, false);
    expect(executions.value).toBeUndefined();
    server.routes['GET /runs/1/procedures?at=850'] = {
      json: { procedures: [inItem(anExecution({ steps: [aStep('poll', { state: 'active', acts: ['tick'] })] }))] },
    };
    await refreshProcedures();
    await shows();
    expect(words()).toContain('As they stood then; nothing can be done in the past.');
    expect([root.querySelector('[data-state="active"]') !== null, root.querySelectorAll('[data-act]').length]).toEqual([
      true,
      0,
    ]);
  });
  it('what can be done is gone as soon as the run has ended', async () => {
    choosePosition('gnc');
    answers(anExecution({ steps: [aStep('poll', { state: 'active', acts: ['tick'] })] }));
    await shows();
    expect(root.querySelectorAll('[data-act="tick"]')).toHaveLength(1);
    await settled(async () => {
      store.value?.update(aRun({ state: 'finished' }));
      tick.value += 1;
    });
    expect(root.querySelectorAll('[data-act]')).toHaveLength(0);
  });
  it('what was under way when the run ended says so; those that are over have a list', async () => {
    choosePosition('flight_director');
    useForTest(aStore([], aRun({ state: 'finished' })), aDictionary);
    answers(
      anExecution({ number: 1, part: 'stopped', over: true, title: 'First' }),
      anExecution({ number: 2, title: 'Second', steps: [aStep('poll', { state: 'active' })] }),
    );
    await shows(<UnderWay />, 'none').catch(() => undefined);
    expect(root.querySelector('[data-testid="under-way"]')).toBeNull();
    await shows();
    expect(words()).toMatch(/it was under way when the run ended.*pollGNCnot done when the run ended/);
    expect(root.querySelectorAll('[data-act]')).toHaveLength(0);
    await click('1 over');
    expect(words()).toContain('✖ stoppedFirst #1');
    show(1);
    expect(typeof shownNow.value === 'object' && shownNow.value.title).toBe('First');
  });
});

it('what holds a procedure is released by whoever holds it, or by the flight director', () => {
  const one = anExecution({ held: 'Ann (gnc): wait', acts: ['release', 'stop'] });
  uplink.value = { ...AT_ONCE, controller: 'Ann' };
  expect(offeredOfWhole(one, 'systems')).toEqual(['release']);
  uplink.value = { ...AT_ONCE, controller: 'An' };
  expect(offeredOfWhole(one, 'systems')).toEqual([]);
  expect(offeredOfWhole(one, 'flight_director')).toEqual(['release', 'stop']);
});
it('a position is written in words; a name and a reason stay as they were written', () => {
  expect(byWords('a_ng (flight_director)')).toBe('a_ng (flight director)');
  expect(byWords('A. Ng (gnc): wait for edl_phase (see edl_log)')).toBe(
    'A. Ng (GNC): wait for edl_phase (see edl_log)',
  );
  expect(byWords('Ann (on_call) (edl_communications)')).toBe('Ann (on_call) (EDL communications)');
  expect(byWords('watchdog tones_too')).toBe('watchdog tones too');
  expect(positionWords('edl_communications')).toBe('EDL communications');
});
it('an act is offered to whom it belongs, and the director in his place', () => {
  const acts = ['tick', 'sign', 'skip', 'sent', 'release'] as const;
  const step = aStep('poll', { who: 'command', hold: 'gnc', signatures_wanted: ['systems'] });
  expect(offered(acts, step, 'flight_director')).toEqual(['skip', 'release']); // signatures do it, no tick
  expect(offered(acts, { ...step, reason_wanted: true }, 'flight_director')).toEqual(['tick', 'skip', 'release']);
  expect(offered(acts, { ...step, signatures_wanted: [] }, 'command')).toEqual(['tick', 'sent']);
  expect(offered(acts, step, 'gnc')).toEqual(['release']);
  expect(offered(acts, step, 'systems')).toEqual(['sign']);
  expect(position.value).toBe('');
});
