// What the vehicle waits for and which condition is missing, in plain words; and before that, what to press.
import type { Explanation, Condition } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import { outcomeWords } from '../clocks/model';
import { preconditionsOf } from '../commands/model';
import type { Precondition } from '../commands/model';
import { LAYOUT } from '../layout';
import { inWords, numberText } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { duration, fromEntry } from '../run/time';
import { isImportant, nextTimepoint } from '../timeline/model';

/** holds: yes, no, or not known. */
export interface Line {
  words: string;
  value: string;
  holds: boolean | undefined;
}
export interface Waiting {
  kind: 'begin' | 'waiting' | 'ended';
  title: string;
  words: string;
  lines: Line[];
}

const RELATIONS: Record<string, string> = { '<=': '≤', '==': '=', '>=': '≥', '!=': '≠' };

export function conditionLine(condition: Condition): Line {
  const relation = RELATIONS[condition.comparison] ?? condition.comparison;
  return {
    words: `${inWords(condition.quantity)} ${relation} ${numberText(condition.bound)}`,
    value: numberText(condition.value),
    holds: condition.holds,
  };
}

export function waitingFor(
  store: RunStore, dictionary: Dictionary, plan: readonly TimepointRow[], cutoff: number,
): Waiting {
  if (!store.going && cutoff === Infinity) return ended(store);
  const begun = [...store.firings.values()].some((pair) => pair.live || pair.recorded);
  const accepted = stepEvidence(store, LAYOUT.firstSteps[LAYOUT.firstSteps.length - 1]) !== undefined;
  if (!begun && !accepted) return beginning(store, dictionary);
  const next = nextTimepoint(store, plan, cutoff);
  if (!next) {
    return {
      kind: 'waiting', title: 'The timeline is complete',
      words: store.run.relayProgress > 0 && store.run.relayProgress < 1
        ? `The recording is coming down: ${Math.round(store.run.relayProgress * 100)} %` : 'Every timepoint has fired.',
      lines: [],
    };
  }
  return { kind: 'waiting', title: `Waiting for ${inWords(next.name)}`, words: next.note, lines: conditions(store, dictionary, next, cutoff) };
}

/** The named moment after the one that is waited for, when that one itself has no name that people know. */
export function thenNamed(store: RunStore, plan: readonly TimepointRow[], cutoff: number): string | undefined {
  const next = nextTimepoint(store, plan, cutoff);
  if (!next || isImportant(next.name)) return undefined;
  return plan.slice(plan.indexOf(next)).find((row) => isImportant(row.name))?.name;
}

function ended(store: RunStore): Waiting {
  const run = store.run;
  const complete = run.relayProgress >= 1 ? 'The recording is complete.' : `${Math.round(run.relayProgress * 100)} % of the recording came down.`;
  return {
    kind: 'ended',
    title: run.outcome === 'touchdown' ? 'Landed' : run.state === 'interrupted' ? 'Interrupted' : 'Ended',
    words: `This run: ${outcomeWords(run.outcome, run.state)}. ${run.state === 'interrupted' ? 'The server stopped in mid-run; the panel Runs continues it from here.' : complete}`,
    lines: [],
  };
}

type FirstStep = (typeof LAYOUT.firstSteps)[number];

/** By which word of the vehicle a step is known to be done: its answer to the command, or the tone that says so. */
export function stepEvidence(store: RunStore, step: FirstStep | undefined): string | undefined {
  if (!step) return undefined;
  for (const row of store.commands.values()) {
    const stage = ['verified', 'executed'].find((name) => row.stages.get(name)?.at(-1)?.status === 'ok');
    if (row.name === step.command && stage !== undefined) return stage;
  }
  const tone = store.tones.find(({ fact }) => fact.name === step.tone);
  return tone && `by tone ${tone.fact.tone}`;
}

/**
 * What the vehicle's own status still says against a step that comes next: it would be refused. A status that never came is no
 * reason to wait, for flight decides by what it knows.
 */
export function statusAgainst(store: RunStore, dictionary: Dictionary, step: FirstStep): Precondition | undefined {
  const command = dictionary.command(step.command);
  return command && preconditionsOf(command, dictionary, store).find((condition) => condition.holds === false);
}

function beginning(store: RunStore, dictionary: Dictionary): Waiting {
  const steps = LAYOUT.firstSteps.filter((step) => dictionary.command(step.command));
  const missing = steps.find((step) => stepEvidence(store, step) === undefined && sending(store, step) === undefined);
  const against = missing && steps.indexOf(missing) > 0 && stepEvidence(store, steps[steps.indexOf(missing) - 1]) !== undefined
    ? statusAgainst(store, dictionary, missing) : undefined;
  return {
    kind: 'begin',
    title: against ? 'Waiting for the vehicle’s status' : missing ? `Press / and type “${missing.words}”` : 'Sent. Waiting for the vehicle’s answer',
    words: against ? `“${missing?.words}” is refused until it says so.` : missing ? `It ${missing.why}.` : 'It answers by a tone of 10 s, which is decided up to 20 s after its end, or by UHF once that is on.',
    lines: [...steps.map((step) => {
      const evidence = stepEvidence(store, step);
      return { words: step.words, value: evidence ?? sending(store, step) ?? failure(store, step) ?? 'to be sent', holds: evidence !== undefined };
    }), ...(against ? [{ words: against.words, value: against.value, holds: against.holds }] : [])],
  };
}

const newest = (store: RunStore, step: FirstStep) => [...store.commands.values()].findLast((row) => row.name === step.command);

function failure(store: RunStore, step: FirstStep): string | undefined {
  const failed = [...(newest(store, step)?.stages.values() ?? [])].map((words) => words.at(-1)).find((stage) => stage?.status === 'failed');
  return failed && `failed: ${failed.evidence}`;
}

function sending(store: RunStore, step: FirstStep): string | undefined {
  return newest(store, step) && failure(store, step) === undefined ? 'sent' : undefined;
}

function conditions(store: RunStore, dictionary: Dictionary, next: TimepointRow, cutoff: number): Line[] {
  const now = Math.min(store.seenSclk, cutoff);
  const lines: Line[] = [];
  const time = (names: readonly string[]): number | undefined => {
    const channel = dictionary.pick(names);
    const sample = channel && store.latest(channel.id, cutoff);
    return sample?.value;
  };
  const current = time(LAYOUT.currentTimepoint);
  // The vehicle's own times only count while it speaks of the same timepoint.
  const itsOwn = current === undefined || current === next.id;
  const desired = itsOwn ? time(LAYOUT.nextDesired) : undefined;
  const minimum = itsOwn ? time(LAYOUT.nextMinimum) : undefined;
  const base = next.anchor ? inWords(next.anchor) : 'the one before';
  // An anchor that GNC starts has no time in the plan: what is waited for is the vehicle's own word.
  const declared = next.anchor !== '' && next.desiredOffsetS === 0 && next.plannedES === undefined;
  const words = declared ? `the vehicle declares “${base}”` : `${offsetWords(next.desiredOffsetS)} ${base}`;
  lines.push(timeLine(words, desired, now, store.entrySclk));
  if (next.minimumOffsetS !== undefined && next.minimumOffsetS > 0 && next.anchor !== '') {
    lines.push(timeLine(`${offsetWords(next.minimumOffsetS)} the one before`, minimum, now, store.entrySclk));
  }
  const held = latestHeld(store, cutoff);
  if (held) lines.push(...held.conditions.map(conditionLine));
  return lines;
}

function offsetWords(offset_s: number | undefined): string {
  if (offset_s === undefined) return 'undefined time from';
  if (offset_s === 0) return 'at';
  return offset_s < 0 ? `${numberText(-offset_s)} s before` : `${numberText(offset_s)} s after`;
}

function timeLine(words: string, due_sclk: number | undefined, now_sclk: number, entry_sclk: number): Line {
  if (due_sclk === undefined) return { words, value: 'no word yet', holds: undefined };
  if (Number.isNaN(due_sclk)) return { words, value: 'not yet', holds: false };
  const left = due_sclk - now_sclk;
  return {
    words, value: left <= 0 ? fromEntry(due_sclk - entry_sclk, { tenths: true }) : `in ${duration(left)}`,
    holds: left <= 0,
  };
}

const FRESH_S = 5; // ours: an explanation older than this no longer says why it is held now

function latestHeld(store: RunStore, cutoff: number): Explanation | undefined {
  const now = Math.min(store.seenSclk, cutoff);
  const row = store.explanations.findLast(({ fact }) => fact.sclk <= cutoff && fact.conditions.length > 0);
  return row && row.fact.verdict === 'held' && now - row.fact.sclk < FRESH_S ? row.fact : undefined;
}
