// SPDX-License-Identifier: Apache-2.0
// The debrief of a run that is over: what the server knows of injects, signs, acts, procedures and forks, put side by
// side. Nothing is judged here: points, first signs and first acts are the server's.
import { signal } from '@preact/signals';
import { refreshNotes } from '../notes/model';
import { askInterventions } from '../rehearsal/instructor';
import type { Intervention } from '../rehearsal/instructor';
import { askPlan, titleOf } from '../rehearsal/plan';
import type { Inject, Plan } from '../rehearsal/plan';
import type { Score, ScoreAct, ScoreFault, ScoreSign } from '../rehearsal/score';
import type { Execution, Step } from '../procedures/model';
import { wordsFor } from '../run/api';
import { read } from '../run/connection';
import { store } from '../run/shown';
import type { RunStore } from '../run/store';
import { dayOfYear, duration, fromEntry, secondsOfErt } from '../run/time';

/** What is known of a run for its debrief. A part that cannot be had is the server's words on why. */
interface Debrief {
  run: number;
  score: Score | string;
  plan: string; // why it cannot be had; the plan itself is planOf(run)
  notes: readonly Intervention[];
  procedures: readonly Execution[] | string;
}
export const debrief = signal<Debrief | undefined>(undefined);
/** Of forks, by run: their points of 100, or why there are none. */
export const scoresOfForks = signal<ReadonlyMap<number, string>>(new Map());

const or = <T>(asked: Promise<T>): Promise<T | string> => asked.catch(wordsFor);

export async function askDebrief(run: RunStore): Promise<void> {
  const [score, notes, plan, procedures] = await Promise.all([
    or(read<Score>(`/runs/${run.id}/score`)),
    or(askInterventions(run)),
    or(askPlan(run).then(() => '')),
    or(read<{ procedures: { procedure: Execution }[] }>(`/runs/${run.id}/procedures`)),
  ]);
  await refreshNotes();
  if (store.value !== run) return;
  debrief.value = {
    run: run.id,
    score,
    plan,
    notes: typeof notes === 'string' ? [] : notes.filter(({ note }) => note),
    procedures: typeof procedures === 'string' ? procedures : procedures.procedures.map(({ procedure }) => procedure),
  };
}

/** Asks for the scores of runs, one after the other, as each is work for the archive. */
export async function askScores(runs: readonly number[]): Promise<void> {
  for (const id of runs) {
    if (scoresOfForks.value.has(id)) continue;
    const answer = await or(read<Score>(`/runs/${id}/score`));
    const words = typeof answer === 'string' ? answer : `${answer.sum.toFixed(0)} of 100`;
    scoresOfForks.value = new Map(scoresOfForks.value).set(id, words);
  }
}

// ---- Times ---------------------------------------------------------------------------------------------------------

/**
 * The clocks of a run. An instant is given by the signal that Earth receives then, in seconds from entry. What happens
 * at the vehicle is received a light time later.
 */
export interface Times {
  lightTime_s: number;
  /** Seconds since 1970 at which Earth receives what was sent at `e_s`; NaN: the run has no clock correlation. */
  earth(e_s: number): number;
  /** The reverse, from a time of the stream, or from seconds since 1970. */
  ofErt(us: string | bigint): number;
  ofSeconds(ert_s: number): number;
}
export const timesOf = (run: RunStore): Times => ({
  lightTime_s: run.run.lightTimeS,
  earth: (e_s) => run.ertOf(run.entrySclk + e_s),
  ofErt: (us) => run.sclkSeenAt(secondsOfErt(us)) - run.entrySclk,
  ofSeconds: (ert_s) => run.sclkSeenAt(ert_s) - run.entrySclk,
});

/** "219T05:10:47.4", UTC on Earth. */
export const earthWords = (times: Times, e_s: number): string => dayOfYear(times.earth(e_s)).replace(/^\d{4}-/, '');
export const at = (e_s: number): string => fromEntry(e_s, { tenths: true });
const later = (from_s: number, to_s: number): string =>
  Math.abs(to_s - from_s) < 0.05
    ? 'at once'
    : to_s < from_s
      ? `${duration(from_s - to_s)} before`
      : `${duration(to_s - from_s)} later`;

// ---- Injects: what was known when ----------------------------------------------------------------------------------

export const nameOf = (fault: ScoreFault, plan: Plan | undefined): string =>
  fault.inject ? titleOf(plan, fault.inject) : fault.text;

/** When something was done at the vehicle, by the signal that Earth receives at that instant. */
const doneAt = (fault: ScoreFault, times: Times): number => fault.e_s - times.lightTime_s;

export interface KnownRow {
  what: string;
  e_s?: number; // as received on Earth; left out: it was not
  where?: string; // E-time at the vehicle, where that is another
  words: string;
}

/** The chain from the fault to the first reaction, each with its delay. */
export function knownWhen(fault: ScoreFault, times: Times): KnownRow[] {
  const { felt_e_s, seen_e_s, first_act } = fault;
  const done_s = doneAt(fault, times);
  const firsts = fault.signs.filter(({ heard_e_s }) => heard_e_s !== undefined && heard_e_s === seen_e_s);
  const rows: KnownRow[] = [
    {
      what: 'done',
      e_s: done_s,
      words: fault.text,
      ...(times.lightTime_s > 0 && { where: `${at(fault.e_s)} at the vehicle` }),
    },
    {
      what: 'could be known',
      e_s: felt_e_s,
      words:
        times.lightTime_s === 0
          ? 'at once: no light time is rehearsed'
          : felt_e_s - done_s < 0.05
            ? 'at once: it is on Earth'
            : `${duration(felt_e_s - done_s)} later, the light time`,
    },
  ];
  if (seen_e_s === undefined) return [...rows, { what: 'first sign', words: 'no sign of it was received' }];
  rows.push({
    what: 'first sign',
    e_s: seen_e_s,
    words:
      fault.signs.length === 0
        ? 'no sign is listed for it: its beginning counts'
        : `${later(felt_e_s, seen_e_s)}: ${firsts.map(({ name }) => name).join(', ')}`,
  });
  rows.push(
    first_act
      ? {
          what: 'first act after it',
          e_s: first_act.e_s,
          words: `${later(seen_e_s, first_act.e_s)}: ${first_act.by} ${first_act.text}`,
        }
      : { what: 'first act after it', words: 'nobody did anything afterwards' },
  );
  return rows;
}

/** What could have been seen of a fault by one of its signs. `missed`: nothing of it was received live. */
export function signWords(sign: ScoreSign, felt_e_s: number): { words: string; missed: boolean } {
  const { on_board_e_s, heard_e_s } = sign;
  if (heard_e_s !== undefined)
    return {
      missed: false,
      words:
        on_board_e_s === undefined
          ? `received ${at(heard_e_s)}, ${later(felt_e_s, heard_e_s)}`
          : `reported on board ${at(on_board_e_s)}, received ${at(heard_e_s)}${
              heard_e_s - on_board_e_s < 0.05 ? ' by light time alone' : `, ${later(on_board_e_s, heard_e_s)}`
            }`,
    };
  return on_board_e_s === undefined
    ? { missed: true, words: 'not received, and no report of it is known' }
    : { missed: true, words: `reported on board ${at(on_board_e_s)}; not received live: the recording alone has it` };
}

/** The injects of the plan that were not done. */
export const notDone = (plan: Plan | undefined): readonly Inject[] =>
  plan?.injects.filter(({ state }) => state !== 'done') ?? [];

// ---- The timeline --------------------------------------------------------------------------------------------------

/** A row of the timeline: of the instructor, which the room could not see, of what was received, or of the room. */
export interface Row {
  e_s: number; // as received on Earth
  side: 'instructor' | 'received' | 'room';
  kind: 'inject' | 'note' | 'sign' | 'landing' | 'alarm' | ScoreAct['kind'];
  words: string;
  by?: string;
}

export function timelineOf(score: Score, plan: Plan | undefined, notes: readonly Intervention[], times: Times): Row[] {
  const rows: Row[] = [];
  for (const fault of score.faults) {
    const name = nameOf(fault, plan);
    const where = times.lightTime_s > 0 ? `, ${at(fault.e_s)} at the vehicle` : '';
    rows.push({ e_s: doneAt(fault, times), side: 'instructor', kind: 'inject', words: `${name}${where}` });
    for (const { name: sign, heard_e_s } of fault.signs)
      if (heard_e_s !== undefined)
        rows.push({
          e_s: heard_e_s,
          side: 'received',
          kind: 'sign',
          words: `${heard_e_s === fault.seen_e_s ? 'first sign' : 'sign'} of “${name}”: ${sign}`,
        });
  }
  for (const { e_s, note } of notes)
    rows.push({
      e_s: e_s - times.lightTime_s,
      side: 'instructor',
      kind: 'note',
      by: note?.by || 'unsigned',
      words: note?.text ?? '',
    });
  for (const { of, text, e_s } of score.facts)
    if (e_s !== undefined && (of === 'alarm' || of === 'landing'))
      rows.push({ e_s, side: 'received', kind: of, words: text });
  for (const { kind, e_s, by, text } of score.acts) rows.push({ e_s, side: 'room', kind, by, words: text });
  return rows.toSorted((one, other) => one.e_s - other.e_s); // stable: what was done stands before what came of it
}

// ---- Missed steps --------------------------------------------------------------------------------------------------

/** Something of a procedure that was left out, was late, or stood when the run ended. */
export interface Missed {
  what: 'skipped' | 'late' | 'not done' | 'not acknowledged';
  step: string;
  who: string;
  text: string;
  words: string;
}

const WAITS = ['held', 'active', 'late'] as const;
const waits = ({ state }: Step) => (WAITS as readonly string[]).includes(state);

function lateWords(step: Step, times: Times): string {
  const limit_s = times.ofErt(step.limit_passed_us as string);
  if (step.over_us === undefined || waits(step)) return `its time limit passed at ${at(limit_s)} (${step.limits})`;
  const over_s = times.ofErt(step.over_us);
  return `its time limit passed at ${at(limit_s)} (${step.limits}); over at ${at(over_s)}, ${later(limit_s, over_s)}`;
}

/** What of a procedure was missed, in the order of its steps. A step whose turn had not come is in `notReached`. */
export function missedOf(one: Execution, times: Times): { missed: Missed[]; notReached: string[] } {
  const missed: Missed[] = [];
  for (const step of one.steps) {
    const { step: id, who, text } = step;
    const say = (what: Missed['what'], words: string) => missed.push({ what, step: id, who, text, words });
    if (step.state === 'skipped') say('skipped', `by ${step.by || 'someone'}: ${step.reason || 'without a reason'}`);
    if (step.limit_passed_us !== undefined) say('late', lateWords(step, times));
    if (waits(step)) say('not done', one.over ? 'when the procedure was over' : 'when the run ended');
  }
  for (const dog of one.watchdogs)
    if (dog.tripped_us !== undefined && !dog.acknowledged)
      missed.push({
        what: 'not acknowledged',
        step: dog.watchdog,
        who: dog.who,
        text: dog.text,
        words: `the watchdog tripped at ${at(times.ofErt(dog.tripped_us))}`,
      });
  const notReached = one.over && one.part !== 'stopped' ? [] : one.steps.filter(isUnreached).map(({ step }) => step);
  return { missed, notReached };
}

const isUnreached = ({ state }: Step) => state === 'waiting' || state === 'not_taken';

/** How a procedure stood when the run ended. */
export const endOf = ({ part, over }: Execution): string =>
  !over
    ? 'under way when the run ended'
    : part === 'confirmed'
      ? 'confirmed'
      : part === 'stopped'
        ? 'stopped'
        : 'ended unconfirmed';
