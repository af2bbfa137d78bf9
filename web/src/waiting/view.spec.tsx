// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import type { Item } from '../gen/aeolis/v1/items_pb';
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { ConditionSchema } from '../gen/aeolis/v1/items_pb';
import { DictionaryChannelSchema, TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import { Dictionary } from '../run/dictionary';
import {
  aDictionary,
  aPlan,
  aRun,
  aStore,
  event,
  explanation,
  firing,
  samples,
  silent,
  situation,
  stage,
  tone,
} from '../testing/fixtures';
import { touchdownAnswer } from '../touchdown/shown';
import type { NamedStage } from '../stream/names';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { predictForTest } from '../prediction/model';
import { stream } from '../run/connection';
import { useForTest } from '../run/session';
import { timepoints } from '../run/shown';
import type { ToWorker } from '../stream/messages';
import { conditionLine, conditionLines, noteWords, waitingFor } from './model';
import type { Against } from './model';
import { WaitingFor } from './view';

const commanded = [
  stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'executed', status: 'ok' }),
  stage({ command: 2n, name: 'EDL_DO_EDL', stage: 'executed', status: 'ok' }),
];

const soonPlan = aPlan.slice(1); // of which the first timepoint on the clock is still to come

describe('waiting for', () => {
  it('tells a newcomer what to press first, and then what next', () => {
    expect(waitingFor(aStore(), aDictionary, soonPlan, Infinity).title).toBe('Press / and type “set edl parameters”');
    expect(waitingFor(aStore(commanded.slice(0, 1)), aDictionary, soonPlan, Infinity).title).toBe(
      'Press / and type “do edl”',
    );
  });
  it('says what the plan notes as a sentence, for more may follow', () => {
    const words = (note: string) => {
      const plan = aPlan.map((row) => ({ ...row, note }));
      return waitingFor(
        aStore([...commanded, firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 174 })]),
        aDictionary,
        plan,
        Infinity,
      ).words;
    };
    expect(['Tone only (L)', 'GNC says when.', ''].map(words)).toEqual(['Tone only.', 'GNC says when.', '']);
    expect(noteWords('Cables are cut before it (order H; time L)')).toBe('Cables are cut before it.');
    expect(
      ['Chosen (L)', 'Chosen (L): armed already', 'Its last use; time chosen (L)', 'OD137 (H)'].map(noteWords),
    ).toEqual(['', 'Armed already.', 'Its last use.', '']);
    expect(noteWords('By the clock (see the plan); 75 kg (M)')).toBe('By the clock (see the plan); 75 kg.');
    expect(noteWords('Its last use; time chosen (L). Held for it: nothing is due for 27 s')).toBe('Its last use.');
    expect(noteWords('Design time (M)'), 'of no use to a controller').toBe('');
  });
  it('asks for no command that the vehicle’s status still speaks against', () => {
    const waiting = (against?: Against) =>
      waitingFor(aStore(commanded.slice(0, 1)), aDictionary, soonPlan, Infinity, [], { against });
    const against = { command: 'EDL_DO_EDL', words: 'parameters received: must be yes', value: 'is no' };
    expect(waiting(against).title).toBe('Waiting for the vehicle’s status');
    expect(waiting(against).lines.at(-1)).toMatchObject({ words: against.words, value: 'is no', holds: false });
    expect(waiting().title).toBe('Press / and type “do edl”');
    expect(waiting({ ...against, command: 'NO_OP' }).title).toBe('Press / and type “do edl”');
  });
  it('takes a tone for an answer where no packet comes', () => {
    const sent = ['EDL_SET_PARAMETERS', 'EDL_DO_EDL'].map((name, i) =>
      stage({ command: BigInt(i + 1), name, stage: 'radiated', status: 'ok' }),
    );
    const waiting = waitingFor(
      aStore([...sent, tone({ sclk: 890, tone: 5, name: 'parameters_accepted' })]),
      aDictionary,
      soonPlan,
      Infinity,
    );
    expect(waiting.title).toContain('Waiting for the vehicle');
    expect(waiting.lines.map((line) => [line.value, line.holds])).toEqual([
      ['by tone 5', true],
      ['sent', false],
    ]);
  });
  it('does not call sent what still waits on the ground, and says for what', () => {
    const on = (fields: object) =>
      waitingFor(
        aStore([
          stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'queued', status: 'ok' }),
          stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'released', status: 'pending', ...fields }),
        ]),
        aDictionary,
        soonPlan,
        Infinity,
      );
    expect(
      [on({ needsApproval: true, askedBy: 'ann' }), on({ held: true }), on({})].map(({ title, lines }) => [
        title,
        lines[0]?.value,
      ]),
    ).toEqual([
      ['“set edl parameters” waits on the ground', 'waits for a second person'],
      ['“set edl parameters” waits on the ground', 'is held until it is released'],
      ['“set edl parameters” waits on the ground', 'waits to leave'],
    ]);
    expect(on({ status: 'ok' }).lines[0]?.value).toBe('sent');
  });
  it('says why a command failed', () => {
    const store = aStore([
      stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'accepted', status: 'failed', evidence: 'bad_argument' }),
    ]);
    expect(waitingFor(store, aDictionary, soonPlan, Infinity).lines[0]?.value).toContain('bad_argument');
  });
  it('has typed what is missing: the first command again where it was cancelled, nothing while one waits or is under way', () => {
    const said = (reached: NamedStage['stage'], status: NamedStage['status'], evidence = '') =>
      stage({
        command: 1n,
        name: 'EDL_SET_PARAMETERS',
        stage: reached,
        status,
        evidence,
        held: status === 'pending',
      });
    const now = (...words: ReturnType<typeof said>[]) => waitingFor(aStore(words), aDictionary, soonPlan, Infinity);
    expect(now().type).toBe('set edl parameters');
    const held = said('released', 'pending', 'held by Ada');
    expect(now(held)).toMatchObject({
      title: '“set edl parameters” waits on the ground',
      words: 'It has not left yet: it is held until it is released.',
    });
    expect(now(held, said('released', 'failed', 'cancelled by Ada'))).toMatchObject({
      type: 'set edl parameters',
      lines: [{ value: 'cancelled by Ada', holds: false }, { value: 'to be sent' }],
    });
    const sent = [held, said('released', 'ok'), said('radiated', 'ok')];
    expect(now(...sent).title).toBe('Sent. Waiting for the vehicle’s answer');
    expect([now(held).type, now(...sent).type]).toEqual([undefined, undefined]);
    expect(now(...sent, said('executed', 'ok')).type).toBe('do edl');
  });
  it('says when it is too late for the run to begin, by when it had to, and asks for nothing to be typed', () => {
    const run = aRun();
    if (run.clocks) run.clocks = { ...run.clocks, eS: -700, sclk: 300, seenSclk: 300 };
    const late = waitingFor(aStore([], run), aDictionary, aPlan, Infinity, [], { beginBy_e_s: -831 });
    expect(late).toMatchObject({
      title: 'Too late for this run',
      late: true,
      words: expect.stringContaining('E−13:51'),
    });
    expect(late.type).toBeUndefined();
  });
  it('has a moment that comes before the next timepoint as a line, until an event or a tone tells of it', () => {
    const row = (id: number, name: string, anchor: string) =>
      create(TimepointRowSchema, { id, name, anchor, desiredOffsetS: 0, minimumOffsetS: 0 });
    const plan = [
      row(0, 'entry_guidance', 'guidance_start'),
      row(1, 'sufr', 'sufr_start'),
      row(2, 'parachute_deploy', 'parachute'),
    ];
    const now = (...items: Parameters<typeof aStore>[0] & object) =>
      waitingFor(
        aStore([
          ...commanded,
          firing({ timepoint: 0, name: 'entry_guidance', firedSclk: 890 }),
          samples(899, { 4: 2000 }),
          ...items,
        ]),
        aDictionary,
        plan,
        Infinity,
      );
    predictForTest(
      create(PredictionSchema, {
        state: 'ready',
        events: [
          { name: 'peak_deceleration', eS: -90 },
          { name: 'heading_alignment', eS: -80 },
        ],
      }),
    );
    const peak = event({ name: 'PEAK_DECELERATION', sclk: 895 });
    expect(now()).toMatchObject({
      title: 'Waiting for straighten up and fly right (SUFR)',
      before: { name: 'peak deceleration', words: 'predicted at E−1:30', value: 'in ≈ 10 s' },
    });
    expect(now(peak).before?.name).toBe('heading alignment');
    const aligned = tone({ sclk: 898, tone: 35, name: 'heading_alignment' });
    expect(now(peak, aligned).before).toBeUndefined();
    expect(now(firing({ timepoint: 1, name: 'sufr', firedSclk: 898 })).title).toBe('Waiting for parachute deploy');
    predictForTest(create(PredictionSchema, {}));
  });
  it('judges no value beside its bound, gives its age once it is stale, and no condition while nothing comes', () => {
    const words = new Dictionary({
      ...aDictionary.reply,
      channels: [...aDictionary.channels, create(DictionaryChannelSchema, { id: 9, name: 'parachute_speed_mps' })],
    });
    const store = (sclk: number, ...more: Item[]) =>
      aStore([
        ...commanded,
        firing({ timepoint: 1, name: 'entry_interface', firedSclk: 850 }),
        samples(850, { 9: 405 }),
        samples(sclk, { 4: 400 }),
        ...more,
      ]);
    const watched = (sclk: number, ...more: Item[]) =>
      waitingFor(store(sclk, ...more), words, aPlan, Infinity).lines.at(-1);
    expect([watched(899), watched(859, silent('Navigation'))]).toEqual([
      { words: 'speed ≤ 405 m/s', value: '400 m/s', holds: undefined, quantity: 'speed_mps' },
      { words: 'speed ≤ 405 m/s', value: '400 m/s, ◌ 41 s', holds: undefined, quantity: 'speed_mps' },
    ]);
    const met = create(ConditionSchema, {
      quantity: 'speed_mps',
      value: 400,
      comparison: '<=',
      bound: 405,
      holds: true,
    });
    const root = document.createElement('div');
    act(() => {
      useForTest(
        store(899, explanation({ sclk: 899, decision: 'parachute', verdict: 'held', conditions: [met] })),
        words,
      );
      timepoints.value = aPlan;
      render(<WaitingFor />, root);
    });
    const classes = () => [...root.querySelectorAll('li')].map((line) => line.className);
    expect(classes()).toContain('holds');
    act(() => {
      stream.value = { ...stream.value, state: 'lost' };
    });
    expect(new Set(classes())).toEqual(new Set(['unknown']));
    useForTest(undefined, undefined);
    timepoints.value = [];
  });
  it('counts nothing down while there is no connection, since its clock stands still', () => {
    const store = aStore([
      ...commanded,
      firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 880 }),
      samples(899, { 1: 0, 2: 1000 }),
    ]);
    const lines = () => waitingFor(store, aDictionary, aPlan, Infinity).lines.map(({ value, holds }) => [value, holds]);
    const foreseen = () => {
      const next = { id: 1, name: 'entry_interface', e_s: 30, fired: false };
      return waitingFor(aStore(commanded), aDictionary, aPlan.slice(1), Infinity, [next]).lines[0]?.value;
    };
    expect([lines()[0], foreseen()]).toEqual([[expect.stringMatching(/^in /), false], expect.stringMatching(/^in ≈ /)]);
    stream.value = { ...stream.value, state: 'lost' };
    expect([lines()[0], foreseen()]).toEqual([[expect.stringMatching(/^E\+0:00/), undefined], 'predicted E+0:30']);
    stream.value = { ...stream.value, state: 'live' };
  });
  it('says of a mission whose commands are not here that there is nothing to press', () => {
    const listening = (dictionary: typeof aDictionary, items: Parameters<typeof aStore>[0] = []) => {
      const { title, words, type, lines } = waitingFor(aStore(items), dictionary, [], Infinity);
      return [title, words, type, lines];
    };
    const without = (commands: typeof aDictionary.commands) => new Dictionary({ ...aDictionary.reply, commands });
    expect(listening(without([]))).toEqual(['Nothing has come yet', 'This venue has no commands here.', undefined, []]);
    expect(listening(without([]), [samples(899, { 3: 1 })])[0]).toBe('Listening');
    expect(listening(without(aDictionary.commands.slice(0, 1)))[1]).toBe(
      'This venue has none of the commands that begin a landing.',
    );
  });
  it('names the next timepoint and when it is due by the vehicle’s own word', () => {
    const store = aStore([
      ...commanded,
      firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 880 }),
      samples(899, { 1: 0, 2: 1000, 5: 1 }),
    ]);
    const waiting = waitingFor(store, aDictionary, aPlan, Infinity);
    expect(waiting.title).toBe('Next: entry interface');
    expect(waiting.lines[0]).toMatchObject({ words: 'at entry', value: 'in 1 m 40 s', holds: false });
  });
  it('says that an anchor has not happened, and not nothing', () => {
    const store = aStore([
      ...commanded,
      firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
      samples(899, { 1: 0, 2: NaN, 5: 1 }),
    ]);
    expect(waitingFor(store, aDictionary, aPlan, Infinity).lines[0]).toMatchObject({
      words: 'the vehicle declares “parachute”',
      value: 'not yet',
      holds: false,
    });
  });
  it('takes no time of the timepoint before for this one’s, where history has a gap for what is undefined', () => {
    const plan = [
      ...aPlan.slice(0, 2),
      create(TimepointRowSchema, {
        id: 7,
        name: 'parachute_deploy',
        anchor: 'entry',
        desiredOffsetS: 50,
        minimumOffsetS: 2,
        plannedES: 50,
      }),
    ];
    const first = (rows: typeof aPlan, told_sclk: number, cutoff: number) =>
      waitingFor(
        aStore(
          [
            ...commanded,
            firing({ timepoint: 1, name: 'entry_interface', firedSclk: 1000 }),
            samples(told_sclk, { 2: 1000, 5: 1 }),
            samples(1300, { 5: 1 }),
          ],
          aRun({ clocks: undefined as never, startSclk: 1300 }),
        ),
        aDictionary,
        rows,
        cutoff,
        [{ id: 7, name: '', e_s: 50, fired: false }],
      ).lines[0];
    expect(first(plan, 1000, 1005), 'while it is new').toMatchObject({
      words: '50 s after entry',
      value: 'E+0:00.0',
      holds: true,
    });
    expect(first(plan, 1000, 1005.5)).toMatchObject({ value: 'in ≈ 45 s', holds: false });
    expect(first(aPlan, 1000, 1180)).toMatchObject({
      words: 'the vehicle declares “parachute”',
      value: 'no word yet',
      holds: undefined,
    });
    expect(first(aPlan, 1000, 1001), 'what is declared is heard of by its timepoint').toMatchObject({
      value: 'is due',
      holds: false,
    });
  });
  it('shows the condition that is missing, as flight explained it', () => {
    const condition = create(ConditionSchema, {
      quantity: 'speed_mps',
      value: 450,
      comparison: '<=',
      bound: 405,
      holds: false,
    });
    const store = aStore([
      ...commanded,
      firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
      explanation({ sclk: 899, decision: 'parachute', verdict: 'held', conditions: [condition] }),
    ]);
    expect(waitingFor(store, aDictionary, aPlan, Infinity).lines).toContainEqual({
      words: 'speed ≤ 405 m/s',
      value: '450 m/s',
      quantity: 'speed_mps',
      holds: false,
    });
  });
  it('has a fact as yes or no', () => {
    const locked = create(ConditionSchema, { quantity: 'radar_locked', value: 0, comparison: '==', bound: 1 });
    expect(conditionLine(locked)).toEqual({
      words: 'radar locked: yes',
      value: 'no',
      holds: false,
      quantity: 'radar_locked',
    });
  });
  it('takes no other decision’s conditions for its own', () => {
    const condition = create(ConditionSchema, {
      quantity: 'drag_mps2',
      value: 1.8,
      comparison: '>=',
      bound: 1.96,
      holds: false,
    });
    const words = (decision: string, text = '') =>
      waitingFor(
        aStore([
          ...commanded,
          firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
          explanation({ sclk: 899, decision, verdict: 'held', text, conditions: [condition] }),
        ]),
        aDictionary,
        aPlan,
        Infinity,
      ).lines.map((line) => line.words);
    const own = ['the vehicle declares “parachute”', 'drag ≥ 1.960 m/s²'];
    expect(words('heading_alignment')).toEqual(own.slice(0, 1));
    expect(words('timepoint', 'timepoint entry interface held: …')).toEqual(own.slice(0, 1));
    for (const each of [
      words('parachute'),
      words('parachute_deploy'),
      words('timepoint', 'timepoint parachute deploy held: …'),
    ])
      expect(each).toEqual(own);
  });
  it('has the next timepoint as its title, and after one without a name of its own the next named one', () => {
    const plan = [
      ...aPlan.slice(0, 2),
      create(TimepointRowSchema, {
        id: 7,
        name: 'heartbeat_range_control',
        anchor: 'entry',
        desiredOffsetS: 20,
        note: 'Tone only (L)',
        plannedES: 20,
      }),
      ...aPlan.slice(2),
    ];
    const store = aStore([
      ...commanded,
      firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
      samples(899, { 1: 0, 5: 1 }),
    ]);
    const predicted = [
      { id: 7, name: '', e_s: 20, fired: false },
      { id: 2, name: '', e_s: 255, fired: false },
    ];
    expect(waitingFor(store, aDictionary, plan, Infinity, predicted)).toMatchObject({
      title: 'Next: heartbeat range control',
      words: 'Tone only.',
      lines: [{ words: '20 s after entry', value: 'in ≈ 2 m 00 s', holds: false }],
      after: { name: 'parachute deploy', words: 'the vehicle declares “parachute”', value: 'in ≈ 5 m 55 s' },
    });
  });
  it('waits for what the server says in the banner, by its time, until a newer word overtakes it', () => {
    const said = (sentence: string, more: object = {}) =>
      situation('2012-219T04:59:55.0', {
        rank: 'waiting' as const,
        subject: 'step',
        sentence,
        awaited: 'parachute deploy',
        timepoint: 'parachute_deploy',
        at: '2012-219T05:00:10.0',
        ...more,
      });
    const now = (...items: Parameters<typeof aStore>[0] & object) =>
      waitingFor(
        aStore([...commanded, firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 890 }), ...items]),
        aDictionary,
        aPlan,
        Infinity,
        [{ id: 2, name: 'parachute_deploy', e_s: 255, fired: false }],
      );
    expect(now().title).toBe('Next: entry interface');
    expect(now(said('Waiting for parachute deploy, not yet speed ≤ 405.0 m/s at E+4:11'))).toMatchObject({
      title: 'Waiting for parachute deploy',
      lines: [{ value: 'in ≈ 10 s' }],
    });
    expect(
      now(said('Waiting for parachute deploy', { overdue: true, at: '2012-219T04:59:50.0' })).lines[0]?.value,
    ).toBe('overdue since E−1:50');
    const fired = firing({ timepoint: 2, name: 'parachute_deploy', firedSclk: 895 });
    expect(now(said('Waiting for parachute deploy'), fired).title).toBe('The timeline is complete');
    const down = situation('2012-219T04:59:55.0', {
      rank: 'waiting' as const,
      subject: 'recording',
      sentence: 'The recording comes down',
    });
    expect(now(down)).toMatchObject({
      title: 'The recording comes down',
      words: 'Not heard of yet: entry interface, parachute deploy.',
      lines: [],
    });
  });
  it('does not wait for a step as if it could be heard while nothing can be and nothing predicted that', () => {
    const now = (rank: 'news' | 'silence', plan = aPlan) =>
      waitingFor(
        aStore([
          ...commanded,
          firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
          situation('2012-219T04:59:55.0', {
            rank,
            subject: 'vehicle',
            sentence: 'Not heard since E−1:50; when the next word comes is not predicted',
          }),
        ]),
        aDictionary,
        plan,
        Infinity,
        [{ id: 2, name: 'parachute_deploy', e_s: 255, fired: false }],
      );
    const lost = now('news');
    expect([lost.title, lost.words]).toEqual([
      'Predicted: parachute deploy',
      'Not heard since E−1:50: no word of it can come.',
    ]);
    expect(lost.lines.map(({ holds }) => holds)).toEqual(lost.lines.map(() => undefined));
    expect(lost.lines[0]?.value).toMatch(/^in ≈ /);
    const foreseen = now('silence');
    expect([foreseen.title, foreseen.lines[0]?.holds]).toEqual(['Waiting for parachute deploy', false]);
  });
  it('has a lower and an upper bound of one quantity as one range', () => {
    const thrust = (comparison: string, bound: number) =>
      create(ConditionSchema, { quantity: 'thrust_N', value: 3300, comparison, bound, holds: comparison === '<=' });
    expect(conditionLines([thrust('>=', 3500), thrust('<=', 4500)])).toEqual([
      { words: 'thrust 3500 to 4500 N', value: '3300 N', holds: false, quantity: 'thrust_N' },
    ]);
  });
  it('knows by tone what has fired where UHF is silent, and says that it is by tone', () => {
    const plan = aPlan.map((row) => ({ ...row, tone: row.name }));
    const store = aStore([...commanded, tone({ sclk: 890, tone: 29, name: 'entry_interface' })]);
    expect(waitingFor(store, aDictionary, plan, Infinity)).toMatchObject({
      title: 'Waiting for parachute deploy',
      byTone: 'entry interface, E−1:50',
    });
    const erased = aStore([...commanded, tone({ sclk: 890, name: 'entry_interface', likelihood: 0.3 })]);
    expect(waitingFor(erased, aDictionary, plan, Infinity).title).toBe('Next: coolant vent');
  });
  it('in a past view has the commands as they were known then, and asks for nothing to be pressed', () => {
    const words = (at: string) => [
      stage({ command: 1n, name: 'EDL_SET_PARAMETERS', stage: 'queued', status: 'ok', ert: at }),
      stage({ command: 1n, stage: 'executed', status: 'ok', ert: at }),
    ];
    const past = (cutoff: number) => waitingFor(aStore(words('2012-219T04:59:00.0')), aDictionary, soonPlan, cutoff); // 60 s ago: SCLK 840
    expect([past(830).title, past(830).lines[0]?.value]).toEqual([
      '“set edl parameters” had not been sent',
      'to be sent',
    ]);
    expect([past(850).title, past(850).lines[0]?.value]).toEqual(['“do edl” had not been sent', 'executed']);
  });
  it('ends with the outcome', () => {
    expect(
      waitingFor(
        aStore([], aRun({ state: 'finished', outcome: 'touchdown', relayProgress: 1 })),
        aDictionary,
        aPlan,
        Infinity,
      ).title,
    ).toBe('Touchdown');
    const report = { verdict: 'confirmed' as const, steps: [], figures: [], place_unknown: '' };
    touchdownAnswer.value = { at: Infinity, live: false, report };
    const landed = aStore([], aRun({ state: 'finished', outcome: 'touchdown', relayProgress: 1 }));
    expect(waitingFor(landed, aDictionary, aPlan, Infinity).title).toBe('Touchdown confirmed');
    touchdownAnswer.value = undefined;
    const lost = situation(
      '2012-219T04:59:55.0',
      {
        rank: 'lasting' as const,
        subject: 'loss of station',
        sentence: 'Station was lost from E+3:00 to E+4:00: a fault on the ground',
      },
      { rank: 'news' as const, subject: 'landed', sentence: 'Touchdown reported at E+7:18' },
    );
    expect(
      waitingFor(aStore([lost], aRun({ state: 'finished', outcome: 'touchdown' })), aDictionary, aPlan, Infinity).words,
    ).toMatch(/^▲ Station was lost from E\+3:00 to E\+4:00: a fault on the ground\. Outcome: touchdown/);
    const cutOff = (venue: string) =>
      waitingFor(aStore([], aRun({ state: 'interrupted', venue })), aDictionary, aPlan, Infinity);
    expect([
      cutOff('rehearsal').title,
      cutOff('rehearsal').words.includes('the panel Runs continues it'),
      cutOff('downlink').title,
      cutOff('downlink').words.includes('cannot be continued'),
    ]).toEqual(['Interrupted', true, 'Interrupted', true]);
  });
});

describe('the recording’s way down', () => {
  const down = [...commanded, ...aPlan.map((row) => firing({ timepoint: row.id, name: row.name, firedSclk: 890 }))];
  const shown = (mode: Parameters<typeof aRun>[0]) => {
    const root = document.createElement('div');
    document.body.append(root);
    const heard: ToWorker[] = [];
    act(() => {
      access.value = { state: 'open' };
      timepoints.value = aPlan;
      useForTest(
        aStore(down, aRun({ relayProgress: 0.25, ...mode })),
        aDictionary,
        (message) => void heard.push(message),
      );
      render(<WaitingFor />, root);
    });
    return { root, heard, button: root.querySelector<HTMLButtonElement>('[data-testid="stop-downlink"]') };
  };
  it('has a bar, and can be stopped by two presses, which ends the run with what has come', () => {
    const { root, heard, button } = shown({});
    expect([root.querySelector('progress')?.value, button?.textContent]).toEqual([
      0.25,
      'stop here, with what has come',
    ]);
    act(() => button?.click());
    expect([heard, button?.textContent]).toEqual([[], '▲ press again: run 1 ends for everyone']);
    act(() => button?.click());
    expect(heard).toEqual([{ type: 'control', run: 1, control: { action: 'stop' } }]);
  });
  it('of a real vehicle is nobody’s to stop here', () => {
    const { root, button } = shown({ venue: 'downlink' });
    expect([root.querySelector('progress')?.value, button]).toEqual([0.25, null]);
  });
});
