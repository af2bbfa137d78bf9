// SPDX-License-Identifier: Apache-2.0
// What the vehicle waits for and which condition is missing, in plain words; before the landing, what to press.
import type { Explanation, Condition } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import { staleWords } from '../channels/model';
import { outcomeWords } from '../clocks/model';
import { compare } from '../commands/model';
import { LAYOUT } from '../layout';
import { canContinue } from '../mode/model';
import { inWords, numberText } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { CommandRow, RunStore } from '../run/store';
import { duration, fromEntry } from '../run/time';
import { heardOf, lastHeard, speaksOf } from '../timeline/heard';
import { isImportant, nextTimepoint } from '../timeline/model';
import type { Prediction } from '../timeline/model';
import { momentsOf } from '../timeline/moments';
import type { Moment } from '../timeline/moments';

/**
 * A failing precondition of a command, in the server's words. An unknown state does not count, since flight decides by
 * its own data.
 */
export interface Against {
  command: string;
  words: string;
  value: string;
}
/** The server's answers about the beginning of the run. */
export interface Told {
  /** Vehicle time in seconds from entry from which the vehicle refuses the last of the first steps. */
  beginBy_e_s?: number | undefined;
  against?: Against | undefined;
}

/** A condition. `holds`: yes, no, or not known. */
export interface Line {
  words: string;
  value: string;
  holds: boolean | undefined;
  /** What is compared, by flight's name. */
  quantity?: string;
}
export interface Waiting {
  kind: 'begin' | 'waiting' | 'ended';
  title: string;
  words: string;
  lines: Line[];
  /** The next timepoint if it comes before the named one, with its time. */
  before?: Line | undefined;
  beforeName?: string;
  /** The last known timepoint, if only a tone reported it. */
  byTone?: string;
  /** Fraction of the recording received after the end of the timeline, 0 … 1. */
  coming?: number;
  /** The command to type. */
  type?: string;
  /** The run can no longer begin; another must be started. */
  late?: boolean;
}

const RELATIONS: Record<string, string> = { '<=': '≤', '==': '=', '>=': '≥', '!=': '≠' };
const UNITS: Record<string, string> = {
  mps2: 'm/s²',
  mps: 'm/s',
  dps: '°/s',
  deg: '°',
  s: 's',
  m: 'm',
  N: 'N',
  kg: 'kg',
  Pa: 'Pa',
  g: 'g',
};

/** A fact, as flight compares it. */
const YES_OR_NO: Record<number, string> = { 0: 'no', 1: 'yes' };

/** Splits a quantity's name at its unit: "speed_mps" is "speed" in m/s. */
function quantityWords(quantity: string): { words: string; unit: string } {
  const at = quantity.lastIndexOf('_');
  const unit = UNITS[quantity.slice(at + 1)];
  return unit === undefined || at < 0
    ? { words: inWords(quantity), unit: '' }
    : { words: inWords(quantity.slice(0, at)), unit: ` ${unit}` };
}

export function conditionLine({
  quantity,
  value,
  comparison,
  bound,
  holds,
}: Pick<Condition, 'quantity' | 'value' | 'comparison' | 'bound' | 'holds'>): Line {
  const { words, unit } = quantityWords(quantity);
  const [fact, wanted] = [YES_OR_NO[value], YES_OR_NO[bound]];
  if (comparison === '==' && fact !== undefined && wanted !== undefined)
    return { words: `${words}: ${wanted}`, value: fact, holds, quantity };
  return {
    words: `${words} ${RELATIONS[comparison] ?? comparison} ${numberText(bound)}${unit}`,
    value: `${numberText(value)}${unit}`,
    holds,
    quantity,
  };
}

/** The vehicle's next step that people wait for: the next named timepoint, or the next one if no named one is left. */
function waitedFor(
  store: RunStore,
  plan: readonly TimepointRow[],
  cutoff: number,
): { main: TimepointRow; first: TimepointRow } | undefined {
  const first = nextTimepoint(store, plan, cutoff);
  return first && { first, main: plan.slice(plan.indexOf(first)).find((row) => isImportant(row.name)) ?? first };
}

export function waitingFor(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  cutoff: number,
  predicted: readonly Prediction[] = [],
  told: Told = {},
): Waiting {
  if (!store.going && cutoff === Infinity) return ended(store);
  const accepted = stepEvidence(store, LAYOUT.firstSteps[LAYOUT.firstSteps.length - 1], cutoff) !== undefined;
  const heard = heardOf(store, plan, cutoff);
  const last = plan[lastHeard(plan, heard)];
  if (!last && !accepted) return beginning(store, dictionary, told, cutoff);
  const waited = waitedFor(store, plan, cutoff);
  if (!waited) {
    return {
      kind: 'waiting',
      title: 'The timeline is complete',
      words:
        cutoff === Infinity && store.run.relayProgress > 0 && store.run.relayProgress < 1
          ? `The recording is coming down: ${Math.floor(store.run.relayProgress * 100)} %`
          : 'Every timepoint has fired.',
      lines: [],
      ...(cutoff === Infinity &&
        store.run.relayProgress > 0 &&
        store.run.relayProgress < 1 && { coming: store.run.relayProgress }),
    };
  }
  const { main, first } = waited;
  const lastWas = last && heard.get(last.id);
  const moment = momentsOf(store, plan, cutoff).find((each) => !each.done && each.before === main.name);
  return {
    kind: 'waiting',
    title: `Waiting for ${inWords((moment ?? main).name)}`,
    words: moment?.plain ?? noteWords(main.note),
    lines: moment
      ? momentLines(store, dictionary, plan, moment, cutoff)
      : conditions(store, dictionary, plan, main, cutoff, predicted),
    // Nothing reports an unnamed timepoint by tone: it may have fired.
    ...(first !== main &&
      !moment &&
      lastWas?.by !== 'tone' && {
        before: conditions(store, dictionary, plan, first, cutoff, predicted)[0],
        beforeName: inWords(first.name),
      }),
    ...(last &&
      lastWas?.by === 'tone' && {
        byTone: `${inWords(last.name)}, ${fromEntry(lastWas.triggered_sclk - store.entrySclk)}`,
      }),
  };
}

function momentLines(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  moment: Moment,
  cutoff: number,
): Line[] {
  const now = Math.min(store.seenSclk, cutoff);
  const held =
    latestHeld(store, (fact) => fact.decision === moment.name, cutoff)?.conditions.map(conditionLine) ??
    watched(store, dictionary, plan, moment.name, cutoff);
  return [
    ...(moment.e_s === undefined
      ? []
      : [
          timeLine(
            `predicted at ${fromEntry(moment.e_s)}`,
            undefined,
            moment.e_s + store.entrySclk,
            now,
            store.entrySclk,
          ),
        ]),
    ...held,
  ];
}

/** A note of the plan as a sentence, without marks. */
export function noteWords(note: string): string {
  const words = LAYOUT.noteMarks.reduce((text, mark) => text.replace(mark, ''), note).trim();
  return /[^.!?…]$/.test(words) ? `${words}.` : words;
}

function ended(store: RunStore): Waiting {
  const run = store.run;
  const complete =
    run.relayProgress >= 1
      ? 'The recording is complete.'
      : run.relayProgress > 0
        ? `${Math.floor(run.relayProgress * 100)} % of the recording came down.`
        : 'How much of the recording came down is not told.';
  return {
    kind: 'ended',
    title: run.outcome === 'touchdown' ? 'Landed' : run.state === 'interrupted' ? 'Interrupted' : 'Ended',
    words: `This run: ${outcomeWords(run.outcome, run.state)}. ${run.state !== 'interrupted' ? complete : canContinue(run) ? 'The server stopped in mid-run; the panel Runs continues it from here.' : 'It cannot be continued: what is followed after it is another run.'}`,
    lines: [],
  };
}

type FirstStep = (typeof LAYOUT.firstSteps)[number];

/** The evidence that a step is done: the vehicle's answer to the command, or the tone that reports it. */
function stepEvidence(store: RunStore, step: FirstStep | undefined, cutoff = Infinity): string | undefined {
  if (!step) return undefined;
  for (const row of store.commands.values()) {
    const stage = ['verified', 'executed'].find((name) => lastWord(store, row, name, cutoff)?.status === 'ok');
    if (row.name === step.command && stage !== undefined) return stage;
  }
  const tone = store.tonesBy(cutoff).find(({ fact }) => fact.name === step.tone)?.fact;
  return tone && `by tone ${tone.tone}`;
}

/** The last word on a stage that was known at `cutoff`. */
const lastWord = (store: RunStore, row: CommandRow, stage: string, cutoff: number) =>
  row.stages.get(stage)?.findLast((word) => store.knownBy(word.ert_s, cutoff));

/** A missing step. `state`: no command under way, waiting on the ground, or sent. */
interface Missing {
  number: number;
  step: FirstStep;
  state: 'unsent' | 'on_ground' | 'sent';
  evidence: string; // its progress in words
  /** A precondition that the vehicle's status still contradicts: the command would be refused. */
  against: Against | undefined;
}

/** The first of the landing's first steps that the vehicle has not confirmed. */
export function missingStep(
  store: RunStore,
  dictionary: Dictionary,
  cutoff = Infinity,
  against?: Against,
): Missing | undefined {
  const steps = firstSteps(dictionary);
  const number = steps.findIndex((step) => stepEvidence(store, step, cutoff) === undefined);
  const step = steps[number];
  if (!step) return undefined;
  const { state, evidence } = progress(store, step, cutoff);
  return {
    number,
    step,
    state,
    evidence,
    against: number > 0 && state === 'unsent' && against?.command === step.command ? against : undefined,
  };
}

const firstSteps = (dictionary: Dictionary) => LAYOUT.firstSteps.filter((step) => dictionary.command(step.command));

const ANSWERS = 'It answers by telemetry, and once X-band sends tones also by a tone of 10 s.';

/**
 * Why this run can no longer begin, with the latest time of departure: the last of the first steps has not been sent,
 * and a command sent now would arrive after flight starts to refuse it. Times are by the clock from entry, which lags
 * by another light time. `beginBy_e_s`: the server's time from which flight refuses the command.
 */
export function tooLate(
  store: RunStore,
  dictionary: Dictionary,
  beginBy_e_s: number | undefined,
  cutoff = Infinity,
): string | undefined {
  const step = firstSteps(dictionary).at(-1);
  if (!step || beginBy_e_s === undefined || progress(store, step, cutoff).state === 'sent') return undefined;
  const latest_e_s = beginBy_e_s - 2 * (store.clocks?.lightTimeS ?? store.run.lightTimeS);
  if (Math.min(store.seenSclk, cutoff) - store.entrySclk < latest_e_s) return undefined;
  return `“${step.words}” had to leave by ${fromEntry(latest_e_s)}: the vehicle refuses it from ${fromEntry(beginBy_e_s)} on.`;
}

function beginning(store: RunStore, dictionary: Dictionary, told: Told, cutoff: number): Waiting {
  const missing = missingStep(store, dictionary, cutoff, told.against);
  if (!missing) return listening(store, dictionary);
  const { step, state, evidence, against } = missing;
  const past = cutoff !== Infinity; // in the past there was something to press
  const late = tooLate(store, dictionary, told.beginBy_e_s, cutoff);
  const [title, words] =
    late !== undefined
      ? ['Too late for this run', `${late} ${past ? '' : 'End it and start another.'}`]
      : against
        ? ['Waiting for the vehicle’s status', `“${step.words}” is refused until it says so.`]
        : state === 'sent'
          ? ['Sent. Waiting for the vehicle’s answer', ANSWERS]
          : state === 'on_ground'
            ? [`“${step.words}” waits on the ground`, `It has not left yet: it ${evidence}.`]
            : [past ? `“${step.words}” had not been sent` : `Press / and type “${step.words}”`, `It ${step.why}.`];
  return {
    kind: 'begin',
    title,
    words,
    ...(late !== undefined && !past && { late: true }),
    ...(state === 'unsent' && !against && !past && late === undefined && { type: step.words }),
    lines: [
      ...firstSteps(dictionary).map((each) => {
        const done = stepEvidence(store, each, cutoff);
        return { words: each.words, value: done ?? progress(store, each, cutoff).evidence, holds: done !== undefined };
      }),
      ...(against ? [{ words: against.words, value: against.value, holds: false }] : []),
    ],
  };
}

/** The state of a mission without commands in the dictionary: nothing to press, only to listen. */
function listening(store: RunStore, dictionary: Dictionary): Waiting {
  return {
    kind: 'waiting',
    title: store.unitTotals.size + store.live.size > 0 ? 'Listening' : 'Nothing has come yet',
    lines: [],
    words:
      dictionary.commands.length === 0
        ? 'This venue has no commands here.'
        : 'This venue has none of the commands that begin a landing.',
  };
}

/** The progress of a step at `cutoff`, by its newest command, in words. */
function progress(store: RunStore, step: FirstStep, cutoff: number): Pick<Missing, 'state' | 'evidence'> {
  const words = (row: CommandRow) =>
    [...row.stages.keys()].flatMap((stage) => lastWord(store, row, stage, cutoff) ?? []);
  const row = [...store.commands.values()].findLast((each) => each.name === step.command && words(each).length > 0);
  const failed = row && words(row).find((word) => word.status === 'failed');
  if (failed)
    return {
      state: 'unsent',
      evidence: failed.evidence.startsWith('cancelled') ? failed.evidence : `failed: ${failed.evidence}`,
    };
  if (!row) return { state: 'unsent', evidence: 'to be sent' };
  const released = lastWord(store, row, 'released', cutoff);
  if (released?.status !== 'pending') return { state: 'sent', evidence: 'sent' };
  return {
    state: 'on_ground',
    evidence: released.needsApproval
      ? 'waits for a second person'
      : released.held
        ? 'is held until it is released'
        : 'waits to leave',
  };
}

/**
 * The conditions of a timepoint that has not fired: its times, then flight's conditions, each with its newest value.
 */
export function conditions(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  row: TimepointRow,
  cutoff: number,
  predicted: readonly Prediction[],
): Line[] {
  const now = Math.min(store.seenSclk, cutoff);
  const value = (names: readonly string[], within_s = Infinity): number | undefined => {
    const channel = dictionary.pick(names);
    const sample = channel && store.latest(channel.id, cutoff);
    return sample && now - sample.sclk <= within_s ? sample.value : undefined;
  };
  // The vehicle's own times count only while it reports this timepoint.
  const current = value(LAYOUT.currentTimepoint);
  const itsOwn = current === undefined ? nextTimepoint(store, plan, cutoff) === row : current === row.id;
  const foreseen = predicted.find((each) => each.id === row.id && !each.fired);
  // History has no undefined samples: an older value is the time of the previous timepoint.
  const desired = itsOwn ? value(LAYOUT.nextDesired, FRESH_S) : undefined;
  const minimum = itsOwn ? value(LAYOUT.nextMinimum, FRESH_S) : undefined;
  const base = row.anchor ? inWords(row.anchor) : 'the one before';
  // An anchor that GNC starts has no time in the plan: it depends on the vehicle's own declaration.
  const declared = row.anchor !== '' && row.desiredOffsetS === 0 && row.plannedES === undefined;
  const words = declared
    ? `the vehicle declares “${base}”`
    : row.anchor === '' && row.desiredOffsetS === 0
      ? 'with the one before'
      : `${offsetWords(row.desiredOffsetS)} ${base}`;
  const time = timeLine(words, desired, foreseen && foreseen.e_s + store.entrySclk, now, store.entrySclk);
  // a declaration holds only once it is reported by its firing
  const lines: Line[] = [declared && time.holds ? { words, value: 'not yet', holds: false } : time];
  if (itsOwn && row.minimumOffsetS !== undefined && row.minimumOffsetS > 0 && row.anchor !== '') {
    lines.push(timeLine(`${offsetWords(row.minimumOffsetS)} the one before`, minimum, undefined, now, store.entrySclk));
  }
  const held = latestHeld(store, (fact) => speaksOf(fact, row), cutoff);
  if (held) return [...lines, ...held.conditions.map(conditionLine)];
  return [...lines, ...watched(store, dictionary, plan, row.name, cutoff)];
}

/** The known comparisons for the timepoint or moment of this name. A stale value says its age and satisfies nothing. */
function watched(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  name: string,
  cutoff: number,
): Line[] {
  const now = Math.min(store.seenSclk, cutoff);
  const sample = (channel: string) => {
    const known = dictionary.pick([channel]);
    return known && store.latest(known.id, cutoff);
  };
  return LAYOUT.watches.flatMap((watch): Line[] => {
    const bound = typeof watch.bound === 'number' ? watch.bound : (sample(watch.bound)?.value ?? NaN);
    if (watch.timepoint !== name || Number.isNaN(bound)) return [];
    if ('since' in watch) {
      const since = heardOf(store, plan, cutoff).get(
        plan.find((row) => row.name === watch.since)?.id ?? NaN,
      )?.fired_sclk;
      return since === undefined
        ? []
        : [
            {
              words: `since ${inWords(watch.since)} ≥ ${bound} s`,
              value: duration(now - since),
              holds: now - since >= bound,
            },
          ];
    }
    const is = sample(watch.channel);
    if (!is || Number.isNaN(is.value)) return [];
    const line = conditionLine({
      quantity: watch.channel,
      value: is.value,
      comparison: watch.comparison,
      bound,
      holds: compare(is.value, watch.comparison, bound),
    });
    const stale = staleWords(store, dictionary.pick([watch.channel]), cutoff, false);
    return stale === undefined ? [line] : [{ ...line, value: `${line.value}, ${stale}`, holds: undefined }];
  });
}

function offsetWords(offset_s: number | undefined): string {
  if (offset_s === undefined) return 'undefined time from';
  if (offset_s === 0) return 'at';
  return offset_s < 0 ? `${numberText(-offset_s)} s before` : `${numberText(offset_s)} s after`;
}

/** `due_sclk`: the vehicle's own time, NaN while it has none; `foreseen_sclk`: the server's prediction. */
function timeLine(
  words: string,
  due_sclk: number | undefined,
  foreseen_sclk: number | undefined,
  now_sclk: number,
  entry_sclk: number,
): Line {
  const told = due_sclk !== undefined && !Number.isNaN(due_sclk);
  const left = (told ? due_sclk : (foreseen_sclk ?? NaN)) - now_sclk;
  if (told)
    return {
      words,
      value: left <= 0 ? fromEntry(due_sclk - entry_sclk, { tenths: true }) : `in ${duration(left)}`,
      holds: left <= 0,
    };
  if (left > 0) return { words, value: `≈ in ${duration(left)}`, holds: false };
  if (due_sclk === undefined && foreseen_sclk === undefined) return { words, value: 'no word yet', holds: undefined };
  const late = foreseen_sclk !== undefined && left < -LATE_S;
  return {
    words,
    value: late ? `overdue since ${fromEntry(foreseen_sclk - entry_sclk)}` : 'not yet',
    holds: false,
  };
}

const LATE_S = 5; // chosen: as the server's, from when on a step that UHF tells is overdue
// chosen: an older explanation no longer says what holds the decision now, and an older time belongs to another
// timepoint
const FRESH_S = 5;

/** Flight's recent explanation that this decision is held. */
function latestHeld(store: RunStore, isOf: (fact: Explanation) => boolean, cutoff: number): Explanation | undefined {
  const now = Math.min(store.seenSclk, cutoff);
  const told = store.explanations.findLast(
    ({ fact }) => fact.sclk <= cutoff && fact.conditions.length > 0 && isOf(fact),
  )?.fact;
  return told?.verdict === 'held' && now - told.sclk < FRESH_S ? told : undefined;
}
