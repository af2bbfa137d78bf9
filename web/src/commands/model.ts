// SPDX-License-Identifier: Apache-2.0
// From typed text to the request sent, step by step. Pure: what is sent is decided and tested here.
import type { CommandArgument } from '../gen/aeolis/v1/scenario_pb';
import type { CommandReply, DictionaryArgument, DictionaryCommand } from '../gen/aeolis/v1/run_pb';
import type { StageLook } from '../design/status';
import type { Dictionary } from '../run/dictionary';
import { numberText } from '../run/dictionary';
import type { CommandRow, RunStore } from '../run/store';
import { dayOfYear, readFromEntry, secondsOfDayOfYear, secondsOfErt } from '../run/time';
import type { CommandIntent } from '../stream/messages';

/** "type": choosing; "review": all is shown, nothing is sent; "armed": a hazardous command waits for its name. */
export type Step = 'type' | 'review' | 'armed' | 'sending';

interface Typed {
  words: string[];
  given: Map<string, string>;
}

export function readLine(text: string): Typed {
  const words: string[] = [];
  const given = new Map<string, string>();
  for (const token of text.trim().split(/\s+/)) {
    const at = token.indexOf('=');
    if (at > 0) given.set(token.slice(0, at), token.slice(at + 1));
    else if (token !== '') words.push(token);
  }
  return { words, given };
}

/** Commands that match every typed word, best match first: "do edl" finds EDL_DO_EDL, with its quotes too. */
export function candidates(dictionary: Dictionary, words: readonly string[]): DictionaryCommand[] {
  const wanted = words.flatMap((word) => word.toUpperCase().split(/[_"'“”‘’]/)).filter((word) => word !== '');
  const scored: [number, DictionaryCommand][] = [];
  for (const command of dictionary.commands) {
    const parts = command.name.toUpperCase().split('_');
    let score = 0;
    let all = true;
    for (const word of wanted) {
      if (parts.includes(word)) score += 4;
      else if (parts.some((part) => part.startsWith(word))) score += 2;
      else if (command.name.toUpperCase().includes(word)) score += 1;
      else all = false;
    }
    if (all) scored.push([score * 100 - parts.length, command]);
  }
  return scored.sort((a, b) => b[0] - a[0]).map(([, command]) => command);
}

/**
 * Completions for Tab once the line begins with a whole command: names of missing arguments, or values of the current
 * one. `stem` is the part of the last token that stays.
 */
export function argumentOffers(
  dictionary: Dictionary,
  text: string,
  named: (command: DictionaryCommand) => DictionaryCommand = (command) => command,
): { command: DictionaryCommand; stem: string; offers: string[]; strays: string[] } | undefined {
  const tokens = text.trimStart().split(/\s+/);
  const found = dictionary.command((tokens[0] ?? '').toUpperCase());
  if (!found || tokens.length < 2) return undefined;
  const command = named(found);
  const last = tokens[tokens.length - 1] ?? '';
  const given = new Set(tokens.slice(1).map((token) => token.split('=')[0]));
  const strays = tokens.slice(1).filter((token) => token !== '' && !token.includes('='));
  const at = last.indexOf('=');
  if (at > 0) {
    const argument = command.arguments.find((each) => each.name === last.slice(0, at));
    const labels = argument?.labels.map((each) => each.label) ?? [];
    const begun = last.slice(at + 1).toLowerCase();
    return {
      command,
      stem: last.slice(0, at + 1),
      offers: labels.filter((label) => label.toLowerCase().startsWith(begun)),
      strays,
    };
  }
  const free = command.arguments
    .map((each) => each.name)
    .filter((name) => name.startsWith(last.toLowerCase()) && (name === last || !given.has(name)));
  return { command, stem: '', offers: free.map((name) => `${name}=`), strays };
}

export function isHazardous(command: DictionaryCommand): boolean {
  return command.significance === 'critical' || command.significance === 'severe';
}

interface Field {
  argument: DictionaryArgument;
  text: string; // typed text; '' if none
  value: number | undefined;
  from: 'typed' | 'solution' | 'default' | 'missing';
  problem: string | undefined;
}

export function fieldsOf(
  command: DictionaryCommand,
  given: ReadonlyMap<string, string>,
  solution: readonly CommandArgument[],
): Field[] {
  const known = new Map(solution.map((entry) => [entry.name, entry.value]));
  // The solution applies only to a command that it can fill, not to every command with an argument of that name.
  const fits =
    command.arguments.length > 0 &&
    command.arguments.filter((argument) => known.has(argument.name)).length * 2 > command.arguments.length;
  return command.arguments.map((argument) => {
    const text = given.get(argument.name)?.trim() ?? '';
    if (text !== '') return typedField(argument, text);
    const solved = fits ? known.get(argument.name) : undefined;
    if (solved !== undefined)
      return { argument, text, value: solved, from: 'solution', problem: problemOf(argument, solved) };
    if (argument.defaultValue !== undefined) {
      return { argument, text, value: argument.defaultValue, from: 'default', problem: undefined };
    }
    return { argument, text, value: undefined, from: 'missing', problem: 'is needed' };
  });
}

function typedField(argument: DictionaryArgument, text: string): Field {
  const label = argument.labels.find((candidate) => candidate.label.toLowerCase() === text.toLowerCase());
  const value = label ? Number(label.value) : /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) ? Number(text) : NaN;
  return { argument, text, value, from: 'typed', problem: problemOf(argument, value) };
}

function problemOf(argument: DictionaryArgument, value: number): string | undefined {
  if (!Number.isFinite(value)) return 'is not a number';
  if (argument.integer && !Number.isInteger(value)) return 'must be a whole number';
  if (argument.min !== undefined && value < argument.min) return `must be at least ${argument.min}`;
  if (argument.max !== undefined && value > argument.max) return `must be at most ${argument.max}`;
  if (argument.labels.length > 0 && !argument.labels.some((label) => Number(label.value) === value))
    return 'is none of its values';
  return undefined;
}

export function unknownNames(command: DictionaryCommand, given: ReadonlyMap<string, string>): string[] {
  return [...given.keys()].filter((name) => !command.arguments.some((argument) => argument.name === name));
}

/** The dictionary's unit of a dimensionless number is 1; next to a range it would read as a number. */
export const unitText = (argument: DictionaryArgument): string => (argument.unit === '1' ? '' : argument.unit);

const FEW_LABELS = 12; // chosen: more are offered while their name is typed

export function rangeText(argument: DictionaryArgument): string {
  if (argument.labels.length > FEW_LABELS) return `${argument.labels.length} names`;
  if (argument.labels.length > 0) return argument.labels.map((label) => label.label).join(' | ');
  const { min, max } = argument;
  if (min === undefined && max === undefined) return argument.integer ? 'whole number' : '';
  return `${min === undefined ? '' : numberText(min)} … ${max === undefined ? '' : numberText(max)}`;
}

/** Uplink options as typed. */
export interface UplinkText {
  service: '' | 'AD' | 'BD'; // '': automatic
  releaseAt: string;
  hold: boolean;
  priority: string;
  controller: string; // name of the person asking
}
export const AT_ONCE: UplinkText = { service: '', releaseAt: '', hold: false, priority: '', controller: '' };

/** The request to the uplink, the same for a dry run. */
export function intentOf(
  command: DictionaryCommand,
  fields: readonly Field[],
  uplink: UplinkText,
  store: RunStore | undefined,
): CommandIntent | { problem: string } {
  const bad = fields.find((field) => field.problem !== undefined);
  if (bad) return { problem: `${bad.argument.name} ${bad.problem}${bad.text ? `: ${bad.text}` : ''}` };
  const releaseAt = readReleaseAt(uplink.releaseAt, store);
  if (releaseAt === undefined)
    return { problem: `“${uplink.releaseAt}” is no time to leave: write it as 2012-219T05:00:00 or as E-15:00` };
  if (!/^\d{0,6}$/.test(uplink.priority.trim()))
    return { problem: `“${uplink.priority}” is no priority: a whole number` };
  return {
    command: command.name,
    arguments: fields
      .filter((field) => field.from === 'typed')
      .map((field) => ({ name: field.argument.name, value: field.value as number })),
    fromSolution: fields.some((field) => field.from === 'solution'),
    service: uplink.service,
    releaseAt,
    hold: uplink.hold,
    priority: Number(uplink.priority),
    controller: uplink.controller.trim(),
  };
}

/**
 * Reads a time of departure: day of year, or seconds from entry as on the main clock. '' is at once; undefined: not a
 * time.
 */
export function readReleaseAt(text: string, store: RunStore | undefined): string | undefined {
  const typed = text.trim();
  if (typed === '' || Number.isFinite(secondsOfDayOfYear(typed))) return typed.replace(/Z$/, '');
  const e_s = /^e/i.test(typed) ? readFromEntry(typed) : undefined;
  if (e_s === undefined || !store) return undefined;
  const ert = store.ertOf(store.entrySclk + e_s);
  return Number.isFinite(ert) ? dayOfYear(ert) : undefined;
}

interface Arrival {
  arrives_e_s: number;
  /** The timepoint it should precede, the latest ERT of departure for that, and the margin; negative: too late. */
  before: { name: string; leave_ert: string; slack_s: number } | undefined;
  /** Timepoints that will have passed at its arrival. */
  tooLateFor: string[];
}

/** A time of a reply as its text; empty if it is not known. */
export const textOf = (time_us: bigint | undefined): string =>
  time_us === undefined ? '' : dayOfYear(secondsOfErt(time_us), 3);

/** The ground's times of a command, by the clock from entry. */
export function arrivalOf(
  reply: Pick<CommandReply, 'arrivesUs' | 'leavesUs' | 'latestUsefulUs' | 'usefulBefore' | 'tooLateFor'>,
  store: RunStore,
): Arrival {
  const name = reply.usefulBefore;
  const slack_s = secondsOfErt(reply.latestUsefulUs) - secondsOfErt(reply.leavesUs);
  const misses = name !== '' && slack_s <= 0 && !reply.tooLateFor.includes(name);
  return {
    arrives_e_s: secondsOfErt(reply.arrivesUs) + store.run.lightTimeS - store.ertOf(store.entrySclk),
    before: name === '' ? undefined : { name, leave_ert: textOf(reply.latestUsefulUs), slack_s },
    tooLateFor: misses ? [...reply.tooLateFor, name] : reply.tooLateFor,
  };
}

const RELATIONS: Record<string, string> = { '==': '=', '!=': '≠', '<=': '≤', '>=': '≥' };
const FACTS: Record<string, string> = { '0': 'no', '1': 'yes' };

/**
 * The server's words of a precondition, with its value apart: "parameters_received == 1: is 0" is "parameters received:
 * must be yes" and "is no".
 */
export function conditionWords(text: string): { words: string; value: string } {
  const [, name, relation = '', bound = '', value = ''] = /^(\w+) (\S+) ([^\s:]+): (.*)$/.exec(text) ?? [];
  if (name === undefined) return { words: text, value: '' };
  const fact = relation === '==' ? FACTS[bound] : undefined;
  const words = name.replaceAll('_', ' ');
  return fact === undefined
    ? { words: `${words} ${RELATIONS[relation] ?? relation} ${bound}`, value }
    : value === `is ${bound}`
      ? { words: `${words}: ${fact}, as it must be`, value: '' }
      : {
          words: `${words}: must be ${fact}`,
          value: value.replace(/^is ([01])$/, (_, of: string) => `is ${FACTS[of]}`),
        };
}

/** A reason with its preconditions in words: "… must not be sent now: parameters received: must be yes, is no". */
export const reasonWords = (reason: string): string =>
  reason.replace(/\w+ [=!<>]= [^\s:;]+: [^;]+/g, (each) => {
    const { words, value } = conditionWords(each);
    return `${words}, ${value}`;
  });

/** By their numbers in the schema, like STATUSES, so that the page need not load the schema. */
export const STAGES = [
  'queued',
  'authorised',
  'released',
  'radiated',
  'received',
  'accepted',
  'executed',
  'verified',
] as const;
export const STATUSES = ['pending', 'ok', 'failed', 'unknown'] as const;

export interface StageCell {
  stage: string;
  look: StageLook;
  evidence: string;
  at: string;
}

/** All stages with their evidence, in a past view the evidence known then. A stage without evidence is not green. */
export function stageCells(row: CommandRow, known: (ert_s: number) => boolean = () => true): StageCell[] {
  const wordOn = (name: string) => row.stages.get(name)?.findLast((word) => known(word.ert_s));
  // Once it has left, the ground says of each stage that there is what it awaits.
  const awaited = wordOn('accepted') !== undefined;
  return STAGES.map((name) => {
    const stage = wordOn(name);
    if (name === 'verified' && !stage && awaited)
      return { stage: name, look: 'absent', evidence: 'the dictionary names no check beyond its execution', at: '' };
    const look = STATUSES.find((each) => each === stage?.status);
    const at = stage ? dayOfYear(stage.ert_s, 3) : '';
    return { stage: name, look: look ?? 'none', evidence: stage?.evidence ?? 'nothing is known', at };
  });
}

/** The most informative stage, in words: a failure, the wait for release, else the newest. */
export function newestEvidence(cells: readonly StageCell[]): string {
  const failed = cells.find((cell) => cell.look === 'failed');
  const waits = cells.find((cell) => cell.stage === 'released' && cell.look === 'pending');
  const newest =
    failed ??
    waits ??
    cells.findLast((cell) => cell.look === 'ok') ??
    cells.findLast(({ look }) => look !== 'none' && look !== 'absent');
  return newest ? `${newest.stage}${newest.look === 'ok' ? '' : ` ${newest.look}`}: ${newest.evidence}` : '';
}

/**
 * Commands that have not left and may still be sent, by number. `asker`: the person whose command another must approve.
 */
export function waitingCommands(
  store: RunStore,
): { row: CommandRow; evidence: string; held: boolean; asker: string | undefined }[] {
  return [...store.commands.values()]
    .flatMap((row) => {
      const released = row.stages.get('released')?.at(-1);
      if (released?.status !== 'pending') return [];
      return [
        {
          row,
          evidence: released.evidence,
          held: released.held,
          asker: released.needsApproval ? released.askedBy : undefined,
        },
      ];
    })
    .sort((a, b) => a.row.command - b.row.command);
}
