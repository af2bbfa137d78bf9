// SPDX-License-Identifier: Apache-2.0
// What the vehicle waits for and which condition is missing, in plain words; before the landing, what to press.
import type { Explanation, Condition } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import { staleWords } from '../channels/model';
import { touchdownKnown } from '../touchdown/shown';
import { outcomeWords } from '../clocks/model';
import { LAYOUT } from '../layout';
import { canContinue } from '../mode/model';
import { inWords, numberText } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { CommandRow, RunStore } from '../run/store';
import { duration, fromEntry, secondsOfErt } from '../run/time';
import { isLost } from '../run/connection';
import { DUE_S, roughly } from '../situation/countdown';
import { entriesAt, isAmiss } from '../situation/model';
import { heardOf, lastHeard, speaksOf } from '../timeline/heard';
import { isImportant, nextTimepoint } from '../timeline/model';
import type { Prediction } from '../timeline/model';
import { momentsOf } from '../timeline/moments';

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
export interface Neighbour {
  name: string;
  words: string;
  value: string;
}
export interface Waiting {
  kind: 'begin' | 'waiting' | 'ended';
  title: string;
  words: string;
  lines: Line[];
  /** A moment before it, and after an unnamed timepoint the next named one, each with its time. */
  before?: Neighbour | undefined;
  after?: Neighbour | undefined;
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

export function conditionLine({ quantity, value, comparison, bound, holds }: Compared): Line {
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

type Compared = Pick<Condition, 'quantity' | 'value' | 'comparison' | 'bound'> & Pick<Line, 'holds'>;

/** Conditions in words; a lower and an upper bound of one quantity are one range. */
export function conditionLines(all: readonly Compared[]): Line[] {
  return all.flatMap((condition) => {
    const other = all.find((each) => each !== condition && each.quantity === condition.quantity);
    const isPair = other && new Set([condition.comparison, other.comparison, '<=', '>=']).size === 2;
    if (!isPair || condition.comparison === other.comparison) return [conditionLine(condition)];
    if (all.indexOf(other) < all.indexOf(condition)) return [];
    const [low, high] = condition.comparison === '>=' ? [condition, other] : [other, condition];
    const { words, unit } = quantityWords(condition.quantity);
    return [
      {
        ...conditionLine(condition),
        words: `${words} ${numberText(low.bound)} to ${numberText(high.bound)}${unit}`,
        holds: low.holds && high.holds,
      },
    ];
  });
}

/** What the server said of the next step, if no newer word has overtaken it. */
interface Said {
  step: { row: TimepointRow; prediction: Prediction | undefined } | undefined;
  /** That the recording is what is awaited now. */
  recording: string | undefined;
}
export function saidOf(store: RunStore, plan: readonly TimepointRow[], cutoff: number): Said {
  const entries = entriesAt(store, cutoff);
  const step = entries.find(({ subject }) => subject === 'step');
  const row = plan.find(({ name }) => name === step?.timepoint);
  const e_s = step?.atUs ? store.sclkSeenAt(secondsOfErt(step.atUs)) - store.entrySclk : NaN;
  return {
    step:
      step && row && plan.indexOf(row) > lastHeard(plan, heardOf(store, plan, cutoff))
        ? {
            row,
            prediction: Number.isNaN(e_s)
              ? undefined
              : { id: row.id, name: row.name, e_s, fired: false, overdue: step.overdue },
          }
        : undefined,
    recording: entries.find(({ subject }) => subject === 'recording')?.sentence,
  };
}
/** The predictions, with what the server said last of the next step. */
export function withSaid(predicted: readonly Prediction[], { step }: Pick<Said, 'step'>): readonly Prediction[] {
  return step?.prediction ? [step.prediction, ...predicted.filter(({ id }) => id !== step.row.id)] : predicted;
}

/**
 * The vehicle's next step: as the server says in the banner; without its word the next timepoint, or the next named one
 * where only a tone told of the last, since nothing reports an unnamed one by tone.
 */
function nextStep(
  store: RunStore,
  plan: readonly TimepointRow[],
  cutoff: number,
  said: Said,
  isByTone: boolean,
): TimepointRow | undefined {
  if (said.step) return said.step.row;
  const next = nextTimepoint(store, plan, cutoff);
  const named = next && plan.slice(plan.indexOf(next)).find((row) => isImportant(row.name));
  return (isByTone && named) || next;
}

export function waitingFor(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  cutoff: number,
  listed: readonly Prediction[] = [],
  told: Told = {},
): Waiting {
  if (!store.going && cutoff === Infinity) return ended(store);
  const accepted = stepEvidence(store, LAYOUT.firstSteps[LAYOUT.firstSteps.length - 1], cutoff) !== undefined;
  const heard = heardOf(store, plan, cutoff);
  const last = plan[lastHeard(plan, heard)];
  if (!last && !accepted) return beginning(store, dictionary, told, cutoff);
  const said = saidOf(store, plan, cutoff);
  const predicted = withSaid(listed, said);
  const lastWas = last && heard.get(last.id);
  const main = nextStep(store, plan, cutoff, said, lastWas?.by === 'tone');
  if (!main || said.recording !== undefined)
    return recordingDown(store, said.recording, plan.slice(last ? plan.indexOf(last) + 1 : 0), cutoff);
  const moment = momentsOf(store, plan, cutoff).find((each) => !each.done && each.before === main.name);
  const named = plan.slice(plan.indexOf(main) + 1).find((row) => isImportant(row.name));
  const clock = clockAt(store, cutoff);
  const unheard = entriesAt(store, cutoff).find(({ rank, subject }) => rank === 'news' && subject === 'vehicle');
  const isPlanned = main.plannedES !== undefined;
  const title = `${isPlanned ? 'Next:' : unheard ? 'Predicted:' : 'Waiting for'} ${inWords(main.name)}`;
  const note = noteWords(main.note);
  const lines = conditions(store, dictionary, plan, main, cutoff, predicted);
  return {
    kind: 'waiting',
    title,
    words: unheard ? `${firstClause(unheard.sentence)}: no word of it can come.` : repeats(title, note) ? '' : note,
    lines: unheard ? lines.map((line) => ({ ...line, holds: undefined })) : lines,
    ...(moment?.e_s !== undefined && {
      before: {
        ...timeLine(`predicted at ${fromEntry(moment.e_s)}`, undefined, { e_s: moment.e_s }, clock, store.entrySclk),
        name: inWords(moment.name),
      },
    }),
    ...(named &&
      !isImportant(main.name) && {
        after: neighbour(named.name, conditions(store, dictionary, plan, named, cutoff, predicted)[0]),
      }),
    ...(last &&
      lastWas?.by === 'tone' && {
        byTone: `${inWords(last.name)}, ${fromEntry(lastWas.triggered_sclk - store.entrySclk)}`,
      }),
  };
}

/** Of a sentence with more than one statement the first: "Not heard since E+3:00". */
const firstClause = (sentence: string): string => sentence.split('; ')[0] ?? sentence;

/** What says no more than the name is left out: "at cruise stage separation". */
function neighbour(name: string, line: Line | undefined): Neighbour {
  const [words, of] = [inWords(name), line?.words ?? ''];
  return { name: words, words: of === `at ${words}` ? '' : of, value: line?.value ?? '' };
}

/** After the last step that is awaited: the recording, and the timepoints that only it can tell. */
function recordingDown(
  store: RunStore,
  title: string | undefined,
  unheard: readonly TimepointRow[],
  cutoff: number,
): Waiting {
  const part = cutoff === Infinity ? store.run.relayProgress : 0;
  const coming = part > 0 && part < 1;
  return {
    kind: 'waiting',
    title: title ?? 'The timeline is complete',
    words: [
      coming ? `${Math.floor(part * 100)} % of the recording has come.` : '',
      unheard.length === 0
        ? 'Every timepoint has fired.'
        : `Not heard of yet: ${unheard.map(({ name }) => inWords(name)).join(', ')}.`,
    ]
      .join(' ')
      .trim(),
    lines: [],
    ...(coming && { coming: part }),
  };
}

/** Whether a note says no more than the title: "GNC: straighten up and fly right." */
const repeats = (title: string, note: string): boolean =>
  title.toLowerCase().includes(note.toLowerCase().replace(/^\w+: |\.$/g, ''));

/** A note of the plan as a sentence, without marks. */
export function noteWords(note: string): string {
  const words = LAYOUT.noteMarks.reduce((text, mark) => text.replace(mark, ''), note).trim();
  const sentence = words.charAt(0).toUpperCase() + words.slice(1);
  return /[^.!?…]$/.test(sentence) ? `${sentence}.` : sentence;
}

function ended(store: RunStore): Waiting {
  const run = store.run;
  const complete =
    run.relayProgress >= 1
      ? 'The recording is complete.'
      : run.relayProgress > 0
        ? `${Math.floor(run.relayProgress * 100)} % of the recording came down.`
        : 'How much of the recording came down is not told.';
  // What was lost on the way, or still is, comes first: a good end does not hide it.
  const lost = entriesAt(store, Infinity)
    .filter((entry) => entry.subject.startsWith('loss of ') || (entry.rank === 'news' && isAmiss(entry)))
    .map(({ sentence }) => `▲ ${sentence}. `)
    .join('');
  return {
    kind: 'ended',
    title: run.outcome === 'touchdown' ? landedTitle() : run.state === 'interrupted' ? 'Interrupted' : 'Ended',
    words: `${lost}Outcome: ${outcomeWords(run.outcome, run.state)}. ${run.state !== 'interrupted' ? complete : canContinue(run) ? 'The server stopped in mid-run; the panel Runs continues it from here.' : 'It cannot be continued: what is followed after it is another run.'}`,
    lines: [],
  };
}

/** As the card of the touchdown says it, once the server has judged it; until then no verdict. */
const landedTitle = (): string => {
  const verdict = touchdownKnown.value?.verdict;
  return verdict === undefined ? 'Touchdown' : `Touchdown ${verdict === 'untold' ? 'reported' : verdict}`;
};

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
    title: store.packetTotals.size + store.live.size > 0 ? 'Listening' : 'Nothing has come yet',
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
  const [now, clock] = [Math.min(store.seenSclk, cutoff), clockAt(store, cutoff)];
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
  const previous = plan[plan.indexOf(row) - 1];
  const before = previous ? inWords(previous.name) : 'the one before';
  const base = row.anchor ? inWords(row.anchor) : before;
  // An anchor that GNC starts has no time in the plan: it depends on the vehicle's own declaration.
  const declared = row.anchor !== '' && row.desiredOffsetS === 0 && row.plannedES === undefined;
  const words = declared
    ? `the vehicle declares “${base}”`
    : row.anchor === '' && row.desiredOffsetS === 0
      ? `with ${before}`
      : `${offsetWords(row.desiredOffsetS)} ${base}`;
  const time = timeLine(words, desired, foreseen, clock, store.entrySclk);
  // a declaration holds only once it is reported by its firing
  const lines: Line[] = [declared && time.holds ? { words, value: 'is due', holds: false } : time];
  if (itsOwn && row.minimumOffsetS !== undefined && row.minimumOffsetS > 0 && row.anchor !== '') {
    lines.push(timeLine(`${offsetWords(row.minimumOffsetS)} ${before}`, minimum, undefined, clock, store.entrySclk));
  }
  const held = latestHeld(store, (fact) => speaksOf(fact, row), cutoff);
  if (held) return [...lines, ...conditionLines(held.conditions)];
  return [...lines, ...watched(store, dictionary, row.name, cutoff)];
}

/**
 * The known comparisons for the timepoint of this name: value beside bound. Whether one holds is for flight to say; a
 * stale value says its age.
 */
function watched(store: RunStore, dictionary: Dictionary, name: string, cutoff: number): Line[] {
  const sample = (channel: string) => {
    const known = dictionary.pick([channel]);
    return known && store.latest(known.id, cutoff);
  };
  return LAYOUT.watches.flatMap(({ timepoint, channel, comparison, bound: by }): Line[] => {
    const bound = sample(by)?.value ?? NaN;
    const is = sample(channel);
    if (timepoint !== name || Number.isNaN(bound) || !is || Number.isNaN(is.value)) return [];
    const line = conditionLine({ quantity: channel, value: is.value, comparison, bound, holds: undefined });
    const stale = staleWords(store, dictionary.pick([channel]), cutoff, false);
    return stale === undefined ? [line] : [{ ...line, value: `${line.value}, ${stale}` }];
  });
}

function offsetWords(offset_s: number | undefined): string {
  if (offset_s === undefined) return 'undefined time from';
  if (offset_s === 0) return 'at';
  return offset_s < 0 ? `${numberText(-offset_s)} s before` : `${numberText(offset_s)} s after`;
}

/** The clock that countdowns follow; NaN: it stands still, since there is no connection. */
const clockAt = (store: RunStore, cutoff: number): number =>
  isLost.value && cutoff === Infinity ? NaN : Math.min(store.seenSclk, cutoff);

/** `due_sclk`: the vehicle's own time, NaN while it has none; `foreseen`: the server's prediction. */
function timeLine(
  words: string,
  due_sclk: number | undefined,
  foreseen: Pick<Prediction, 'e_s' | 'overdue'> | undefined,
  now_sclk: number,
  entry_sclk: number,
): Line {
  const told = due_sclk !== undefined && !Number.isNaN(due_sclk);
  const at_e_s = told ? due_sclk - entry_sclk : (foreseen?.e_s ?? NaN);
  const left = at_e_s - (now_sclk - entry_sclk);
  if (Number.isNaN(now_sclk) && !Number.isNaN(at_e_s))
    return { words, value: `${told ? '' : 'predicted '}${fromEntry(at_e_s)}`, holds: undefined };
  if (told && left <= 0) return { words, value: fromEntry(due_sclk - entry_sclk, { tenths: true }), holds: true };
  if (Number.isNaN(left))
    return {
      words,
      value: due_sclk === undefined ? 'no word yet' : 'not yet',
      holds: due_sclk === undefined ? undefined : false,
    };
  const isPast = !told && left <= -DUE_S && foreseen !== undefined && foreseen.overdue !== false;
  const value = isPast
    ? `${foreseen.overdue ? 'overdue since' : 'was predicted for'} ${fromEntry(foreseen.e_s)}`
    : left < DUE_S
      ? 'is due'
      : told
        ? `in ${duration(left)}`
        : `in ≈ ${roughly(left)}`;
  return { words, value, holds: false };
}

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
