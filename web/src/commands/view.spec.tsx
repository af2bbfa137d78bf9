// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it } from 'vitest';
import { backToLive, onMessage, useForTest } from '../run/session';
import { dismissNotice, lookAtPast, notices } from '../run/shown';
import { CommandStage_Stage, CommandStage_Status } from '../gen/aeolis/v1/items_pb';
import { CommandReplySchema, DictionaryArgumentSchema } from '../gen/aeolis/v1/run_pb';
import type { ToWorker } from '../stream/messages';
import { aDictionary, aRun, aStore, ertUs, samples, stage } from '../testing/fixtures';
import { aServer } from '../testing/server';
import {
  act as actOn,
  back,
  chosen,
  complete,
  confirmation,
  forward,
  line,
  message,
  previewNow,
  step,
  tryOut,
  type,
} from './line';
import {
  AT_ONCE,
  STAGES,
  STATUSES,
  argumentOffers,
  arrivalOf,
  candidates,
  conditionWords,
  reasonWords,
  fieldsOf,
  intentOf,
  isHazardous,
  readLine,
  readReleaseAt,
  stageCells,
  unitText,
  waitingCommands,
} from './model';
import { readBackOf } from './read_back';
import { Commands } from './view';

const set = aDictionary.command('EDL_SET_PARAMETERS');
const doEdl = aDictionary.command('EDL_DO_EDL');
if (!set || !doEdl) throw new Error('the fixture lacks its commands');

it('the words of stages and their status are those of the schema, by its numbers', () => {
  expect(STAGES.map((each) => CommandStage_Stage[each])).toEqual([...STAGES.keys()]);
  expect(STATUSES.map((each) => CommandStage_Status[each])).toEqual([...STATUSES.keys()]);
});

describe('what is typed', () => {
  it('finds a command by its words', () => {
    expect(candidates(aDictionary, ['do', 'edl'])[0]?.name).toBe('EDL_DO_EDL');
    expect(candidates(aDictionary, ['set', 'edl', 'parameters'])[0]?.name).toBe('EDL_SET_PARAMETERS');
    expect(candidates(aDictionary, ['edl_set_par'])[0]?.name).toBe('EDL_SET_PARAMETERS');
    expect(candidates(aDictionary, ['“do', 'edl"'])[0]?.name, 'with its quotes').toBe('EDL_DO_EDL');
    expect(candidates(aDictionary, ['launch'])).toEqual([]);
  });
  it('reads arguments beside the words', () => {
    const { words, given } = readLine(' edl_set_timepoint_offset  timepoint=3 ');
    expect([words, [...given]]).toEqual([['edl_set_timepoint_offset'], [['timepoint', '3']]]);
  });
  it('once it is a whole command offers its arguments, and what is no argument is called by its name', () => {
    expect(argumentOffers(aDictionary, 'edl_set_par')).toBeUndefined();
    expect(argumentOffers(aDictionary, 'edl_set_parameters ')?.offers).toEqual([
      'solution_id=',
      'parachute_speed_mps=',
    ]);
    expect(argumentOffers(aDictionary, 'edl_set_parameters solution_id=3 para')).toMatchObject({
      offers: ['parachute_speed_mps='],
      strays: ['para'],
    });
    expect(argumentOffers(aDictionary, 'edl_set_parameters solution_id=3 ')?.offers).toEqual(['parachute_speed_mps=']);
  });
  it('refuses what is out of range, no number, or missing', () => {
    const problems = (text: string) => fieldsOf(set, readLine(text).given, []).map((field) => field.problem);
    expect(problems('x solution_id=3 parachute_speed_mps=500')).toEqual([undefined, 'must be at most 430']);
    expect(problems('x solution_id=1.5')).toEqual(['must be a whole number', undefined]);
    expect(problems('x solution_id=abc')).toEqual(['is not a number', undefined]);
    expect(problems('x')).toEqual(['is needed', undefined]);
    expect(problems('x solution_id=0x10')).toEqual(['is not a number', undefined]);
  });
  it('fills from the navigation solution only the command that it fits', () => {
    const solution = [
      { $typeName: 'aeolis.v1.CommandArgument' as const, name: 'solution_id', value: 9 },
      { $typeName: 'aeolis.v1.CommandArgument' as const, name: 'parachute_speed_mps', value: 405 },
    ];
    expect(fieldsOf(set, new Map(), solution).map((field) => [field.from, field.value])).toEqual([
      ['solution', 9],
      ['solution', 405],
    ]);
  });
});

it('a number without a unit has none beside its range, where the dictionary’s 1 would be read as a number', () => {
  const unit = (of: string) => unitText(create(DictionaryArgumentSchema, { unit: of }));
  expect([unit('1'), unit('m/s'), unit('')]).toEqual(['', 'm/s', '']);
});

describe('stages', () => {
  it('shows nothing green that was not heard of', () => {
    const row = aStore([
      stage({ command: 1n, name: 'NO_OP', stage: 'queued', status: 'ok' }),
      stage({ command: 1n, stage: 'received', status: 'unknown' }),
    ]).commands.get(1);
    const looks = Object.fromEntries((row ? stageCells(row) : []).map((cell) => [cell.stage, cell.look]));
    expect(looks).toMatchObject({ queued: 'ok', received: 'unknown', accepted: 'none', verified: 'none' });
  });
});

describe('what is asked of the uplink', () => {
  const whole = fieldsOf(set, readLine('x solution_id=3').given, []);
  it('is the command with its time, hold and priority, and only what was typed of its arguments', () => {
    expect(
      intentOf(
        set,
        whole,
        { service: 'BD', releaseAt: '2012-219T05:10:00', hold: true, priority: '7', controller: ' Ann ' },
        aStore(),
      ),
    ).toEqual({
      command: 'EDL_SET_PARAMETERS',
      arguments: [{ name: 'solution_id', value: 3 }],
      fromSolution: false,
      service: 'BD',
      releaseAt: '2012-219T05:10:00',
      hold: true,
      priority: 7,
      controller: 'Ann',
    });
  });
  it('names what cannot be read, and then there is nothing to send', () => {
    expect(intentOf(set, whole, { ...AT_ONCE, releaseAt: 'noon' }, aStore())).toEqual({
      problem: expect.stringContaining('“noon” is no time'),
    });
    expect(intentOf(set, whole, { ...AT_ONCE, priority: '-1' }, aStore())).toEqual({
      problem: expect.stringContaining('no priority'),
    });
    expect(intentOf(set, fieldsOf(set, new Map(), []), AT_ONCE, aStore())).toEqual({
      problem: 'solution_id is needed',
    });
  });
  it('takes a time to leave as ERT or by the clock on top', () => {
    expect(readReleaseAt('', aStore())).toBe('');
    expect(readReleaseAt('2012-219T05:10:00Z', aStore())).toBe('2012-219T05:10:00');
    expect(readReleaseAt('E-1:30', aStore())).toBe('2012-219T05:00:10.0'); // E-1:40 is 05:00:00
    expect([readReleaseAt('90', aStore()), readReleaseAt('E-1:30', undefined)]).toEqual([undefined, undefined]);
  });
  it('says when it comes, by when it must leave, and what it is too late for', () => {
    const run = aRun({ lightTimeS: 60 });
    if (run.clocks) run.clocks = { ...run.clocks, sclk: 160, eS: -840, seenSclk: 100 };
    // Now is 05:00:00: SCLK 100 is received, sent at SCET 04:59:00. A command that leaves now arrives at SCLK 220,
    // which is E-780.
    const told = {
      leavesUs: ertUs('2012-219T05:00:00.000'),
      arrivesUs: ertUs('2012-219T05:01:00.000'),
      latestUsefulUs: ertUs('2012-219T05:13:00.000'),
      usefulBefore: 'entry_interface',
      tooLateFor: ['coolant_vent'],
    };
    expect(arrivalOf(told, aStore([], run))).toEqual({
      arrives_e_s: -780,
      tooLateFor: ['coolant_vent'],
      before: { name: 'entry_interface', leave_ert: '2012-219T05:13:00.000', slack_s: 780 },
    });
    // A change of an offset that arrives after the timepoint that it moves.
    const late = arrivalOf(
      { ...told, latestUsefulUs: ertUs('2012-219T04:50:00.000'), usefulBefore: 'uhf_start' },
      aStore([], run),
    );
    expect([late.before?.slack_s, late.tooLateFor]).toEqual([-600, ['coolant_vent', 'uhf_start']]);
    expect(arrivalOf({ ...told, latestUsefulUs: undefined, usefulBefore: '' }, aStore([], run)).before).toBeUndefined();
  });
  it('shows the ground’s word on a precondition with its value apart', () => {
    expect(conditionWords('parameters_received == 1: is 0')).toEqual({
      words: 'parameters received: must be yes',
      value: 'is no',
    });
    expect(conditionWords('parameters_received == 1: not known, no value has come').value).toBe(
      'not known, no value has come',
    );
    expect(
      reasonWords(
        'X must not be sent now: parameters_received == 1: is 0; late_cruise == 1: not known, no value has come',
      ),
    ).toBe(
      'X must not be sent now: parameters received: must be yes, is no; late cruise: must be yes, not known, no value has come',
    );
    expect(reasonWords('the line is closed: nobody has said go')).toBe('the line is closed: nobody has said go');
    expect(conditionWords('edl_enabled == 0: is 0')).toEqual({ words: 'edl enabled: no, as it must be', value: '' });
    expect(conditionWords('speed_mps <= 405: is 1')).toEqual({ words: 'speed mps ≤ 405', value: 'is 1' });
  });
});

describe('the queue', () => {
  const waits = (of: object = {}) =>
    stage({
      command: 4n,
      name: 'NO_OP',
      stage: 'released',
      status: 'pending',
      evidence: 'leaves at 2012-219T05:10:00',
      ...of,
    });
  it('has what has not left, held or waiting for its time, and nothing that left or was cancelled', () => {
    expect(waitingCommands(aStore([waits({ held: true })]))).toMatchObject([{ held: true, row: { command: 4 } }]);
    expect(waitingCommands(aStore([waits()]))).toMatchObject([{ held: false, asker: undefined }]);
    expect(waitingCommands(aStore([waits({ held: true, needsApproval: true, askedBy: 'Ann' })]))).toMatchObject([
      { held: true, asker: 'Ann' },
    ]);
    expect(waitingCommands(aStore([waits(), stage({ command: 4n, stage: 'released', status: 'ok' })]))).toEqual([]);
    expect(waitingCommands(aStore([waits(), stage({ command: 4n, stage: 'released', status: 'failed' })]))).toEqual([]);
  });
});

describe('what the vehicle holds', () => {
  const sent = stage({
    command: 1n,
    name: 'SET',
    stage: 'queued',
    status: 'ok',
    arguments: 'altitude_m=125.5 speed_mps=0.1',
  });
  const radiated = stage({ command: 1n, stage: 'radiated', status: 'ok', ert: '2012-219T05:00:00.0' });
  const compared = (...held: ReturnType<typeof samples>[]) => {
    const store = aStore([sent, radiated, ...held]);
    const row = store.commands.get(1);
    return row && readBackOf(row, aDictionary, store);
  };
  it('is compared argument by argument with what was sent', () => {
    expect(compared(samples(901, { 3: 125.5, 4: 0.2 }))).toEqual({
      sclk: 901,
      lines: [
        { name: 'altitude_m', sent: '125.5', held: 125.5, equal: true },
        { name: 'speed_mps', sent: '0.1', held: 0.2, equal: false },
      ],
    });
  });
  it('is not known before a report that is younger than the command', () => {
    expect(compared(samples(899, { 3: 125.5, 4: 0.1 }))).toMatchObject({
      sclk: undefined,
      lines: [{ equal: undefined }, { equal: undefined }],
    });
  });
  it('has no word where no packet bears the names', () => {
    const store = aStore([
      stage({ command: 1n, name: 'SET', stage: 'queued', status: 'ok', arguments: 'timepoint=3' }),
    ]);
    const row = store.commands.get(1);
    expect(row && readBackOf(row, aDictionary, store)).toBeUndefined();
  });
});

describe('Tab', () => {
  it('completes command, then argument, and refuses a word that is neither', async () => {
    useForTest(aStore(), aDictionary);
    type('set edl par');
    complete();
    expect(line.value).toBe('edl_set_parameters ');
    type('edl_set_parameters sol');
    complete();
    expect(line.value).toBe('edl_set_parameters solution_id=');
    type('edl_set_parameters nonsense solution_id=3');
    await forward();
    await forward();
    expect(message.value).toMatchObject({ good: false, text: expect.stringContaining('nonsense') });
    back(true);
    type('');
  });
});

let heard: Extract<ToWorker, { type: 'command' }>[] = [];
/** A worker that sends nothing by itself. */
function connected(): void {
  heard = [];
  useForTest(aStore(), aDictionary, (message) => {
    if (message.type === 'command') heard.push(message);
  });
  onMessage({ type: 'stream', state: 'live', attempt: 0, gaps: 0, serverVersion: '' });
}
const reply = (fields: object = {}, to = heard.at(-1)) =>
  onMessage({
    type: 'reply',
    reply: create(CommandReplySchema, { request: BigInt(to?.request ?? 0), accepted: true, command: 7n, ...fields }),
  });
/** The ground accepts the newest dry run. */
async function answered(step: Promise<unknown>): Promise<void> {
  await Promise.resolve();
  reply();
  await step;
}

describe('an answer', () => {
  aServer(); // after a lost connection the page asks for the session
  beforeEach(() => connected());
  afterEach(() => {
    onMessage({ type: 'stream', state: 'connecting', attempt: 0, gaps: 0, serverVersion: '' });
    back(true);
    type('');
    dismissNotice();
  });
  const reviewed = async () => {
    type('no op');
    await forward();
    await answered(tryOut());
  };
  it('is that which bears the command’s number: a refusal of anything else is a notice, and takes no answer away', async () => {
    await reviewed();
    const sent = forward();
    onMessage({ type: 'refusal', reason: 'the archive could not be read' });
    onMessage({ type: 'trouble', words: 'history: 503' });
    expect([step.value, notices.value.map((each) => each.text)]).toEqual([
      'sending',
      ['the archive could not be read', 'history: 503'],
    ]);
    await answered(sent);
    expect(message.value).toMatchObject({ good: true, text: expect.stringContaining('NO_OP is #7') });
  });
  it('to something else that comes in between is not taken for it', async () => {
    await reviewed();
    const sent = forward();
    reply({ accepted: false, reason: 'another one' }, { ...heard[0], request: 4711 } as never);
    expect(step.value).toBe('sending');
    await answered(sent);
    expect(message.value?.good).toBe(true);
  });
  it('to the dry run must stand there before anything leaves', async () => {
    type('no op');
    await forward();
    await forward();
    expect([heard.length, step.value, message.value?.text]).toEqual([
      0,
      'review',
      expect.stringContaining('nothing was sent'),
    ]);
    await answered(tryOut());
    await answered(forward());
    expect(heard.map((each) => each.intent.dryRun === true)).toEqual([true, false]);
  });
  it('takes nothing of what is typed meanwhile, and Enter upon it opens the review of the next command', async () => {
    await reviewed();
    const sent = forward();
    type('no op');
    await forward();
    type('no o');
    await answered(sent);
    expect([line.value, step.value]).toEqual(['no o', 'type']); // typed further since: Enter was not for this
    back();
    await reviewed();
    const again = forward();
    type('no op ');
    await forward();
    await answered(again);
    expect([line.value, step.value, heard.at(-1)?.intent.dryRun]).toEqual(['no op ', 'review', undefined]);
  });
  it('that refuses stays in sight, whatever was typed meanwhile', async () => {
    await reviewed();
    const sent = forward();
    type('no op ');
    await forward();
    await Promise.resolve();
    reply({ accepted: false, reason: 'the room is closed' });
    await sent;
    expect([line.value, step.value, message.value?.text]).toEqual([
      'no op ',
      'type',
      expect.stringContaining('the room is closed'),
    ]);
  });
  it('that never comes leaves nothing in the line that another Enter would send again', async () => {
    await reviewed();
    const sent = forward();
    onMessage({ type: 'stream', state: 'lost', attempt: 1, gaps: 0, serverVersion: '' });
    await sent;
    expect([line.value, step.value, message.value?.text]).toEqual([
      '',
      'type',
      expect.stringContaining('whether it was taken is not known'),
    ]);
    connected();
    for (let presses = 0; presses < 4; ++presses) await forward();
    expect(heard).toEqual([]);
  });
  it('leaves what was typed meanwhile as the next command', async () => {
    await reviewed();
    const sent = forward();
    type('do edl');
    await answered(sent);
    expect([line.value, message.value?.text]).toEqual(['do edl', expect.stringContaining('NO_OP is #7')]);
  });
  it('to the dry run is asked for once at a time, of the same', async () => {
    type('no op');
    await forward();
    const asked = [tryOut(), tryOut()];
    expect(heard.length).toBe(1);
    reply();
    expect((await Promise.all(asked)).map((each) => each?.accepted)).toEqual([true, true]);
    await answered(tryOut());
    expect(heard.length).toBe(2);
  });
  it('on what waits in the queue that never comes says no more than that', async () => {
    const acted = actOn(7, 'release');
    await Promise.resolve();
    onMessage({ type: 'stream', state: 'lost', attempt: 1, gaps: 0, serverVersion: '' });
    await acted;
    expect(message.value?.text).toMatch(/^#7, release: .*whether it was taken is not known/);
  });
  it('is not waited for where nothing left', async () => {
    await reviewed();
    const sent = forward();
    onMessage({ type: 'not_sent', request: heard.at(-1)?.request ?? 0 });
    await sent;
    expect([line.value, message.value?.text]).toEqual([
      'no op',
      expect.stringContaining('not connected: nothing was sent'),
    ]);
  });
});

describe('the command line', () => {
  let root: HTMLElement;
  beforeEach(() => {
    root = document.createElement('div');
    document.body.append(root);
    useForTest(aStore(), aDictionary);
    onMessage({ type: 'stream', state: 'connecting', attempt: 0, gaps: 0, serverVersion: '' }); // no server answers
    act(() => render(<Commands />, root));
  });
  afterEach(() => {
    act(() => {
      back(true);
      back(true);
      type('');
      render(null, root);
    });
    root.remove();
  });
  it('takes the key that opens it for no text when it is open already', () => {
    const input = root.querySelector('[data-testid="command-line"]');
    const pressed = (key: string) => {
      const event = new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true });
      act(() => void input?.dispatchEvent(event));
      return event.defaultPrevented;
    };
    expect([pressed('/'), pressed('d')]).toEqual([true, false]);
    act(() => type('x'));
    expect(pressed('/')).toBe(false);
  });
  it('goes on by Enter: review, armed, and sends nothing without the typed name', async () => {
    act(() => type('do edl'));
    expect(root.querySelector('[role="option"]')?.textContent).toContain('EDL_DO_EDL');
    await act(() => forward());
    expect([step.value, chosen.value?.name]).toEqual(['review', 'EDL_DO_EDL']);
    expect(isHazardous(doEdl)).toBe(true);
    await act(() => forward());
    expect([step.value, message.value?.text]).toEqual(['review', 'not armed: not connected: nothing was sent']);
    connected();
    await act(() => answered(forward()));
    expect(step.value).toBe('armed');
    // Warning and the ground's answer stay in sight during arming.
    expect(root.querySelector('[data-testid="command-armed"]')?.textContent).toMatch(
      /ARMED: EDL_DO_EDL.*Starts the timeline.*Its checks hold.*Nothing is sent yet: type EDL_DO_EDL/,
    );
    await act(() => forward());
    expect([step.value, message.value?.good]).toEqual(['armed', false]);
    act(() => back());
    expect(step.value).toBe('review');
    act(() => back());
    expect(step.value).toBe('type');
  });
  it('keeps nothing armed when the past is looked at, nor anything reviewed when it is another run', async () => {
    const armed = async () => {
      connected();
      act(() => type('do edl'));
      await act(() => forward());
      await act(() => answered(forward()));
      act(() => {
        confirmation.value = 'EDL_DO_EDL';
      });
      expect([step.value, heard.length]).toEqual(['armed', 1]);
    };
    await armed();
    act(() => lookAtPast({ from: -200, to: -150 }, false));
    act(() => backToLive());
    expect([step.value, confirmation.value, previewNow.value, message.value?.text]).toEqual([
      'review',
      '',
      undefined,
      'EDL_DO_EDL is not armed any more: nothing was sent',
    ]);
    act(() => back(true));
    await armed();
    act(() =>
      useForTest(
        aStore([], aRun({ run: 2n })),
        aDictionary,
        (said) => said.type === 'command' && void heard.push(said),
      ),
    );
    expect([step.value, confirmation.value, chosen.value, root.querySelector('[data-testid="command-armed"]')]).toEqual(
      ['type', '', undefined, null],
    );
    await act(() => forward());
    // and it needs the ground's answer for that run
    expect([step.value, previewNow.value, heard.length]).toEqual(['review', undefined, 1]);
  });
  it('is not armed by an answer that comes when the past is looked at', async () => {
    connected();
    act(() => type('do edl'));
    await act(() => forward());
    const arming = forward();
    act(() => lookAtPast({ from: -200, to: -150 }, false));
    await act(() => answered(arming));
    act(() => backToLive());
    expect(step.value).toBe('review');
  });
  it('does not go on with a missing argument', async () => {
    act(() => type('set edl parameters'));
    await act(() => forward());
    await act(() => forward());
    expect([step.value, message.value?.text]).toEqual(['review', 'solution_id is needed']);
  });
  it('shows the newest twelve commands, and older ones on request, down to the first', () => {
    const numbers = () =>
      [...root.querySelectorAll('[data-command] button')].map((each) => Number(each.textContent?.split('#')[1]));
    act(() =>
      useForTest(
        aStore(
          Array.from({ length: 30 }, (_, i) =>
            stage({ command: BigInt(i + 1), name: 'NO_OP', stage: 'queued', status: 'ok' }),
          ),
        ),
        aDictionary,
      ),
    );
    expect([numbers().length, numbers()[0], numbers().at(-1)]).toEqual([12, 30, 19]);
    const older = () => root.querySelector<HTMLElement>('[data-testid="older-commands"]');
    expect(older()?.textContent).toBe('18 older: show 12 of them');
    act(() => older()?.click());
    act(() => older()?.click());
    expect([numbers().length, numbers().at(-1), older()]).toEqual([30, 1, null]);
  });
  it('shows a name with markup as text', () => {
    act(() => {
      type('');
      useForTest(
        aStore([stage({ command: 1n, name: '<img src=x onerror=alert(1)>', stage: 'queued', status: 'ok' })]),
        aDictionary,
      );
    });
    expect(root.querySelector('img')).toBeNull();
    expect(root.textContent).toContain('<img src=x');
    expect(line.value).toBe('');
  });
  it('takes no command for a run that has ended', () => {
    act(() => useForTest(aStore([], aRun({ state: 'finished' })), aDictionary));
    expect(root.querySelector<HTMLInputElement>('[data-testid="command-line"]')?.disabled).toBe(true);
  });
});
