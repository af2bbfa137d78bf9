// SPDX-License-Identifier: Apache-2.0
// What the vehicle waits for and which condition is missing, in plain words; and before that, what to press.
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

/** A precondition of a command that fails, in the server's words. A status that never came is no reason to wait, for flight decides by what it knows. */
export interface Against {
  command: string;
  words: string;
  value: string;
}
/** What the server says of how the run may begin. */
export interface Told {
  /** At the vehicle, in seconds from entry: from then on it refuses the last of the first steps. */
  beginBy_e_s?: number | undefined;
  against?: Against | undefined;
}

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
  /** What comes before it and has no name that people wait for, with when. */
  before?: Line | undefined;
  beforeName?: string;
  /** The last that was heard of, where only a tone told it. */
  byTone?: string;
  /** How much of the recording has come down while nothing else is waited for, 0 … 1. */
  coming?: number;
  /** What is to be typed. */
  type?: string;
  /** Nothing can come of this run: another is to be started. */
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

/** A quantity's name ends in its unit: "speed_mps" is "speed", in m/s. */
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
  return {
    words: `${words} ${RELATIONS[comparison] ?? comparison} ${numberText(bound)}${unit}`,
    value: `${numberText(value)}${unit}`,
    holds,
  };
}

/** What the vehicle does next that people wait for: the next named moment; where none is left, the next timepoint. */
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
          ? `The recording is coming down: ${Math.round(store.run.relayProgress * 100)} %`
          : 'Every timepoint has fired.',
      lines: [],
      ...(cutoff === Infinity &&
        store.run.relayProgress > 0 &&
        store.run.relayProgress < 1 && { coming: store.run.relayProgress }),
    };
  }
  const { main, first } = waited;
  const lastWas = last && heard.get(last.id);
  const moment = momentsOf(store, dictionary, plan, cutoff).find((each) => !each.done && each.before === main.name);
  return {
    kind: 'waiting',
    title: `Waiting for ${inWords((moment ?? main).name)}`,
    words: moment?.plain ?? noteWords(main.note),
    lines: moment
      ? momentLines(store, dictionary, plan, moment, cutoff)
      : conditions(store, dictionary, plan, main, cutoff, predicted),
    // By tone nobody tells of what has none: it may have fired.
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

/** A note of the plan as a sentence. */
export function noteWords(note: string): string {
  const words = LAYOUT.noteMarks.reduce((text, mark) => text.replace(mark, ''), note).trim();
  return /[^.!?…]$/.test(words) ? `${words}.` : words;
}

function ended(store: RunStore): Waiting {
  const run = store.run;
  const complete =
    run.relayProgress >= 1
      ? 'The recording is complete.'
      : `${Math.round(run.relayProgress * 100)} % of the recording came down.`;
  return {
    kind: 'ended',
    title: run.outcome === 'touchdown' ? 'Landed' : run.state === 'interrupted' ? 'Interrupted' : 'Ended',
    words: `This run: ${outcomeWords(run.outcome, run.state)}. ${run.state !== 'interrupted' ? complete : canContinue(run) ? 'The server stopped in mid-run; the panel Runs continues it from here.' : 'It cannot be continued: what is followed after it is another run.'}`,
    lines: [],
  };
}

type FirstStep = (typeof LAYOUT.firstSteps)[number];

/** By which word of the vehicle a step is known to be done: its answer to the command, or the tone that says so. */
function stepEvidence(store: RunStore, step: FirstStep | undefined, cutoff = Infinity): string | undefined {
  if (!step) return undefined;
  for (const row of store.commands.values()) {
    const stage = ['verified', 'executed'].find((name) => lastWord(store, row, name, cutoff)?.status === 'ok');
    if (row.name === step.command && stage !== undefined) return stage;
  }
  const tone = store.tonesBy(cutoff).find(({ fact }) => fact.name === step.tone)?.fact;
  return tone && `by tone ${tone.tone}`;
}

/** What was said last of a stage, as it was known then. */
const lastWord = (store: RunStore, row: CommandRow, stage: string, cutoff: number) =>
  row.stages.get(stage)?.findLast((word) => store.knownBy(word.ert_s, cutoff));

/** `state`: there is nothing under way, it waits on the ground, or it has left. */
interface Missing {
  number: number;
  step: FirstStep;
  state: 'unsent' | 'on_ground' | 'sent';
  evidence: string; // for how far it has come
  /** What the vehicle's own status still says against it: it would be refused. */
  against: Against | undefined;
}

/** The first of the commands that begin a landing which the vehicle has not said to be done. */
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

const ANSWERS = 'It answers by a tone of 10 s, which is decided up to 20 s after its end, or by UHF once that is on.';

/**
 * That this run can begin no more, and by when it had to: the last of the first steps has not left, and would come later than flight takes it,
 * a light time from now. Said by the clock on top, another light time behind. `beginBy_e_s`: from then on flight refuses it, by the server's word.
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
  const past = cutoff !== Infinity; // then there was something to be pressed
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

/** Of a mission whose commands are not here: there is nothing to be pressed, only to be heard. */
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

/** How far the newest of a step that had been heard of by then has come, with what says so. */
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

/** Of a timepoint that has not fired: its times, then what flight says that it compares, each with its newest value. */
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
  // The vehicle's own times only count while it speaks of this timepoint.
  const current = value(LAYOUT.currentTimepoint);
  const itsOwn = current === undefined ? nextTimepoint(store, plan, cutoff) === row : current === row.id;
  const foreseen = predicted.find((each) => each.id === row.id && !each.fired);
  // History has no undefined samples: what is older is the time of the timepoint before.
  const desired = itsOwn ? value(LAYOUT.nextDesired, FRESH_S) : undefined;
  const minimum = itsOwn ? value(LAYOUT.nextMinimum, FRESH_S) : undefined;
  const base = row.anchor ? inWords(row.anchor) : 'the one before';
  // An anchor that GNC starts has no time in the plan: what is waited for is the vehicle's own word.
  const declared = row.anchor !== '' && row.desiredOffsetS === 0 && row.plannedES === undefined;
  const words = declared
    ? `the vehicle declares “${base}”`
    : row.anchor === '' && row.desiredOffsetS === 0
      ? 'with the one before'
      : `${offsetWords(row.desiredOffsetS)} ${base}`;
  const time = timeLine(words, desired, foreseen && foreseen.e_s + store.entrySclk, now, store.entrySclk);
  const lines: Line[] = [declared && time.holds ? { words, value: 'not yet', holds: false } : time]; // what is declared fires, and is heard of so
  if (itsOwn && row.minimumOffsetS !== undefined && row.minimumOffsetS > 0 && row.anchor !== '') {
    lines.push(timeLine(`${offsetWords(row.minimumOffsetS)} the one before`, minimum, undefined, now, store.entrySclk));
  }
  const held = latestHeld(store, (fact) => speaksOf(fact, row), cutoff);
  if (held) return [...lines, ...held.conditions.map(conditionLine)];
  return [...lines, ...watched(store, dictionary, plan, row.name, cutoff)];
}

/** What is compared for the timepoint or moment of this name, as far as it is known; what is old says so, and holds nothing. */
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

/** `due`: by the vehicle's word, NaN while it has none itself; `foreseen`: as the server predicts it. */
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
  return due_sclk === undefined && foreseen_sclk === undefined
    ? { words, value: 'no word yet', holds: undefined }
    : { words, value: 'not yet', holds: false };
}

const FRESH_S = 5; // ours: an explanation older than this no longer says why it is held now, nor a time what this timepoint waits for

/** What flight says that this, and nothing else, is held by. */
function latestHeld(store: RunStore, isOf: (fact: Explanation) => boolean, cutoff: number): Explanation | undefined {
  const now = Math.min(store.seenSclk, cutoff);
  const told = store.explanations.findLast(
    ({ fact }) => fact.sclk <= cutoff && fact.conditions.length > 0 && isOf(fact),
  )?.fact;
  return told?.verdict === 'held' && now - told.sclk < FRESH_S ? told : undefined;
}
