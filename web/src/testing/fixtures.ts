// SPDX-License-Identifier: Apache-2.0
// Messages of the schema for tests, built field by field. No values resemble a landing.
import { create } from '@bufbuild/protobuf';
import type { DescMessage, MessageInitShape } from '@bufbuild/protobuf';
import {
  AlarmSchema,
  Alarm_Severity,
  Carrier_Lock,
  ClocksSchema,
  CommandStageSchema,
  CommandStage_Stage,
  CommandStage_Status,
  EventSchema,
  Event_Level,
  ExplanationSchema,
  ItemSchema,
  LinkChangeSchema,
  SamplesSchema,
  SituationEntrySchema,
  SituationEntry_Rank,
  SituationSchema,
  StalenessSchema,
  TimepointFiringSchema,
  TimepointFiring_Verdict,
  ToneSchema,
  PacketSchema,
} from '../gen/aeolis/v1/items_pb';
import type { Item } from '../gen/aeolis/v1/items_pb';
import {
  DictionaryReplySchema,
  Landing_Outcome,
  RunStateSchema,
  RunState_State,
  TimepointRowSchema,
} from '../gen/aeolis/v1/run_pb';
import { BatchSchema } from '../gen/aeolis/v1/stream_pb';
import { Dictionary } from '../run/dictionary';
import type { LimitsAnswer } from '../run/limits';
import { RunStore } from '../run/store';
import { secondsOfDayOfYear, secondsOfErt } from '../run/time';
import { ColumnCollector } from '../stream/columns';
import type { NamedRun } from '../stream/names';

export const ENTRY_SCLK = 1000;

export function aRun({
  state = 'running',
  outcome = 'running',
  ...fields
}: Fields<typeof RunStateSchema, Partial<Pick<NamedRun, 'state' | 'outcome'>>> = {}): NamedRun {
  const run = create(RunStateSchema, {
    run: 1n,
    scenario: 'nominal',
    venue: 'rehearsal',
    pace: 1,
    entrySclk: ENTRY_SCLK,
    startSclk: 0,
    clocks: create(ClocksSchema, {
      sclk: 900,
      seenSclk: 900,
      eS: -100,
      ertUs: ertUs('2012-219T05:00:00.0'),
      scetUs: ertUs('2012-219T05:00:00.0'),
    }),
    ...fields,
  });
  return { ...run, state, outcome };
}

/** The run as in an answer of the server. */
export const wireRun = (run: NamedRun) =>
  create(RunStateSchema, { ...run, state: RunState_State[run.state], outcome: Landing_Outcome[run.outcome] });

export const aDictionary = new Dictionary(
  create(DictionaryReplySchema, {
    channels: [
      {
        id: 1,
        name: 'edl_phase',
        packet: 'Status',
        labels: [
          { value: 0n, label: 'late_cruise' },
          { value: 4n, label: 'range_control' },
          { value: 9n, label: 'landed' },
        ],
        expectedRateHz: 1,
      },
      { id: 2, name: 'next_desired_sclk', packet: 'Status', unit: 's', expectedRateHz: 1 },
      {
        id: 3,
        name: 'altitude_m',
        alias: 'GNC-0101',
        packet: 'Navigation',
        unit: 'm',
        limits: [{ severity: 'warning', above: 200000 }],
        expectedRateHz: 8,
      },
      {
        id: 4,
        name: 'speed_mps',
        alias: 'GNC-0102',
        packet: 'Navigation',
        unit: 'm/s',
        expectedRateHz: 8,
        limits: [
          { severity: 'watch', above: 6000 },
          { severity: 'watch', above: 90, context: 'range_control' },
          { severity: 'distress', above: 120, context: 'range_control' },
        ],
      },
      { id: 5, name: 'parameters_received', packet: 'Status' },
    ],
    commands: [
      { opcode: 1, name: 'NO_OP', significance: 'none' },
      {
        opcode: 2,
        name: 'EDL_SET_PARAMETERS',
        significance: 'none',
        arguments: [
          { name: 'solution_id', integer: true, min: 1, max: 65535 },
          { name: 'parachute_speed_mps', unit: 'm/s', min: 380, max: 430, defaultValue: 405 },
        ],
      },
      {
        opcode: 3,
        name: 'EDL_DO_EDL',
        significance: 'critical',
        reasonForWarning: 'Starts the timeline',
        preconditions: ['parameters received'],
        conditions: [{ channel: 5, comparison: '==', value: 1 }],
      },
      {
        opcode: 4,
        name: 'EDL_SET_TIMEPOINT_OFFSET',
        significance: 'none',
        arguments: [{ name: 'timepoint', integer: true }],
      },
    ],
    tones: [{ id: 7, name: 'entry', meaning: 'Entry interface' }],
  }),
);

/** The server's answer of the speed's limits: range control from SCLK 800 to 850. */
export const speedLimits: LimitsAnswer = {
  decided_by: [1],
  channels: [
    {
      id: 4,
      stretches: [
        { to_sclk: 800, context: '', limits: [{ severity: 'watch', above: 6000 }] },
        {
          from_sclk: 800,
          to_sclk: 850,
          context: 'range_control',
          limits: [
            { severity: 'watch', above: 90 },
            { severity: 'distress', above: 120 },
          ],
        },
        { from_sclk: 850, context: '', limits: [{ severity: 'watch', above: 6000 }] },
      ],
    },
  ],
};

export const aPlan = [
  create(TimepointRowSchema, {
    id: 0,
    name: 'coolant_vent',
    anchor: 'entry',
    desiredOffsetS: -826,
    minimumOffsetS: 0,
    plannedES: -826,
  }),
  create(TimepointRowSchema, {
    id: 1,
    name: 'entry_interface',
    anchor: 'entry',
    desiredOffsetS: 0,
    minimumOffsetS: 0,
    plannedES: 0,
  }),
  create(TimepointRowSchema, {
    id: 2,
    name: 'parachute_deploy',
    anchor: 'parachute',
    desiredOffsetS: 0,
    minimumOffsetS: 0,
    note: 'GNC says when',
  }),
];

/** Converts a day-of-year text to the stream's microseconds. '': before everything else. */
export const ertUs = (text: string): bigint =>
  text === '' ? 0n : BigInt(Math.round((secondsOfDayOfYear(text) - secondsOfErt(0n)) * 1e6));

let seq = 0;
export function item(value: Item['item'], ert = ''): Item {
  return create(ItemSchema, { seq: BigInt(++seq), ertUs: ertUs(ert), item: value });
}
/** Adds to the fields of a message the ERT of its item as a text, and names of enumerations. */
type Fields<Schema extends DescMessage, Names = object> = Omit<MessageInitShape<Schema>, keyof Names | '$typeName'> &
  Names & { ert?: string };
export const event = ({
  ert,
  level = 'ACTIVITY_HI',
  ...fields
}: Fields<typeof EventSchema, { level?: keyof typeof Event_Level }>) =>
  item({ case: 'event', value: create(EventSchema, { source: 1, level: Event_Level[level], ...fields }) }, ert);
export const tone = ({
  ert,
  ertStart = '',
  lock = 'locked',
  ...fields
}: Fields<typeof ToneSchema, { lock?: keyof typeof Carrier_Lock; ertStart?: string }>) =>
  item(
    {
      case: 'tone',
      value: create(ToneSchema, { likelihood: 1, ertStartUs: ertUs(ertStart), lock: Carrier_Lock[lock], ...fields }),
    },
    ert,
  );
export const firing = ({
  verdict = 'completed',
  ...fields
}: Fields<typeof TimepointFiringSchema, { verdict?: keyof typeof TimepointFiring_Verdict }>) =>
  item({
    case: 'timepoint',
    value: create(TimepointFiringSchema, {
      source: 1,
      verdict: TimepointFiring_Verdict[verdict],
      triggeredSclk: fields.firedSclk ?? 0,
      ...fields,
    }),
  });
export const explanation = (fields: MessageInitShape<typeof ExplanationSchema>) =>
  item({ case: 'explanation', value: create(ExplanationSchema, { source: 1, ...fields }) });
export const link = ({ ert, ...fields }: Fields<typeof LinkChangeSchema>) =>
  item({ case: 'link', value: create(LinkChangeSchema, fields) }, ert);
export const staleness = ({ ert, ...fields }: Fields<typeof StalenessSchema>) =>
  item({ case: 'staleness', value: create(StalenessSchema, fields) }, ert);
/** The ground's word, a second before the clocks of `aRun`, that nothing of a packet comes any more. */
export const silent = (packet: string) => staleness({ packet, stale: true, ert: '2012-219T04:59:59.0' });
/** Times of entries as day-of-year texts. */
export const situation = (
  ert: string,
  ...entries: (Omit<MessageInitShape<typeof SituationEntrySchema>, 'rank' | '$typeName'> & {
    rank: keyof typeof SituationEntry_Rank;
  })[]
) =>
  item(
    {
      case: 'situation',
      value: create(SituationSchema, {
        entries: entries.map(({ rank, since = '', at = '', ...fields }) =>
          create(SituationEntrySchema, {
            ...fields,
            rank: SituationEntry_Rank[rank],
            sinceUs: ertUs(since),
            ...(at !== '' && { atUs: ertUs(at) }),
          }),
        ),
      }),
    },
    ert,
  );
export const alarm = ({
  severity = 'none',
  ...fields
}: Fields<typeof AlarmSchema, { severity?: keyof typeof Alarm_Severity }>) =>
  item({ case: 'alarm', value: create(AlarmSchema, { severity: Alarm_Severity[severity], ...fields }) });
export const stage = ({
  ert,
  stage: reached = 'queued',
  status = 'pending',
  ...fields
}: Fields<
  typeof CommandStageSchema,
  { stage?: keyof typeof CommandStage_Stage; status?: keyof typeof CommandStage_Status }
>) =>
  item(
    {
      case: 'commandStage',
      value: create(CommandStageSchema, {
        stage: CommandStage_Stage[reached],
        status: CommandStage_Status[status],
        ...fields,
      }),
    },
    ert,
  );
export const unit = ({ ert, ...fields }: Fields<typeof PacketSchema>) =>
  item({ case: 'unit', value: create(PacketSchema, { source: 1, link: 'uhf_live', ...fields }) }, ert);
export const samples = (
  sclk: number,
  values: Record<number, number>,
  source = 1,
  { ert, ...more }: Fields<typeof SamplesSchema> = {},
) =>
  item(
    {
      case: 'samples',
      value: create(SamplesSchema, {
        sclk,
        ids: Object.keys(values).map(Number),
        values: Object.values(values),
        source,
        ...more,
      }),
    },
    ert,
  );

export function aBatch(items: Item[], completeThrough = seq) {
  return create(BatchSchema, { run: 1n, completeThrough: BigInt(completeThrough), items });
}

export function aStore(items: Item[] = [], run = aRun()): RunStore {
  const store = new RunStore(run);
  const collector = new ColumnCollector();
  collector.add(aBatch(items));
  store.add(collector.take());
  return store;
}
