// SPDX-License-Identifier: Apache-2.0
// The prepared text of an anomaly report: what the console knows at one instant, a line for each fact. Pure: the
// instant comes in as an argument, and nothing is asked of the server.
import { wantsLook } from '../alarms/model';
import type { AlarmState } from '../alarms/model';
import { channelRow, staleWords } from '../channels/model';
import { badgeOf } from '../clocks/model';
import { newestEvidence, stageCells } from '../commands/model';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { linkTitle, linkViews } from '../links/model';
import type { LinkView } from '../links/model';
import { MODES } from '../mode/model';
import type { Mode } from '../mode/model';
import { OCTETS } from '../notes/model';
import type { Dictionary } from '../run/dictionary';
import { numberText } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { dayOfYear, fromEntry } from '../run/time';
import type { Situation } from '../situation/model';

/** What the page shows at one instant. */
export interface Instant {
  /** The run as every panel shows it. */
  run: RunStore;
  dictionary: Dictionary;
  mode: Mode;
  /** The part of the run that is shown as the past, in seconds from entry; undefined: none is. */
  past: { from: number; to: number } | undefined;
  withRecording: boolean;
  /** Whether the connection is lost: nothing is of now. */
  lost: boolean;
  /** Whether the page has yet to receive a part of what is known of the run. */
  catchingUp: boolean;
  situation: Situation;
  /** The ground's list of alarms; undefined: it has not come, or is not of this instant. */
  alarms: readonly AlarmState[] | undefined;
  /** Names of the commands that are armed, not sent. */
  armed: readonly string[];
  /** The procedures under way, a line each. */
  procedures: readonly string[];
  /** Names of the channels whose values are in sight. */
  inSight: readonly string[];
}

export interface Report {
  run: RunStore;
  /** Its instant, by the clock from entry. */
  at: string;
  /** The same for the note; undefined: the time of entry is not known, so a note cannot show it. */
  sclk: number | undefined;
  /** How the run is viewed, for the first line; empty: as it is heard now. */
  view: string;
  text: string;
}

const LISTED = 10; // chosen: alarms, and commands; more are counted
const ROOM = 600; // chosen: octets for the first line, with the longest cause, and for a few words of one's own
export const CAUSE_LETTERS = 150; // chosen: a sentence; at most three octets each

export function reportOf(instant: Instant): Report {
  const { run, dictionary, mode, past, withRecording } = instant;
  const sclk = Math.min(run.seenSclk, cutoffOf(instant));
  const at = timeOf(run, sclk, true);
  const badge = badgeOf(run, past, mode === 'replay');
  const lines = [
    `At ${at}, on Earth (ERT) ${dayOfYear(run.ertOf(sclk))}, SCLK ${sclk.toFixed(3)}`,
    `${badge.title}: ${badge.detail}`,
    ...(instant.catchingUp
      ? ['Not all of the run had arrived at this console: what is missing here may only be late']
      : []),
    ...bannerLines(instant.situation),
    ...alarmLines(instant),
    ...linkLines(instant),
    ...commandLines(instant),
    ...(instant.procedures.length > 0
      ? ['Procedures under way:', ...listed(instant.procedures.map((line) => `- ${line}`))]
      : []),
  ];
  const values = channelsOf(dictionary, instant.inSight).map((channel) => valueLine(instant, channel));
  return {
    run,
    at,
    sclk: run.entryKnown ? sclk : undefined,
    view: past
      ? `${MODES[mode].badge}: ${at}, ${withRecording ? 'with the recording' : 'as it was heard then'}`
      : mode === 'ended'
        ? badge.title
        : '',
    text: fitted(lines, values, OCTETS - ROOM),
  };
}

/** The first line, by which the shift log shows the report. */
export function firstLine(cause: string, view: string): string {
  const words = cause.trim().replace(/\s+/g, ' ');
  return `Anomaly report: ${words || 'cause not known'}${view && ` (${view})`}`;
}

const counted = (number: number, what: string) => `${number} ${what}${number === 1 ? '' : 's'}`;
const leftOut = (what: string) => `+${what} left out: a note has at most ${OCTETS} octets`;

/** The lines as one text of at most `most` octets. Values are left out first, the last before the others; then lines. */
export function fitted(lines: readonly string[], values: readonly string[], most: number): string {
  const fits = (text: string) => new TextEncoder().encode(text).length <= most;
  for (let kept = values.length; kept >= 0; --kept) {
    const text = [
      ...lines,
      `Values in view: ${values.length || 'none'}`,
      ...values.slice(0, kept),
      ...(kept < values.length ? [leftOut(counted(values.length - kept, 'value'))] : []),
    ].join('\n');
    if (fits(text)) return text;
  }
  for (let kept = lines.length - 1; kept > 0; --kept) {
    const left = leftOut(`${counted(lines.length - kept, 'line')} and ${counted(values.length, 'value')}`);
    const text = [...lines.slice(0, kept), left].join('\n');
    if (fits(text)) return text;
  }
  return '';
}

const cutoffOf = ({ run, past }: Pick<Instant, 'run' | 'past'>): number => (past ? run.entrySclk + past.to : Infinity);

const timeOf = (run: RunStore, sclk: number, tenths = false): string =>
  run.entryKnown ? fromEntry(sclk - run.entrySclk, { tenths }) : `SCLK ${sclk.toFixed(1)}`;

const listed = (lines: readonly string[]): string[] => [
  ...lines.slice(0, LISTED),
  ...(lines.length > LISTED ? [`+${lines.length - LISTED} more`] : []),
];

function bannerLines({ first, lasting }: Situation): string[] {
  if (!first) return ['Banner: nothing has been told yet'];
  const since = Number.isNaN(first.since_e_s) ? '' : fromEntry(first.since_e_s);
  const evidence = [first.evidence, since].filter(Boolean).join(', ');
  const others = lasting.map(({ sentence }) => sentence).filter((sentence) => sentence !== first.sentence);
  return [
    `Banner: ${first.sentence}${first.countdown && ` [${first.countdown}]`}${evidence && ` (evidence: ${evidence})`}`,
    ...(others.length > 0 ? [`Lasting: ${others.join('; ')}`] : []),
  ];
}

const stands = ({ severity }: AlarmState): boolean => severity !== 'none' && severity !== '';

function alarmLines(instant: Instant): string[] {
  if (!instant.alarms) return streamAlarmLines(instant);
  const raised = instant.alarms.filter((alarm) => stands(alarm) || wantsLook(alarm));
  if (raised.length === 0) return ['Alarms: none is raised'];
  return [`Alarms: ${raised.length}`, ...listed(raised.map((alarm) => alarmLine(instant, alarm)))];
}

function alarmLine({ run, dictionary }: Instant, alarm: AlarmState): string {
  const value = alarm.value === undefined ? '' : withUnit(numberText(alarm.value), dictionary.pick([alarm.name]));
  return `- ${alarm.name}: ${[
    stands(alarm) ? alarm.severity : `over, was ${alarm.worst}`,
    alarm.kind === 'staleness' ? 'stale' : alarm.kind === 'link' && stands(alarm) ? 'lost' : '',
    alarm.limit && `limit ${alarm.limit}`,
    alarm.kind === 'limit' && value && `value ${value}`,
    alarm.reason,
    alarm.sclk === undefined ? '' : `since ${timeOf(run, alarm.sclk)}`,
    acknowledgedWords(alarm),
  ]
    .filter(Boolean)
    .join(', ')}`;
}

function acknowledgedWords(alarm: AlarmState): string {
  if (alarm.state === 'shelved') return `shelved${alarm.shelved_until ? ` until ${alarm.shelved_until}` : ''}`;
  if (wantsLook(alarm)) return 'not acknowledged';
  return alarm.state === 'acknowledged' && alarm.by ? `acknowledged by ${alarm.by}` : 'acknowledged';
}

/**
 * The alarms as the stream told them: limits, packets that are missing, lost links. What people did about them only the
 * ground's list has.
 */
function streamAlarmLines(instant: Instant): string[] {
  const { run, dictionary } = instant;
  const cutoff = cutoffOf(instant);
  const since = (ert_s: number) => `since ${timeOf(run, run.sclkSeenAt(ert_s))}`;
  const limits = dictionary.channels.flatMap((channel) => {
    const alarm = run.alarmAt(channel.id, cutoff);
    const value = withUnit(numberText(alarm?.value ?? NaN), channel);
    return alarm
      ? [[channel.name, alarm.severity, `limit ${alarm.limit}`, `value ${value}`, `since ${timeOf(run, alarm.sclk)}`]]
      : [];
  });
  const packets = [...new Set(dictionary.channels.map(({ packet }) => packet))].flatMap((packet) => {
    const told = run.stalenessAt(packet, cutoff);
    return told?.fact.missing ? [[packet, 'stale', told.fact.reason, since(told.ert_s)]] : [];
  });
  const links = [...run.links].flatMap(([link, changes]) => {
    const told = changes.findLast(({ ert_s }) => run.knownBy(ert_s, cutoff));
    return told?.fact.lost ? [[link, 'lost', told.fact.reason, since(told.ert_s)]] : [];
  });
  const raised = [...limits, ...packets, ...links];
  if (raised.length === 0) return ['Alarms: none is raised'];
  return [
    `Alarms: ${raised.length}; whether they were acknowledged is not known here`,
    ...listed(raised.map(([name, ...words]) => `- ${name}: ${words.filter(Boolean).join(', ')}`)),
  ];
}

function linkLines(instant: Instant): string[] {
  const { run, lost } = instant;
  const views = linkViews(run, undefined, cutoffOf(instant), lost).filter(({ link }) => run.links.has(link));
  return views.length === 0
    ? ['Links: none was heard of yet']
    : ['Links:', ...views.map((view) => linkLine(run, view))];
}

function linkLine(run: RunStore, { link, state, reason, since_e_s = NaN }: LinkView): string {
  if (state === 'unknown') return `- ${linkTitle(link)}: not known${reason && `: ${reason}`}`;
  const word = { up: 'up', down: 'silent', lost: 'lost' }[state];
  const since = run.entryKnown && Number.isFinite(since_e_s) ? ` since ${fromEntry(since_e_s)}` : '';
  const predicted = { up: '', down: ', as predicted', lost: ', not predicted' }[state];
  const why = state === 'up' && reason === 'nominal' ? '' : reason;
  return `- ${linkTitle(link)}: ${word}${since}${predicted}${why && `: ${why}`}`;
}

/** Armed commands, those that wait on the ground, and those whose way is not yet known to its end. */
function commandLines(instant: Instant): string[] {
  const { run, mode, armed } = instant;
  if (mode === 'ended') return [];
  const known = (ert_s: number) => run.knownBy(ert_s, cutoffOf(instant));
  const commands = [...run.commands.values()].sort((a, b) => a.command - b.command);
  const lines = [
    ...armed.map((name) => `- ${name}: armed, not sent`),
    ...commands.flatMap((row) => {
      const cells = stageCells(row, known);
      if (cells.some(({ look }) => look === 'failed') || !cells.some(({ look }) => look === 'pending')) return [];
      const waits = cells.some(({ stage, look }) => stage === 'released' && look === 'pending');
      return [`- ${row.name} #${row.command}: ${waits ? 'waits' : 'under way'}, ${newestEvidence(cells)}`];
    }),
  ];
  return lines.length === 0 ? [] : ['Commands armed, waiting or under way:', ...listed(lines)];
}

/** The channels of these names, those first that stand first in the table of channels. */
function channelsOf(dictionary: Dictionary, names: readonly string[]): DictionaryChannel[] {
  const rank = (name: string) => {
    const at = (LAYOUT.channels as readonly string[]).indexOf(name);
    return at < 0 ? LAYOUT.channels.length : at;
  };
  return [...new Set(names)].toSorted((a, b) => rank(a) - rank(b)).flatMap((name) => dictionary.pick([name]) ?? []);
}

const withUnit = (value: string, channel: DictionaryChannel | undefined): string =>
  channel?.unit ? `${value} ${channel.unit}` : value;

function valueLine(instant: Instant, channel: DictionaryChannel): string {
  const { run, lost } = instant;
  const cutoff = cutoffOf(instant);
  const row = channelRow(run, channel, cutoff, lost);
  const name = row.whose ? `${channel.name}, ${row.whose}` : channel.name;
  if (row.look === 'never') return `- ${name}: not received`;
  if (row.look === 'unasked') return `- ${name}: not asked for yet`;
  const isUndefined = Number.isNaN(run.latest(channel.id, cutoff)?.value);
  return `- ${name}: ${[
    isUndefined ? row.value : withUnit(row.value, channel),
    staleWords(run, channel, cutoff, lost) === undefined ? '' : 'stale',
    row.age === 'now' ? 'now' : `${row.age} old`,
    row.recorded ? 'by recording' : '',
  ]
    .filter(Boolean)
    .join(', ')}`;
}
