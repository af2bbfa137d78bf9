// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, it } from 'vitest';
import { ClockReplySchema } from '../gen/aeolis/v1/run_pb';
import type { Score, ScoreFault } from '../rehearsal/score';
import { ENTRY_SCLK, aRun, aStore, ertUs } from '../testing/fixtures';
import { aStep, aWatchdog, anExecution, us } from '../testing/procedures';
import { earthWords, endOf, knownWhen, missedOf, signWords, timelineOf, timesOf } from './model';

const aClock = create(ClockReplySchema, { sclk: ENTRY_SCLK, scetUs: ertUs('2012-219T05:00:00.0'), rate: 1 });
const far = timesOf(aStore([], aRun({ clock: aClock, lightTimeS: 100, clocks: undefined })));
const near = timesOf(aStore([], aRun({ clock: aClock, lightTimeS: 0, clocks: undefined })));

const FAULT: ScoreFault = {
  text: 'radar A silent',
  inject: 'radar',
  e_s: 50,
  felt_e_s: 50,
  signs: [
    { name: 'RADAR_LOST', on_board_e_s: 51, heard_e_s: 55 },
    { name: 'radar_lost', heard_e_s: 60 },
  ],
  seen_e_s: 55,
  first_act: { kind: 'note', e_s: 70, by: 'Bob', text: 'wrote “radar”' },
  not_judged: [],
};

it('an instant has its time on Earth by clock correlation and light time, and none without a clock', () => {
  expect(earthWords(far, 0)).toBe('219T05:01:40.0');
  expect(far.ofErt(us('2012-219T05:01:50.0'))).toBeCloseTo(10);
  expect(earthWords(timesOf(aStore([], aRun({ clocks: undefined }))), 0)).toBe('—');
});

it('a fault was done a light time before anybody could know of it, was seen by a sign, and then answered', () => {
  const rows = knownWhen(FAULT, far).map(({ what, e_s, where, words }) => [what, e_s, where, words]);
  expect(rows).toEqual([
    ['done', -50, 'E+0:50.0 at the vehicle', 'radar A silent'],
    ['could be known', 50, undefined, '1 m 40 s later, the light time'],
    ['first sign', 55, undefined, '5.0 s later: RADAR_LOST'],
    ['first act after it', 70, undefined, '15.0 s later: Bob wrote “radar”'],
  ]);
  expect(knownWhen(FAULT, near)[1]?.words).toBe('at once: no light time is rehearsed');
  // an outage of the station is on Earth: done there in the instant in which it is felt
  expect(knownWhen({ ...FAULT, e_s: 150 }, far)[1]?.words).toBe('at once: it is on Earth');
});

it('what nobody saw, and what nobody answered, is said', () => {
  const { seen_e_s: _seen, first_act, ...unseen } = FAULT;
  expect(knownWhen(unseen, far).map(({ words }) => words)[2]).toBe('no sign of it was received');
  expect(first_act).toBeDefined();
  expect(knownWhen({ ...unseen, seen_e_s: 55 }, far)[3]?.words).toBe('nobody did anything afterwards');
  expect(knownWhen({ ...unseen, seen_e_s: 50, signs: [] }, far)[2]?.words).toBe(
    'no sign is listed for it: its beginning counts',
  );
});

it('a sign says when it was on board and when it was received, or that the recording alone has it', () => {
  const words = (sign: object) => signWords({ name: 'X', ...sign }, 50);
  expect(words({ on_board_e_s: 51, heard_e_s: 55 })).toEqual({
    words: 'reported on board E+0:51.0, received E+0:55.0, 4.0 s later',
    missed: false,
  });
  expect(words({ on_board_e_s: 51, heard_e_s: 51.01 }).words).toContain('by light time alone');
  expect(words({ heard_e_s: 60 }).words).toBe('received E+1:00.0, 10.0 s later');
  expect(words({ on_board_e_s: 51 })).toEqual({
    words: 'reported on board E+0:51.0; not received live: the recording alone has it',
    missed: true,
  });
  expect(words({})).toEqual({ words: 'not received, and no report of it is known', missed: true });
});

it('the timeline has each thing at the instant on Earth, whose it was, and the inject before what came of it', () => {
  const score: Score = {
    facts: [
      { of: 'landing', text: 'touchdown', e_s: 400 },
      { of: 'landing', text: '4.7 km from the target' },
      { of: 'fault', text: 'radar A silent', e_s: 50 },
      { of: 'alarm', text: 'speed > 90; never acknowledged', e_s: 58 },
    ],
    terms: [],
    sum: 0,
    rule: '',
    faults: [FAULT],
    acts: [{ kind: 'note', e_s: 70, by: 'Bob', text: 'wrote “radar”' }],
  };
  const notes = [{ e_s: 165, note: { text: 'slow', by: 'Ida' } }];
  const rows = timelineOf(score, undefined, notes, far).map(({ e_s, side, by, words }) => [e_s, side, by ?? '', words]);
  expect(rows).toEqual([
    [-50, 'instructor', '', 'radar, E+0:50.0 at the vehicle'],
    [55, 'received', '', 'first sign of “radar”: RADAR_LOST'],
    [58, 'received', '', 'speed > 90; never acknowledged'],
    [60, 'received', '', 'sign of “radar”: radar_lost'],
    [65, 'instructor', 'Ida', 'slow'],
    [70, 'room', 'Bob', 'wrote “radar”'],
    [400, 'received', '', 'touchdown'],
  ]);
});

it('skipped, late and unfinished steps are missed, and what was not reached is told apart', () => {
  const one = anExecution({
    steps: [
      aStep('look', { state: 'ticked', by: 'Ann', over_us: us('2012-219T05:02:10.0') }),
      aStep('ask', { state: 'skipped', by: 'Ann (flight_director)', reason: 'no time' }),
      aStep('send', {
        state: 'checked',
        limits: 'within 20 s',
        limit_passed_us: us('2012-219T05:02:00.0'),
        over_us: us('2012-219T05:02:15.0'),
      }),
      aStep('wait', { state: 'late', limits: 'within 5 s', limit_passed_us: us('2012-219T05:02:20.0') }),
      aStep('end'),
    ],
    watchdogs: [
      aWatchdog('silence', { tripped_us: us('2012-219T05:02:00.0') }),
      aWatchdog('heard', {
        tripped_us: us('2012-219T05:02:00.0'),
        acknowledged: { position: 'gnc', by: 'Ann', at_us: us('2012-219T05:02:01.0') },
      }),
    ],
  });
  const { missed, notReached } = missedOf(one, far);
  expect(missed.map(({ what, step, words }) => [what, step, words])).toEqual([
    ['skipped', 'ask', 'by Ann (flight_director): no time'],
    ['late', 'send', 'its time limit passed at E+0:20.0 (within 20 s); over at E+0:35.0, 15.0 s later'],
    ['late', 'wait', 'its time limit passed at E+0:40.0 (within 5 s)'],
    ['not done', 'wait', 'when the run ended'],
    ['not acknowledged', 'silence', 'the watchdog tripped at E+0:20.0'],
  ]);
  expect(notReached).toEqual(['end']);
  // a way that was not taken is none that was missed, unless somebody stopped the procedure
  const over = { over: true, steps: [aStep('other', { state: 'not_taken' })] };
  expect(missedOf(anExecution({ ...over, part: 'confirmed' }), far)).toEqual({ missed: [], notReached: [] });
  expect(missedOf(anExecution({ ...over, part: 'stopped' }), far).notReached).toEqual(['other']);
  expect((['confirmed', 'ended', 'stopped'] as const).map((part) => endOf(anExecution({ over: true, part })))).toEqual([
    'confirmed',
    'ended unconfirmed',
    'stopped',
  ]);
  expect(endOf(one)).toBe('under way when the run ended');
});
