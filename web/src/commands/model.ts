// From what is typed to what is sent, step by step, all of it pure: what is sent is decided here and tested.
import type { CommandArgument } from '../gen/aeolis/v1/scenario_pb';
import type { DictionaryArgument, DictionaryCommand } from '../gen/aeolis/v1/run_pb';
import type { Dictionary } from '../run/dictionary';
import { numberText } from '../run/dictionary';
import type { CommandRow, RunStore } from '../run/store';

/** "type": choosing; "review": all is shown, nothing is sent; "armed": a hazardous one waits for its name. */
export type Step = 'type' | 'review' | 'armed' | 'sending';

export interface Typed {
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

/** Commands that have every typed word, the best first: "do edl" finds EDL_DO_EDL. */
export function candidates(dictionary: Dictionary, words: readonly string[]): DictionaryCommand[] {
  const wanted = words.flatMap((word) => word.toUpperCase().split('_')).filter((word) => word !== '');
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
 * What Tab can complete once the line begins with a whole command: names of arguments that are not given yet, or the values of
 * the one that is being given. `stem` is the part of the last token that stays.
 */
export function argumentOffers(
  dictionary: Dictionary, text: string,
): { command: DictionaryCommand; stem: string; offers: string[]; strays: string[] } | undefined {
  const tokens = text.trimStart().split(/\s+/);
  const command = dictionary.command((tokens[0] ?? '').toUpperCase());
  if (!command || tokens.length < 2) return undefined;
  const last = tokens[tokens.length - 1] ?? '';
  const given = new Set(tokens.slice(1).map((token) => token.split('=')[0]));
  const strays = tokens.slice(1).filter((token) => token !== '' && !token.includes('='));
  const at = last.indexOf('=');
  if (at > 0) {
    const argument = command.arguments.find((each) => each.name === last.slice(0, at));
    const labels = argument?.labels.map((each) => each.label) ?? [];
    const begun = last.slice(at + 1).toLowerCase();
    return { command, stem: last.slice(0, at + 1), offers: labels.filter((label) => label.toLowerCase().startsWith(begun)), strays };
  }
  const free = command.arguments.map((each) => each.name).filter((name) => name.startsWith(last.toLowerCase()) && (name === last || !given.has(name)));
  return { command, stem: '', offers: free.map((name) => `${name}=`), strays };
}

export function isHazardous(command: DictionaryCommand): boolean {
  return command.significance === 'critical' || command.significance === 'severe';
}

export interface Field {
  argument: DictionaryArgument;
  text: string; // what is typed, '' when nothing is
  value: number | undefined;
  from: 'typed' | 'solution' | 'default' | 'missing';
  problem: string | undefined;
}

export function fieldsOf(
  command: DictionaryCommand, given: ReadonlyMap<string, string>, solution: readonly CommandArgument[],
): Field[] {
  const known = new Map(solution.map((entry) => [entry.name, entry.value]));
  // The solution belongs to a command that it can fill, not to any that shares a name with it.
  const fits = command.arguments.length > 0 && command.arguments.filter((argument) => known.has(argument.name)).length * 2 > command.arguments.length;
  return command.arguments.map((argument) => {
    const text = given.get(argument.name)?.trim() ?? '';
    if (text !== '') return typedField(argument, text);
    const solved = fits ? known.get(argument.name) : undefined;
    if (solved !== undefined) return { argument, text, value: solved, from: 'solution', problem: problemOf(argument, solved) };
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
  if (argument.labels.length > 0 && !argument.labels.some((label) => Number(label.value) === value)) return 'is none of its values';
  return undefined;
}

export function unknownNames(command: DictionaryCommand, given: ReadonlyMap<string, string>): string[] {
  return [...given.keys()].filter((name) => !command.arguments.some((argument) => argument.name === name));
}

export function rangeText(argument: DictionaryArgument): string {
  if (argument.labels.length > 0) return argument.labels.map((label) => label.label).join(' | ');
  const { min, max } = argument;
  if (min === undefined && max === undefined) return argument.integer ? 'whole number' : '';
  return `${min === undefined ? '' : numberText(min)} … ${max === undefined ? '' : numberText(max)}`;
}

export interface Precondition {
  words: string;
  holds: boolean | undefined;
  value: string;
}

/** Preconditions as the page sees them; the server decides by itself, and so does flight. */
export function preconditionsOf(command: DictionaryCommand, dictionary: Dictionary, store: RunStore | undefined): Precondition[] {
  return command.preconditions.map((words, index) => {
    const condition = command.conditions[index];
    const channel = condition && dictionary.channel(condition.channel);
    const sample = channel && store?.latest(channel.id);
    if (!channel || !sample || Number.isNaN(sample.value)) return { words, holds: undefined, value: 'not known' };
    return {
      words, holds: compare(sample.value, condition.comparison, condition.value),
      value: `${channel.name} is ${dictionary.label(channel, sample.value) ?? numberText(sample.value)}`,
    };
  });
}

function compare(value: number, relation: string, bound: number): boolean {
  switch (relation) {
    case '==': return value === bound;
    case '!=': return value !== bound;
    case '<': return value < bound;
    case '<=': return value <= bound;
    case '>': return value > bound;
    default: return value >= bound;
  }
}

export const STAGES = ['queued', 'authorised', 'released', 'radiated', 'received', 'accepted', 'executed', 'verified'] as const;
export type StageLook = 'ok' | 'failed' | 'unknown' | 'pending' | 'none';

export interface StageCell {
  stage: string;
  look: StageLook;
  evidence: string;
  at: string;
}

/** Every stage says what is known of it, in a past view what was known then; one never heard of is not green. */
export function stageCells(row: CommandRow, known: (at: string) => boolean = () => true): StageCell[] {
  const names = [...STAGES, ...[...row.stages.keys()].filter((stage) => !(STAGES as readonly string[]).includes(stage))];
  return names.map((name) => {
    const stage = row.stages.get(name)?.findLast((word) => known(word.at));
    const look = (['ok', 'failed', 'unknown', 'pending'] as const).find((each) => each === stage?.status);
    return { stage: name, look: look ?? 'none', evidence: stage?.evidence ?? 'nothing is known', at: stage?.at ?? '' };
  });
}

/** The last stage with something to say, in words. */
export function newestEvidence(cells: readonly StageCell[]): string {
  const failed = cells.find((cell) => cell.look === 'failed');
  const newest = failed ?? cells.findLast((cell) => cell.look === 'ok') ?? cells.findLast((cell) => cell.look !== 'none');
  return newest ? `${newest.stage}${newest.look === 'ok' ? '' : ` ${newest.look}`}: ${newest.evidence}` : '';
}
