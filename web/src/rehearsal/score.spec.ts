// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { NoteSchema } from '../gen/aeolis/v1/items_pb';
import { AsFlownReportSchema } from '../gen/aeolis/v1/run_pb';
import { secondsOfDayOfYear } from '../run/time';
import type { NamedStage } from '../stream/names';
import { ENTRY_SCLK, aRun, ertUs, item, stage, wireRun } from '../testing/fixtures';
import type { NamedRun } from '../stream/names';
import { commandOutcomes, miss_m, promptness, raisedAlarms, score, scoreText } from './score';
import type { AlarmChange, Recorded } from './score';

// ERT 05:00:00 is E+0 as heard on Earth.
const ert = (e_s: number) =>
  `2012-219T05:${String(Math.floor(e_s / 60)).padStart(2, '0')}:${(e_s % 60).toFixed(1).padStart(4, '0')}`;
const e_sOf = (ert_s: number) => ert_s - secondsOfDayOfYear(ert(0));
const ert_us = (e_s: number) => String(ertUs(ert(e_s)));
const limit = (e_s: number, severity: string, channel = 4): AlarmChange => ({
  ert_us: ert_us(e_s),
  alarm: { channel, severity, sclk: ENTRY_SCLK + e_s, limit: '> 90 m/s' },
});
const acknowledged = (e_s: number, alarm = 'speed_mps'): AlarmChange => ({
  ert_us: ert_us(e_s),
  alarm_action: { alarm, action: 'acknowledge', by: 'Ann' },
});
const said = (name: string, at_e_s: number, word: NamedStage['stage'], status: NamedStage['status'], evidence = '') =>
  stage({ command: 1n, name, stage: word, status, evidence, ert: ert(at_e_s) });
const radar = (e_s: number) => ({
  e_s,
  fault: {
    device_fault: {
      device: 'DEVICE_RADAR',
      unit: 'REDUNDANT_UNIT_A',
      kind: 'DEVICE_FAULT_KIND_SILENT',
      duration_s: 10,
    },
  },
});
const nothing = (outcome: NamedRun['outcome'] = 'touchdown'): Recorded => ({
  outcome,
  landed: undefined,
  report: create(AsFlownReportSchema, { run: wireRun(aRun({ state: 'finished', outcome })) }),
  alarms: [],
  interventions: [],
  e_sOf,
  channelName: (id) => (id === 4 ? 'speed_mps' : `channel ${id}`),
  isHazardous: (name) => name === 'EDL_DO_EDL',
});

describe('an alarm', () => {
  it('counts from when it came to its first acknowledgement; growing worse is not another one, coming again is', () => {
    const alarms = [
      limit(10, 'watch'),
      limit(12, 'distress'),
      acknowledged(25),
      acknowledged(40),
      limit(50, 'none'),
      limit(60, 'watch'),
      limit(61, 'none'),
    ];
    expect(raisedAlarms({ ...nothing(), alarms }).map((one) => [one.e_s, one.acknowledged?.after_s])).toEqual([
      [10, 15],
      [60, undefined],
    ]);
  });
  it('that nobody has looked at and that comes again is the same one still', () => {
    const alarms = [limit(10, 'watch'), limit(11, 'none'), limit(20, 'watch'), acknowledged(30)];
    expect(raisedAlarms({ ...nothing(), alarms }).map((one) => [one.e_s, one.acknowledged?.after_s])).toEqual([
      [10, 20],
    ]);
  });
  it('may be a packet that is silent', () => {
    const alarms: AlarmChange[] = [
      { ert_us: ert_us(5), staleness: { packet: 'GncNavigation', stale: true } },
      acknowledged(8, 'GncNavigation'),
    ];
    expect(raisedAlarms({ ...nothing(), alarms })).toMatchObject([
      { name: 'GncNavigation', limit: 'silent', e_s: 5, acknowledged: { after_s: 3, by: 'Ann' } },
    ]);
  });
});

describe('a command', () => {
  const command = (name: string, ...stages: ReturnType<typeof said>[]) => ({ command: 1n, name, stages });
  const outcome = (...stages: ReturnType<typeof said>[]) =>
    commandOutcomes({
      ...nothing(),
      report: create(AsFlownReportSchema, { commands: [command('NO_OP', ...stages)] }),
    })[0];
  it('was carried out only where every last word is ok and one is of carrying it out', () => {
    expect(
      outcome(
        said('NO_OP', 1, 'queued', 'ok'),
        said('NO_OP', 1, 'executed', 'pending'),
        said('NO_OP', 2, 'executed', 'ok'),
      ),
    ).toMatchObject({ how: 'done', e_s: 1 });
    expect(outcome(said('NO_OP', 1, 'queued', 'ok'))?.how).toBe('not known');
    expect(outcome(said('NO_OP', 1, 'queued', 'ok'), said('NO_OP', 1, 'executed', 'unknown'))?.how).toBe('not known');
  });
  it('that was cancelled or failed says why', () => {
    expect(outcome(said('NO_OP', 1, 'released', 'failed', 'cancelled by Bob'))).toMatchObject({
      how: 'cancelled',
      why: 'cancelled by Bob',
    });
    expect(outcome(said('NO_OP', 1, 'accepted', 'failed', 'no answer'))).toMatchObject({
      how: 'failed',
      why: 'no answer',
    });
  });
});

describe('the score', () => {
  it('leaves out what there was nothing of, and is the sum of its terms as a share of what they are worth', () => {
    const bare = score(nothing());
    expect([bare.terms.map((term) => term.name), bare.sum]).toEqual([['landing'], 100]);
    expect(score(nothing('lost')).sum).toBe(0);
    const half = score({ ...nothing(), alarms: [limit(10, 'watch')] }); // never acknowledged
    expect([half.terms.map((term) => term.most * term.share), half.sum]).toEqual([[40, 0], 80]);
  });
  it('counts a reaction in full within half a minute, and from five minutes on not at all', () => {
    expect([0, 30, 165, 300, 900, undefined].map(promptness)).toEqual([1, 1, 0.5, 0, 0, 0]);
  });
  it('takes as a reaction to a fault the first thing that people did from then on: never what they did before', () => {
    const note = item({ case: 'note', value: create(NoteSchema, { text: 'radar?', by: 'Bob' }) }, ert(100));
    const report = create(AsFlownReportSchema, {
      run: wireRun(aRun({ outcome: 'touchdown' })),
      notes: [note],
      commands: [
        {
          command: 1n,
          name: 'NO_OP',
          stages: [said('NO_OP', 5, 'queued', 'ok'), said('NO_OP', 5, 'authorised', 'ok', 'no arming needed, by Ann')],
        },
      ],
    });
    const { facts, terms } = score({ ...nothing(), report, interventions: [radar(10), radar(110)] });
    expect(facts.filter((fact) => fact.of === 'fault').map((fact) => fact.text)).toEqual([
      'radar A silent, for 10 s; 1 m 30 s later: Bob wrote “radar?”',
      'radar A silent, for 10 s; nobody did anything afterwards',
    ]);
    expect(terms.find((term) => term.name === 'faults')?.share).toBeCloseTo(promptness(90) / 2, 10);
  });
  const carriedOut = (number: bigint, at_e_s: number, queued: string, ...authorised: string[]) => ({
    command: number,
    name: 'NO_OP',
    stages: [
      said('NO_OP', at_e_s, 'queued', 'ok', queued),
      ...authorised.map((words) => said('NO_OP', at_e_s, 'authorised', 'ok', words)),
      said('NO_OP', at_e_s + 1, 'executed', 'ok'),
    ],
  });
  it('judges the commands of people, and not those of the scenario’s script', () => {
    const commands = [
      carriedOut(1n, 1, "asked for by the scenario's script, accepted as command 1", 'armed and confirmed by name'),
      carriedOut(
        2n,
        2,
        'accepted as command 2',
        'armed and confirmed by name, by Ann; left to flight: x == 1',
        'approved by Bob, as the second person',
      ),
      {
        command: 3n,
        name: 'NO_OP',
        stages: [said('NO_OP', 3, 'queued', 'failed', "asked for by the scenario's script, refused: late")],
      },
      carriedOut(5n, 3, 'accepted as command 5', 'no arming needed'), // without a signature
      {
        command: 4n,
        name: 'NO_OP',
        stages: [
          said('NO_OP', 4, 'queued', 'ok'),
          said('NO_OP', 4, 'authorised', 'ok', 'no arming needed, by Bob'),
          said('NO_OP', 5, 'executed', 'failed', 'no answer'),
        ],
      },
    ];
    const of = {
      ...nothing(),
      report: create(AsFlownReportSchema, { run: wireRun(aRun({ outcome: 'touchdown' })), commands }),
    };
    expect(commandOutcomes(of).map(({ sender }) => sender)).toEqual([undefined, 'Ann', undefined, 'someone', 'Bob']);
    const { facts, terms } = score(of);
    expect(terms.find((term) => term.name === 'commands')).toMatchObject({
      share: 2 / 3,
      why: '2 of 3 of people were carried out',
    });
    expect(facts.filter((fact) => fact.of === 'commands').map((fact) => fact.text.split(':')[0])).toEqual([
      '3 commands of people',
      '2 commands of the scenario’s script',
    ]);
    const scripted = {
      ...of,
      report: create(AsFlownReportSchema, {
        run: wireRun(aRun({ outcome: 'touchdown' })),
        commands: [commands[0], commands[2]] as typeof commands,
      }),
    };
    expect([score(scripted).terms.map((term) => term.name), score(scripted).sum]).toEqual([['landing'], 100]);
  });
  it('says all of it as a text, with the instructor’s notes and the rule', () => {
    const interventions = [{ e_s: 20, note: { text: 'slow', by: 'Ida' } }];
    const of = {
      ...nothing(),
      interventions,
      landed: { e_s: 431, words: 'Touchdown: descending 0.7 m/s', miss_m: 4663 },
    };
    const text = scoreText('run 1', score(of), interventions);
    for (const part of [
      'landing: E+7:11.0 touchdown',
      'descending 0.7 m/s',
      '4.7 km from the target, by the vehicle’s own navigation',
      "instructor's note: E+0:20.0 Ida: slow",
      'score: 100 of 100',
      '  landing: 40.0 of 40',
      'Our own rule',
    ])
      expect(text).toContain(part);
  });
});

it('a miss is the way over ground between two directions', () => {
  expect(miss_m([0, 3390000, 0], 0, 90, 3390000)).toBeCloseTo(0, 3);
  expect(miss_m([3390000, 0, 0], 0, 90, 3390000)).toBeCloseTo((3390000 * Math.PI) / 2, 3);
});
