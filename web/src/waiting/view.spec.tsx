import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ConditionSchema } from '../gen/aeolis/v1/items_pb';
import { aDictionary, aPlan, aRun, aStore, explanation, firing, samples, stage, tone } from '../testing/fixtures';
import { waitingFor } from './model';

const commanded = [
  stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'executed', status: 'ok' }),
  stage({ command: 2n, name: 'EDL_DO_EDL', stage: 'executed', status: 'ok' }),
];

describe('waiting for', () => {
  it('tells a newcomer what to press first, and then what next', () => {
    expect(waitingFor(aStore(), aDictionary, aPlan, Infinity).title).toBe('Press / and type “set edl parameters”');
    expect(waitingFor(aStore(commanded.slice(0, 1)), aDictionary, aPlan, Infinity).title).toBe('Press / and type “do edl”');
  });
  it('asks for no command that the vehicle’s status still speaks against', () => {
    const waiting = waitingFor(aStore([...commanded.slice(0, 1), samples(899, { 5: 0 })]), aDictionary, aPlan, Infinity);
    expect(waiting.title).toBe('Waiting for the vehicle’s status');
    expect(waiting.lines.at(-1)).toMatchObject({ words: 'parameters received', value: 'parameters_received is 0', holds: false });
    expect(waitingFor(aStore([...commanded.slice(0, 1), samples(899, { 5: 1 })]), aDictionary, aPlan, Infinity).title).toBe('Press / and type “do edl”');
  });
  it('takes a tone for an answer where no packet comes', () => {
    const sent = ['EDL_SET_PARAMETERS', 'EDL_DO_EDL'].map((name, i) => stage({ command: BigInt(i + 1), name, stage: 'radiated', status: 'ok' }));
    const waiting = waitingFor(aStore([...sent, tone({ sclk: 890, tone: 5, name: 'parameters_accepted' })]), aDictionary, aPlan, Infinity);
    expect(waiting.title).toContain('Waiting for the vehicle');
    expect(waiting.lines.map((line) => [line.value, line.holds])).toEqual([['by tone 5', true], ['sent', false]]);
  });
  it('says why a command failed', () => {
    const store = aStore([stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'accepted', status: 'failed', evidence: 'bad_argument' })]);
    expect(waitingFor(store, aDictionary, aPlan, Infinity).lines[0]?.value).toContain('bad_argument');
  });
  it('names the next timepoint and when it is due by the vehicle’s own word', () => {
    const store = aStore([...commanded, firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 880 }), samples(899, { 1: 0, 2: 1000, 5: 1 })]);
    const waiting = waitingFor(store, aDictionary, aPlan, Infinity);
    expect(waiting.title).toBe('Waiting for entry interface');
    expect(waiting.lines[0]).toMatchObject({ words: 'at entry', value: 'in 1 m 40 s', holds: false });
  });
  it('says that an anchor has not happened, and not nothing', () => {
    const store = aStore([...commanded, firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }), samples(899, { 1: 0, 5: 1 })]);
    expect(waitingFor(store, aDictionary, aPlan, Infinity).lines[0]).toMatchObject({ words: 'the vehicle declares “parachute”', value: 'not yet', holds: false });
  });
  it('shows the condition that is missing, as flight explained it', () => {
    const condition = create(ConditionSchema, { quantity: 'speed_mps', value: 450, comparison: '<=', bound: 405, holds: false });
    const store = aStore([...commanded, firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }), explanation({ sclk: 899, decision: 'parachute', verdict: 'held', conditions: [condition] })]);
    expect(waitingFor(store, aDictionary, aPlan, Infinity).lines).toContainEqual({ words: 'speed mps ≤ 405', value: '450', holds: false });
  });
  it('ends with the outcome', () => {
    expect(waitingFor(aStore([], aRun({ state: 'finished', outcome: 'touchdown', relayProgress: 1 })), aDictionary, aPlan, Infinity).title).toBe('Landed');
    expect(waitingFor(aStore([], aRun({ state: 'interrupted' })), aDictionary, aPlan, Infinity).title).toBe('Interrupted');
  });
});
