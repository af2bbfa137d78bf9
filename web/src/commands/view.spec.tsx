// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it } from 'vitest';
import { useForTest } from '../run/session';
import { aDictionary, aPlan, aRun, aStore, samples, stage } from '../testing/fixtures';
import { back, chosen, complete, forward, line, message, step, type } from './line';
import {
  AT_ONCE, argumentOffers, arrivalOf, candidates, conditionWords, fieldsOf, intentOf, isHazardous, preconditionsOf, readBackOf, readLine, readReleaseAt,
  stageCells, waitingCommands,
} from './model';
import { Commands } from './view';

const set = aDictionary.command('EDL_SET_PARAMETERS');
const doEdl = aDictionary.command('EDL_DO_EDL');
if (!set || !doEdl) throw new Error('the fixture lacks its commands');

describe('what is typed', () => {
  it('finds a command by its words', () => {
    expect(candidates(aDictionary, ['do', 'edl'])[0]?.name).toBe('EDL_DO_EDL');
    expect(candidates(aDictionary, ['set', 'edl', 'parameters'])[0]?.name).toBe('EDL_SET_PARAMETERS');
    expect(candidates(aDictionary, ['edl_set_par'])[0]?.name).toBe('EDL_SET_PARAMETERS');
    expect(candidates(aDictionary, ['launch'])).toEqual([]);
  });
  it('reads arguments beside the words', () => {
    const { words, given } = readLine(' edl_set_timepoint_offset  timepoint=3 ');
    expect([words, [...given]]).toEqual([['edl_set_timepoint_offset'], [['timepoint', '3']]]);
  });
  it('once it is a whole command offers its arguments, and what is no argument is called by its name', () => {
    expect(argumentOffers(aDictionary, 'edl_set_par')).toBeUndefined();
    expect(argumentOffers(aDictionary, 'edl_set_parameters ')?.offers).toEqual(['solution_id=', 'parachute_speed_mps=']);
    expect(argumentOffers(aDictionary, 'edl_set_parameters solution_id=3 para')).toMatchObject({ offers: ['parachute_speed_mps='], strays: ['para'] });
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
    const solution = [{ $typeName: 'aeolis.v1.CommandArgument' as const, name: 'solution_id', value: 9 }, { $typeName: 'aeolis.v1.CommandArgument' as const, name: 'parachute_speed_mps', value: 405 }];
    expect(fieldsOf(set, new Map(), solution).map((field) => [field.from, field.value])).toEqual([['solution', 9], ['solution', 405]]);
  });
  it('shows preconditions with their live value, and unknown ones as unknown', () => {
    expect(preconditionsOf(doEdl, aDictionary, aStore())[0]?.holds).toBeUndefined();
    expect(preconditionsOf(doEdl, aDictionary, aStore([samples(900, { 5: 1 })]))[0]?.holds).toBe(true);
    expect(preconditionsOf(doEdl, aDictionary, aStore([samples(900, { 5: 0 })]))[0]?.holds).toBe(false);
  });
});

describe('stages', () => {
  it('shows nothing green that was not heard of', () => {
    const row = aStore([stage({ command: 1n, name: 'NO_OP', stage: 'queued', status: 'ok' }), stage({ command: 1n, stage: 'received', status: 'unknown' })]).commands.get(1);
    const looks = Object.fromEntries((row ? stageCells(row) : []).map((cell) => [cell.stage, cell.look]));
    expect(looks).toMatchObject({ queued: 'ok', received: 'unknown', accepted: 'none', verified: 'none' });
  });
});

describe('what is asked of the uplink', () => {
  const whole = fieldsOf(set, readLine('x solution_id=3').given, []);
  it('is the command with its time, hold and priority, and only what was typed of its arguments', () => {
    expect(intentOf(set, whole, { service: 'BD', releaseAt: '2012-219T05:10:00', hold: true, priority: '7', controller: ' Ann ' }, aStore())).toEqual({
      command: 'EDL_SET_PARAMETERS', arguments: [{ name: 'solution_id', value: 3 }], fromSolution: false,
      service: 'BD', releaseAt: '2012-219T05:10:00', hold: true, priority: 7, controller: 'Ann',
    });
  });
  it('names what cannot be read, and then there is nothing to send', () => {
    expect(intentOf(set, whole, { ...AT_ONCE, releaseAt: 'noon' }, aStore())).toEqual({ problem: expect.stringContaining('“noon” is no time') });
    expect(intentOf(set, whole, { ...AT_ONCE, priority: '-1' }, aStore())).toEqual({ problem: expect.stringContaining('no priority') });
    expect(intentOf(set, fieldsOf(set, new Map(), []), AT_ONCE, aStore())).toEqual({ problem: 'solution_id is needed' });
  });
  it('takes a time to leave as ERT or by the clock on top', () => {
    expect(readReleaseAt('', aStore())).toBe('');
    expect(readReleaseAt('2012-219T05:10:00Z', aStore())).toBe('2012-219T05:10:00');
    expect(readReleaseAt('E-1:30', aStore())).toBe('2012-219T05:00:10.0'); // it is 05:00:00 at E-1:40
    expect([readReleaseAt('90', aStore()), readReleaseAt('E-1:30', undefined)]).toEqual([undefined, undefined]);
  });
  it('says when it comes, by when it must leave, and what it is too late for', () => {
    const run = aRun({ lightTimeS: 60 });
    if (run.clocks) run.clocks = { ...run.clocks, sclk: 160, eS: -840, seenSclk: 100 };
    // Received now, at 05:00:00: SCLK 100, which was SCET 04:59:00. What leaves now comes at SCLK 220, which is E-780.
    expect(arrivalOf({ arrives: '2012-219T05:01:00' }, aStore([], run), aPlan)).toEqual({
      leaves_ert: '2012-219T05:00:00.0', arrives_e_s: -780, tooLateFor: ['coolant_vent'],
      before: { name: 'entry_interface', leave_ert: '2012-219T05:13:00.0', slack_s: 780 },
    });
  });
  it('shows the ground’s word on a precondition with its value apart', () => {
    expect(conditionWords('parameters_received == 1: is 0')).toEqual({ words: 'parameters_received == 1', value: 'is 0' });
  });
});

describe('the queue', () => {
  const waits = (of: object = {}) => stage({ command: 4n, name: 'NO_OP', stage: 'released', status: 'pending', evidence: 'leaves at 2012-219T05:10:00', ...of });
  it('has what has not left, held or waiting for its time, and nothing that left or was cancelled', () => {
    expect(waitingCommands(aStore([waits({ held: true })]))).toMatchObject([{ held: true, row: { command: 4 } }]);
    expect(waitingCommands(aStore([waits()]))).toMatchObject([{ held: false, asker: undefined }]);
    expect(waitingCommands(aStore([waits({ held: true, needsApproval: true, askedBy: 'Ann' })]))).toMatchObject([{ held: true, asker: 'Ann' }]);
    expect(waitingCommands(aStore([waits(), stage({ command: 4n, stage: 'released', status: 'ok' })]))).toEqual([]);
    expect(waitingCommands(aStore([waits(), stage({ command: 4n, stage: 'released', status: 'failed' })]))).toEqual([]);
  });
});

describe('what the vehicle holds', () => {
  const sent = stage({ command: 1n, name: 'SET', stage: 'queued', status: 'ok', arguments: 'altitude_m=125.5 speed_mps=0.1' });
  const radiated = stage({ command: 1n, stage: 'radiated', status: 'ok', at: '2012-219T05:00:00.0' });
  const compared = (...held: ReturnType<typeof samples>[]) => {
    const store = aStore([sent, radiated, ...held]);
    const row = store.commands.get(1);
    return row && readBackOf(row, aDictionary, store);
  };
  it('is compared argument by argument with what was sent', () => {
    expect(compared(samples(901, { 3: 125.5, 4: 0.2 }))).toEqual({ sclk: 901, lines: [
      { name: 'altitude_m', sent: '125.5', held: 125.5, equal: true }, { name: 'speed_mps', sent: '0.1', held: 0.2, equal: false }] });
  });
  it('is not known before a report that is younger than the command', () => {
    expect(compared(samples(899, { 3: 125.5, 4: 0.1 }))).toMatchObject({ sclk: undefined, lines: [{ equal: undefined }, { equal: undefined }] });
  });
  it('has no word where no packet bears the names', () => {
    const store = aStore([stage({ command: 1n, name: 'SET', stage: 'queued', status: 'ok', arguments: 'timepoint=3' })]);
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

describe('the command line', () => {
  let root: HTMLElement;
  beforeEach(() => {
    root = document.createElement('div');
    document.body.append(root);
    useForTest(aStore(), aDictionary);
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
    expect(step.value).toBe('armed');
    expect(root.querySelector('[data-testid="command-armed"]')).not.toBeNull();
    await act(() => forward());
    expect([step.value, message.value?.good]).toEqual(['armed', false]);
    act(() => back());
    expect(step.value).toBe('review');
    act(() => back());
    expect(step.value).toBe('type');
  });
  it('does not go on with a missing argument', async () => {
    act(() => type('set edl parameters'));
    await act(() => forward());
    await act(() => forward());
    expect([step.value, message.value?.text]).toEqual(['review', 'solution_id is needed']);
  });
  it('shows a name with markup as text', () => {
    act(() => {
      type('');
      useForTest(aStore([stage({ command: 1n, name: '<img src=x onerror=alert(1)>', stage: 'queued', status: 'ok' })]), aDictionary);
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
