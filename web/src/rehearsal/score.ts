// SPDX-License-Identifier: Apache-2.0
// The facts and the score of a rehearsal: facts with their times from recorded data, and a score by a stated rule
// (docs/console.md). Pure.
import type { AsFlownReport } from '../gen/aeolis/v1/run_pb';
import { STAGES, STATUSES } from '../commands/model';
import { inWords } from '../run/dictionary';
import { duration, fromEntry, secondsOfErt } from '../run/time';
import { faultWords } from './faults';
import type { Intervention } from './instructor';

/** An item of /alarms in the API's words. */
export interface AlarmChange {
  ert_us: string;
  alarm?: { channel: number; severity: string; sclk: number; limit?: string };
  link?: { link: string; lost?: boolean };
  staleness?: { packet: string; stale: boolean; reason?: string };
  alarm_action?: { alarm: string; action: string; by?: string };
}
export interface Landed {
  e_s: number;
  words: string; // flight's own
  miss_m: number | undefined; // from the target, by navigation on board
}
export interface Recorded {
  outcome: string; // in words
  landed: Landed | undefined;
  report: AsFlownReport;
  alarms: readonly AlarmChange[];
  interventions: readonly Intervention[];
  /** Seconds from entry of the signal that reached Earth at `ert_s`, seconds since 1970. */
  e_sOf: (ert_s: number) => number;
  channelName: (id: number) => string;
  isHazardous: (command: string) => boolean;
}
export interface Fact {
  of: string;
  text: string;
  e_s?: number; // of the signal heard on Earth then
}
interface Term {
  name: string;
  most: number;
  share: number; // 0 … 1
  why: string;
}
export interface Score {
  facts: Fact[];
  terms: Term[]; // only terms with something to judge
  sum: number; // of 100
}

// All chosen: the worth of each term, and the bounds of promptness.
const WORTH = { landing: 40, timepoints: 20, faults: 20, alarms: 10, commands: 10 };
const TOUCHDOWN = 1; // Landing.Outcome.touchdown, so that the page need not load the schema
const QUICK_S = 30; // full worth up to here
const LATE_S = 300; // no worth from here on

export const promptness = (after_s: number | undefined): number =>
  after_s === undefined ? 0 : Math.min(1, Math.max(0, (LATE_S - after_s) / (LATE_S - QUICK_S)));
const mean = (shares: readonly number[]): number => shares.reduce((sum, share) => sum + share, 0) / shares.length;
const count = (many: number, one: string): string => `${many} ${one}${many === 1 ? '' : 's'}`;

/** Distance over ground between two directions from the centre of Mars. */
export function miss_m(
  position_m: readonly number[],
  latitude_deg: number,
  longitude_deg: number,
  radius_m: number,
): number {
  const [latitude, longitude] = [latitude_deg, longitude_deg].map((angle) => (angle * Math.PI) / 180) as [
    number,
    number,
  ];
  const target = [
    Math.cos(latitude) * Math.cos(longitude),
    Math.cos(latitude) * Math.sin(longitude),
    Math.sin(latitude),
  ];
  const cosine = target.reduce((sum, each, i) => sum + each * (position_m[i] as number), 0) / Math.hypot(...position_m);
  return radius_m * Math.acos(Math.min(1, cosine));
}

interface Raised {
  name: string;
  limit: string;
  e_s: number;
  acknowledged: { after_s: number; by: string } | undefined;
}

/** Each alarm from its raising, or raising again, to the first acknowledgement. */
export function raisedAlarms({ alarms, report, e_sOf, channelName }: Recorded): Raised[] {
  const raised: Raised[] = [];
  const open = new Map<string, Raised>(); // outside its limits, or not acknowledged yet
  const inside = new Set<string>();
  const raise = (name: string, limit: string, e_s: number) => {
    const known = open.get(name);
    if (known && !(known.acknowledged && inside.has(name))) return void inside.delete(name);
    const one: Raised = { name, limit, e_s, acknowledged: undefined };
    inside.delete(name);
    open.set(name, one);
    raised.push(one);
  };
  for (const { ert_us, alarm, link, staleness, alarm_action: action } of alarms) {
    const e_s = e_sOf(secondsOfErt(ert_us));
    if (alarm) {
      const name = channelName(alarm.channel);
      if (alarm.severity === 'none') inside.add(name);
      else raise(name, alarm.limit ?? '', alarm.sclk - (report.run?.entrySclk ?? 0));
    } else if (link) {
      if (link.lost) raise(link.link, 'lost', e_s);
      else inside.add(link.link);
    } else if (staleness) {
      if (staleness.stale) raise(staleness.packet, 'silent', e_s);
      else inside.add(staleness.packet);
    } else if (action?.action === 'acknowledge') {
      const one = open.get(action.alarm);
      if (one && !one.acknowledged) one.acknowledged = { after_s: e_s - one.e_s, by: action.by || 'unsigned' };
    }
  }
  return raised;
}

interface CommandOutcome {
  name: string;
  number: number;
  e_s: number;
  how: 'done' | 'failed' | 'cancelled' | 'not known';
  why: string;
  /** Name of the person who signed it; undefined: sent by the scenario's own script. */
  sender?: string;
}

const OF_SCRIPT = "asked for by the scenario's script"; // the gateway's words
// evidence of the stage authorised
const SIGNED = /^(?:armed and confirmed by name|no arming needed), by (.+?)(?:; left to flight: .*)?$/s;

function senderOf(words: readonly { stage: string; evidence: string }[]): string | undefined {
  if (words.some(({ stage, evidence }) => stage === 'queued' && evidence.startsWith(OF_SCRIPT))) return undefined;
  return (
    words.flatMap(({ stage, evidence }) => (stage === 'authorised' ? (SIGNED.exec(evidence)?.[1] ?? []) : []))[0] ??
    'someone'
  );
}

/** The outcome of each command, by the last word on each of its stages. */
export function commandOutcomes({ report, e_sOf }: Recorded): CommandOutcome[] {
  return report.commands.map((command) => {
    const words = command.stages.flatMap(({ item: { case: kind, value } }) =>
      kind === 'commandStage'
        ? [{ evidence: value.evidence, stage: STAGES[value.stage] ?? '', status: STATUSES[value.status] }]
        : [],
    );
    const first = command.stages[0];
    const last = new Map(words.map((word) => [word.stage, word]));
    const failed = [...last.values()].find((stage) => stage.status === 'failed');
    const done = [...last.values()].every((stage) => stage.status === 'ok') && last.has('executed');
    const cancelled = failed?.evidence.startsWith('cancelled') ?? false;
    return {
      name: command.name,
      number: Number(command.command),
      e_s: first ? e_sOf(secondsOfErt(first.ertUs)) : NaN,
      how: cancelled ? 'cancelled' : failed ? 'failed' : done ? 'done' : 'not known',
      why: failed?.evidence ?? '',
      sender: senderOf(words),
    };
  });
}

interface Reaction {
  e_s: number;
  words: string;
}

/** Actions of people in order of time. Whether one was a reaction to a fault only they can say. */
function reactions(of: Recorded): Reaction[] {
  const acts: Reaction[] = [];
  for (const { ert_us, alarm_action: action } of of.alarms) {
    if (action)
      acts.push({
        e_s: of.e_sOf(secondsOfErt(ert_us)),
        words: `${action.by || 'someone'}: ${action.action} ${action.alarm}`,
      });
  }
  for (const { e_s, name, sender } of commandOutcomes(of))
    if (sender) acts.push({ e_s, words: `${sender}: sent ${name}` });
  for (const { ertUs, item } of of.report.notes) {
    if (item.case === 'note')
      acts.push({
        e_s: of.e_sOf(secondsOfErt(ertUs)),
        words: `${item.value.by || 'someone'} wrote “${item.value.text}”`,
      });
  }
  return acts.filter((act) => Number.isFinite(act.e_s)).sort((a, b) => a.e_s - b.e_s);
}

/** From the time at which a fault's effect can be heard on Earth to the first action of a person. */
function faultFacts(of: Recorded): { facts: Fact[]; shares: number[] } {
  const acts = reactions(of);
  const shares: number[] = [];
  const facts = of.interventions.flatMap(({ e_s, fault }) => {
    if (!fault) return [];
    // a station's outage is felt on Earth itself
    const felt_s = fault.station_outage ? e_s - (of.report.run?.lightTimeS ?? 0) : e_s;
    const first = acts.find((act) => act.e_s >= felt_s);
    shares.push(promptness(first && first.e_s - felt_s));
    return [
      {
        of: 'fault',
        e_s: felt_s,
        text: `${faultWords(fault)}; ${first ? `${duration(first.e_s - felt_s)} later: ${first.words}` : 'nobody did anything afterwards'}`,
      },
    ];
  });
  return { facts, shares };
}

function alarmFacts(raised: readonly Raised[]): Fact[] {
  return raised.map(({ name, limit, e_s, acknowledged }) => ({
    of: 'alarm',
    e_s,
    text: `${inWords(name)} ${limit}; ${acknowledged ? `acknowledged ${duration(acknowledged.after_s)} later by ${acknowledged.by}` : 'never acknowledged'}`,
  }));
}

function commandFacts(commands: readonly CommandOutcome[], isHazardous: (command: string) => boolean): Fact[] {
  const sentBy = (theirs: readonly CommandOutcome[], whose: string): Fact => {
    const many = (how: CommandOutcome['how']) => theirs.filter((command) => command.how === how).length;
    return {
      of: 'commands',
      text: `${count(theirs.length, 'command')} ${whose}: ${many('done')} carried out, ${many('failed')} failed, ${many('cancelled')} cancelled, ${many('not known')} not known`,
    };
  };
  const scripted = commands.filter((command) => !command.sender);
  return [
    sentBy(
      commands.filter((command) => command.sender),
      'of people',
    ),
    ...(scripted.length > 0 ? [sentBy(scripted, 'of the scenario’s script')] : []),
    ...commands
      .filter((command) => command.how === 'failed' || command.how === 'cancelled')
      .map((command) => ({
        of: 'command',
        e_s: command.e_s,
        text: `${command.number} ${command.name}${isHazardous(command.name) ? ', hazardous' : ''}${command.sender ? `, by ${command.sender}` : ''}: ${command.why}`,
      })),
  ];
}

function dataFacts(report: AsFlownReport): Fact[] {
  const total = (key: 'realtime' | 'identical' | 'differs' | 'missingInRecording') =>
    (report.proof?.streams ?? []).reduce((sum, row) => sum + Number(row[key]), 0);
  const frames = (report.proof?.counters ?? []).reduce(
    (sum, row) => sum + Number(row.missingFrames) + Number(row.badCrc),
    0,
  );
  return [
    {
      of: 'data',
      text: `${count(total('realtime'), 'packet')} heard live: ${total('missingInRecording')} missing in the recording, ${total('differs')} differ from it; ${count(frames, 'frame')} lost on the way`,
    },
    { of: 'data', text: `${count(Number(report.tonesDecoded), 'tone')} decoded, ${Number(report.tonesErased)} lost` },
  ];
}

export function score(of: Recorded): Score {
  const { report, landed } = of;
  const all = report.timepoints.length;
  const missing = report.timepoints.filter(
    (row) => row.recordedES === undefined && row.realtimeES === undefined && row.toneES === undefined,
  );
  const raised = raisedAlarms(of);
  const commands = commandOutcomes(of);
  const faults = faultFacts(of);
  const judged = commands.filter((command) => command.sender && command.how !== 'cancelled');
  const facts: Fact[] = [
    { of: 'landing', text: of.outcome, ...(landed && { e_s: landed.e_s }) },
    ...(landed ? [{ of: 'landing', text: landed.words }] : []),
    ...(landed?.miss_m !== undefined
      ? [
          {
            of: 'landing',
            text: `${(landed.miss_m / 1000).toFixed(1)} km from the target, by the vehicle’s own navigation`,
          },
        ]
      : []),
    {
      of: 'timepoints',
      text: `${all - missing.length} of ${all} are known to have fired${
        missing.length > 0
          ? `; not: ${missing
              .slice(0, 6)
              .map((row) => inWords(row.name))
              .join(', ')}${missing.length > 6 ? ' …' : ''}`
          : ''
      }`,
    },
    ...dataFacts(report),
    ...alarmFacts(raised),
    ...faults.facts,
    ...commandFacts(commands, of.isHazardous),
  ];
  const terms: Term[] = [
    { name: 'landing', most: WORTH.landing, share: report.run?.outcome === TOUCHDOWN ? 1 : 0, why: of.outcome },
    ...(all > 0
      ? [
          {
            name: 'timepoints',
            most: WORTH.timepoints,
            share: (all - missing.length) / all,
            why: `${all - missing.length} of ${all}`,
          },
        ]
      : []),
    ...(faults.shares.length > 0
      ? [
          {
            name: 'faults',
            most: WORTH.faults,
            share: mean(faults.shares),
            why: `${count(faults.shares.length, 'fault')}, by the first reaction`,
          },
        ]
      : []),
    ...(raised.length > 0
      ? [
          {
            name: 'alarms',
            most: WORTH.alarms,
            share: mean(raised.map((one) => promptness(one.acknowledged?.after_s))),
            why: `${count(raised.length, 'alarm')}, by the acknowledgement`,
          },
        ]
      : []),
    ...(judged.length > 0
      ? [
          {
            name: 'commands',
            most: WORTH.commands,
            share: judged.filter((command) => command.how === 'done').length / judged.length,
            why: `${judged.filter((command) => command.how === 'done').length} of ${judged.length} of people were carried out`,
          },
        ]
      : []),
  ];
  const most = terms.reduce((sum, term) => sum + term.most, 0);
  return { facts, terms, sum: (100 * terms.reduce((sum, term) => sum + term.most * term.share, 0)) / most };
}

export const termWords = (term: Term): string => `${(term.most * term.share).toFixed(1)} of ${term.most}`;
export const RULE = `Our own rule, no verdict on people: each term that there was something to judge by, as a share of what all of those are worth. Commands of the scenario’s script do not count. Within ${QUICK_S} s a reaction counts in full, after ${LATE_S} s not at all. Times are the run’s: at 10× a second of yours is ten of them.`;

/** The review as text, for copying. */
export function scoreText(title: string, of: Score, interventions: readonly Intervention[]): string {
  const at = (e_s: number | undefined) => (e_s === undefined ? '' : `${fromEntry(e_s, { tenths: true })} `);
  return [
    title,
    '',
    ...of.facts.map((fact) => `${fact.of}: ${at(fact.e_s)}${fact.text}`),
    '',
    ...interventions.flatMap(({ e_s, note }) =>
      note ? [`instructor's note: ${at(e_s)}${note.by || 'unsigned'}: ${note.text}`] : [],
    ),
    `score: ${of.sum.toFixed(0)} of 100`,
    ...of.terms.map((term) => `  ${term.name}: ${termWords(term)} (${term.why})`),
    RULE,
    '',
  ].join('\n');
}
