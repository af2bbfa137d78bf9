// SPDX-License-Identifier: Apache-2.0
// Enumerations of the stream by their names in the schema, as in JSON. Numbers stay in the worker; the page compares
// and draws names.
import {
  Alarm_Severity,
  Carrier_Lock,
  CommandStage_Stage,
  CommandStage_Status,
  Event_Level,
  LinkChange_Silence,
  SituationEntry_Rank,
  TimepointFiring_Verdict,
} from '../gen/aeolis/v1/items_pb';
import type {
  Alarm,
  CommandStage,
  Event,
  Item,
  LinkChange,
  SituationEntry,
  TimepointFiring,
  Tone,
} from '../gen/aeolis/v1/items_pb';
import { Landing_Outcome, RunState_State } from '../gen/aeolis/v1/run_pb';
import type { RunState } from '../gen/aeolis/v1/run_pb';

type Named<Message, Names> = Omit<Message, keyof Names> & Names;
export type NamedEvent = Named<Event, { level: keyof typeof Event_Level }>;
export type NamedTone = Named<Tone, { lock: keyof typeof Carrier_Lock }>;
/** `silence`: the ground's class of it; undefined while the link is up, or before the ground has one. */
export type NamedLink = Named<LinkChange, { silence: keyof typeof LinkChange_Silence | undefined }>;
export type NamedAlarm = Named<Alarm, { severity: keyof typeof Alarm_Severity }>;
export type NamedStage = Named<
  CommandStage,
  { stage: keyof typeof CommandStage_Stage; status: keyof typeof CommandStage_Status }
>;
export type NamedFiring = Named<TimepointFiring, { verdict: keyof typeof TimepointFiring_Verdict }>;

export type NamedRun = Named<RunState, { state: keyof typeof RunState_State; outcome: keyof typeof Landing_Outcome }>;

export type NamedEntry = Named<SituationEntry, { rank: keyof typeof SituationEntry_Rank }>;
export interface NamedSituation {
  entries: NamedEntry[];
}

/** The number of a value that this console does not know. */
const nameOf = <Names extends object>(names: Names, value: number) =>
  ((names as Record<number, string>)[value] ?? String(value)) as keyof Names;

export const namedRun = (run: RunState): NamedRun => ({
  ...run,
  state: nameOf(RunState_State, run.state),
  outcome: nameOf(Landing_Outcome, run.outcome),
});

/** The content of an item, with names for enumerations. */
export function named(item: Item['item']) {
  switch (item.case) {
    case 'event':
      return { ...item.value, level: nameOf(Event_Level, item.value.level) };
    case 'tone':
      return { ...item.value, lock: nameOf(Carrier_Lock, item.value.lock) };
    case 'alarm':
      return { ...item.value, severity: nameOf(Alarm_Severity, item.value.severity) };
    case 'commandStage':
      return {
        ...item.value,
        stage: nameOf(CommandStage_Stage, item.value.stage),
        status: nameOf(CommandStage_Status, item.value.status),
      };
    case 'link': {
      const { silence } = item.value;
      return { ...item.value, silence: silence === undefined ? undefined : nameOf(LinkChange_Silence, silence) };
    }
    case 'timepoint':
      return { ...item.value, verdict: nameOf(TimepointFiring_Verdict, item.value.verdict) };
    case 'situation':
      return {
        entries: item.value.entries.map((entry) => ({ ...entry, rank: nameOf(SituationEntry_Rank, entry.rank) })),
      };
    case 'procedureAct':
      return {}; // the page asks for what it shows of these
    default:
      return item.value;
  }
}
