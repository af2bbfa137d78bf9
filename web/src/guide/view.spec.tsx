// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { describe, expect, it } from 'vitest';
import { aDictionary, aPlan, aRun, aStore, firing, samples, situation, stage } from '../testing/fixtures';
import type { NamedRun, NamedStage } from '../stream/names';
import { stream } from '../run/connection';
import { useForTest } from '../run/session';
import { GUIDE_STEPS, guideNow, guideShown, guideStep, toggleGuide } from './model';

const done = (count: number) =>
  ['EDL_SET_PARAMETERS', 'EDL_DO_EDL']
    .slice(0, count)
    .map((name, i) => stage({ command: BigInt(i + 1), name, stage: 'executed', status: 'ok' }));
const keys = (step: ReturnType<typeof guideStep>) => step?.press.map((press) => press.key ?? press.type);
const at = (eS: number, fields: Partial<NamedRun> = {}) => {
  const run = aRun({ ...fields, $typeName: undefined } as never);
  if (run.clocks) run.clocks = { ...run.clocks, eS, sclk: 1000 + eS, seenSclk: 1000 + eS };
  return run;
};

const soonPlan = aPlan.slice(1); // the first timepoint on the clock is still ahead

describe('the guide', () => {
  it('leads key by key through both commands', () => {
    expect(keys(guideStep(aStore(), aDictionary, soonPlan, 'rehearsal', 'type', Infinity))).toEqual([
      '/',
      'set edl parameters',
      'Enter',
    ]);
    expect(keys(guideStep(aStore(), aDictionary, soonPlan, 'rehearsal', 'review', Infinity))).toEqual(['Enter', 'Esc']);
    const second = aStore(done(1));
    expect(guideStep(second, aDictionary, soonPlan, 'rehearsal', 'type', Infinity)).toMatchObject({
      number: 2,
      wants: 'command',
    });
    expect(keys(guideStep(second, aDictionary, soonPlan, 'rehearsal', 'armed', Infinity))).toEqual([
      'EDL_DO_EDL',
      'Enter',
    ]);
  });
  it('leads out of a run that can begin no more, and not further into it', () => {
    const now = (eS: number, lightTimeS = 0) => {
      const run = at(eS);
      if (run.clocks) run.clocks.lightTimeS = lightTimeS;
      return guideStep(aStore([], run), aDictionary, aPlan, 'rehearsal', 'type', Infinity, false, {
        beginBy_e_s: -831,
      });
    };
    expect(keys(now(-832))).toEqual(['/', 'set edl parameters', 'Enter']);
    expect(now(-830)).toMatchObject({
      title: 'Too late for this run: start another',
      wants: 'nothing',
      why: expect.stringContaining('had to leave by E−13:51'),
    });
    expect(keys(now(-830))?.[0]).toBe('s');
    expect([now(-840, 5)?.title, now(-842, 5)?.title]).toEqual([
      'Too late for this run: start another',
      'Tell the vehicle where it is',
    ]);
    const sent = stage({ command: 2n, name: 'EDL_DO_EDL', stage: 'radiated', status: 'ok' });
    expect(
      guideStep(aStore([...done(1), sent], at(-820)), aDictionary, aPlan, 'rehearsal', 'type', Infinity, false, {
        beginBy_e_s: -831,
      })?.title,
    ).toContain('Sent');
  });
  it('does not lead to a command that the vehicle’s status still speaks against', () => {
    const taken = (received: number) =>
      guideStep(aStore(done(1)), aDictionary, soonPlan, 'rehearsal', 'type', Infinity, false, {
        ...(received === 0 && {
          against: { command: 'EDL_DO_EDL', words: 'parameters received: must be yes', value: 'is no' },
        }),
      });
    expect(taken(0)).toMatchObject({
      number: 2,
      press: [],
      wants: 'nothing',
      why: expect.stringContaining('parameters received is no'),
    });
    expect(keys(taken(1))).toEqual(['/', 'do edl', 'Enter']);
  });
  it('says that a command which was sent is not yet one that was taken', () => {
    const sent = aStore([stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'radiated', status: 'ok' })]);
    expect(guideStep(sent, aDictionary, soonPlan, 'rehearsal', 'type', Infinity)?.title).toContain('Waiting');
    const asked = aStore([
      stage({
        command: 1n,
        name: 'EDL_SET_PARAMETERS',
        stage: 'released',
        status: 'pending',
        needsApproval: true,
        askedBy: 'ann',
      }),
    ]);
    expect(guideStep(asked, aDictionary, soonPlan, 'rehearsal', 'type', Infinity)).toMatchObject({
      title: 'It waits on the ground',
      wants: 'command',
      why: expect.stringContaining('waits for a second person'),
    });
  });
  it('says that a command which is held has not left, and asks for it again once it was cancelled or has failed', () => {
    const said = (reached: NamedStage['stage'], status: NamedStage['status'], evidence: string) =>
      stage({
        command: 1n,
        name: 'EDL_SET_PARAMETERS',
        stage: reached,
        status,
        evidence,
        held: status === 'pending',
      });
    const held = [said('queued', 'ok', ''), said('released', 'pending', 'held by Ada')];
    expect(guideStep(aStore(held), aDictionary, soonPlan, 'rehearsal', 'type', Infinity)).toMatchObject({
      number: 1,
      title: 'It waits on the ground',
      press: [],
      why: expect.stringContaining('is held until it is released'),
    });
    for (const last of [said('released', 'failed', 'cancelled by Ada'), said('accepted', 'failed', 'bad_argument')]) {
      expect(keys(guideStep(aStore([...held, last]), aDictionary, soonPlan, 'rehearsal', 'type', Infinity))).toEqual([
        '/',
        'set edl parameters',
        'Enter',
      ]);
    }
  });
  it('has the dull minutes sped up and the landing slowed down', () => {
    const cruise = [...done(2), firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 200 }), samples(300, { 1: 0 })];
    expect(keys(guideStep(aStore(cruise, at(-700)), aDictionary, aPlan, 'rehearsal', 'type', Infinity))).toEqual(['+']);
    expect(
      guideStep(aStore(cruise, at(-700, { pace: 100 })), aDictionary, aPlan, 'rehearsal', 'type', Infinity),
    ).toMatchObject({ number: 3, wants: 'nothing' });
    const entry = [...cruise, samples(1100, { 1: 4 })];
    expect(
      keys(guideStep(aStore(entry, at(100, { pace: 100 })), aDictionary, aPlan, 'rehearsal', 'type', Infinity)),
    ).toEqual(['−']);
    expect(
      keys(guideStep(aStore(entry, at(100, { state: 'paused' })), aDictionary, aPlan, 'rehearsal', 'type', Infinity)),
    ).toEqual(['p']);
  });
  it('says nothing of a good day while something is amiss, and is its old self after that', () => {
    const store = (e_s: number, ...entries: Parameters<typeof situation>[1][]) =>
      guideStep(
        aStore(
          [
            ...done(2),
            firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 200 }),
            samples(1000 + e_s, { 1: e_s < 0 ? 0 : 4 }),
            situation('2012-219T04:59:55.0', ...entries),
          ],
          at(e_s, { pace: 1 }),
        ),
        aDictionary,
        aPlan,
        'rehearsal',
        'type',
        Infinity,
      );
    const fault = { rank: 'news', subject: 'station', sentence: 'A fault on the ground' } as const;
    expect(store(100, fault)?.why).toContain('Not all goes as it should');
    expect(keys(store(100, fault))).toEqual(['m']);
    expect(store(-700, fault)?.why).toContain('Not all goes as it should');
    expect(store(-700, fault)?.title).not.toMatch(/Nothing to do|Entry is near/);
    expect(store(100)?.why).not.toContain('Not all goes');
    expect(store(100, { rank: 'news', subject: 'landed', sentence: 'Landed' })?.why).not.toContain('Not all goes');
  });
  it('slows nothing down once it has landed: then the recording comes down', () => {
    const landed = aStore(
      [...done(2), firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 200 }), samples(1450, { 1: 9 })],
      at(450, { pace: 100, relayProgress: 0.25 }),
    );
    expect(guideStep(landed, aDictionary, aPlan, 'rehearsal', 'type', Infinity)).toMatchObject({
      title: 'Touchdown',
      wants: 'nothing',
      press: [{ words: '25 % of the recording is down.' }],
    });
  });
  it('ends with the landing, and says what can be looked at then', () => {
    const over = aStore(done(2), aRun({ state: 'finished', outcome: 'touchdown' }));
    expect(guideStep(over, aDictionary, aPlan, 'ended', 'type', Infinity)).toMatchObject({
      number: GUIDE_STEPS,
      title: 'You have landed it',
    });
    expect(
      guideStep(
        aStore([], aRun({ state: 'finished', outcome: 'impact' })),
        aDictionary,
        aPlan,
        'ended',
        'type',
        Infinity,
      )?.title,
    ).not.toContain('landed');
  });
  it('is silent in the real venue', () => {
    expect(
      guideStep(aStore([], aRun({ venue: 'downlink' })), aDictionary, aPlan, 'live', 'type', Infinity),
    ).toBeUndefined();
  });
  it('asks for no press while there is no connection', () => {
    useForTest(aStore(), aDictionary);
    const pressed = () => guideNow()?.press.length;
    expect(pressed()).toBeGreaterThan(0);
    stream.value = { ...stream.value, state: 'lost' };
    expect([pressed(), guideNow()?.wants]).toEqual([0, 'nothing']);
    stream.value = { ...stream.value, state: 'live' };
    useForTest(undefined, undefined);
  });
  it('once put away stays away', () => {
    expect(guideShown.value).toBe(true);
    toggleGuide();
    expect([guideShown.value, localStorage.getItem('aeolis-guide')]).toEqual([false, 'hidden']);
    toggleGuide();
  });
});
