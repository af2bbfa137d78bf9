// SPDX-License-Identifier: Apache-2.0
// The procedures of the library and those of the run shown, as the server has them at the instant shown. The page
// judges none of them: what can be done is the server's word, and only who does it is compared with the position chosen
// here.
import { computed, signal } from '@preact/signals';
import type { Status } from '../design/status';
import { myName } from '../commands/signature';
import { DIRECTOR } from '../positions/model';
import { Refused, wordsFor } from '../run/api';
import { AsOf } from '../run/as_of';
import { change, read } from '../run/connection';
import { signalOfRun, store } from '../run/shown';
import { position } from './position';

export type ActKind = 'tick' | 'sign' | 'choose' | 'skip' | 'sent' | 'hold' | 'release' | 'acknowledge' | 'stop';
type Part = 'preconditions' | 'body' | 'confirmation' | 'confirmed' | 'ended' | 'stopped';
export type StepState = 'waiting' | 'held' | 'active' | 'late' | 'checked' | 'ticked' | 'skipped' | 'not_taken';

export interface Condition {
  text: string;
  verdict: 'holds' | 'does_not_hold' | 'not_known';
  evidence: string;
}
export interface Choice {
  text: string;
  conditions: Condition[];
  go_to: string;
  reason_wanted: boolean;
}
export interface Signature {
  position: string;
  by: string;
  at_us: string;
}
export interface Prepared {
  name: string;
  arguments: { name: string; value: number; text: string }[];
  to_fill: string[];
  from_solution: boolean;
  until: string;
  command: string; // its number in the run; "0": not sent
  evidence: string;
}
export interface Step {
  step: string;
  part: Part;
  who: string;
  text: string;
  state: StepState;
  acts: ActKind[];
  reason_wanted: boolean;
  hold: string;
  limits: string;
  limit_us?: string;
  limit_passed_us?: string; // it was late, and stays so
  since_us?: string;
  over_us?: string;
  conditions: Condition[];
  choices: Choice[];
  chosen?: number;
  signatures_wanted: string[];
  signatures: Signature[];
  by: string;
  reason: string;
  command?: Prepared;
  next: string;
}
export interface Watchdog {
  watchdog: string;
  who: string;
  text: string;
  conditions: Condition[];
  tripped_us?: string;
  acknowledged?: Signature;
  begin: string;
  hold: boolean;
  acts: ActKind[];
}
interface Approval {
  position: string;
  name: string;
  on: string;
}
/** One procedure of the run as it stands. */
export interface Execution {
  number: number;
  procedure: string;
  title: string;
  revision: number;
  approvals: Approval[];
  part: Part;
  over: boolean;
  held: string;
  begun_us: string;
  begun_by: string;
  steps: Step[];
  watchdogs: Watchdog[];
  acts: ActKind[];
}
/** One of the library. */
export interface Entry {
  procedure: string;
  title: string;
  purpose: string;
  begin_when: string;
  revision: number;
  approvals: Approval[];
  findings: string[];
}
/** One of the library, whole, before anybody begins it. */
export interface Form {
  entry: Entry;
  source: string;
  steps: Step[];
  watchdogs: Watchdog[];
  redlines: { step: string; text: string; reason: string; by: string; on: string; approved_by: string }[];
}
interface StatusItem {
  seq: string;
  procedure: Execution;
}
export interface ActItem {
  seq: string;
  ert_us: string;
  procedure_act: {
    kind: ActKind | 'begin';
    step: string;
    position: string;
    by: string;
    reason: string;
    choice?: number;
    command: string;
  };
}

// ---- The library ---------------------------------------------------------------------------------------------------

/** Undefined: not asked yet, or no answer yet. "none": this server has no procedures. */
export const library = signal<{ procedures: Entry[]; positions: string[] } | 'none' | undefined>(undefined);

export async function refreshLibrary(): Promise<void> {
  try {
    library.value = await read<{ procedures: Entry[]; positions: string[] }>('/procedures');
  } catch (error) {
    if (error instanceof Refused && error.status === 404) library.value = 'none';
    // otherwise the header reports the lost connection; the next round asks again
  }
}

export const refreshForm = (procedure: string): Promise<Form> => read<Form>(`/procedures/${procedure}`);

/** Its print, as text of 78 columns. */
export const printOf = (procedure: string): string => `/api/v1/procedures/${encodeURIComponent(procedure)}?format=text`;

// ---- Those of the run ----------------------------------------------------------------------------------------------

const statuses = new AsOf<{ procedures: StatusItem[] }, StatusItem[]>('procedures', (list) => list.procedures, []);

/** Asks for the statuses at the instant shown. Those of now are renewed by the stream, each whole. */
export async function refreshProcedures(): Promise<void> {
  takeHeard();
  await statuses.refresh();
  takeHeard();
}

/** The procedures of the run at the instant shown, by number; undefined: not known. None is of after that instant. */
export const executions = computed<Execution[] | undefined>(() => statuses.value.value?.map((item) => item.procedure));
export const underWay = computed(() => (executions.value ?? []).filter(({ over }) => !over));

/** Takes what the stream brought of the run shown. */
function takeHeard(): void {
  for (const { seq, status } of store.value?.procedures.values() ?? [])
    take({ seq: String(seq), procedure: status as unknown as Execution });
}

/** Puts a status of now in the place of an older one of the same procedure. */
function take(item: StatusItem): void {
  statuses.renew((known) => {
    const { number } = item.procedure;
    const before = known.find((each) => each.procedure.number === number);
    if (before && Number(before.seq) >= Number(item.seq)) return known;
    const others = known.filter((each) => each !== before);
    return [...others, item].sort((one, other) => one.procedure.number - other.procedure.number);
  });
}

// ---- What people do ------------------------------------------------------------------------------------------------

export const problem = signalOfRun('');
/** Whether an act is under way: one at a time, so that none is sent twice. */
export const busy = signal(false);

const me = () => ({ position: position.value, by: myName() });

async function send(path: string, body: object, what: string): Promise<Execution | undefined> {
  const run = store.value;
  if (!run || busy.value) return undefined;
  busy.value = true;
  problem.value = '';
  try {
    const item = await change<StatusItem>(`/runs/${run.id}/procedures${path}`, body);
    if (store.value === run) take(item);
    return item.procedure;
  } catch (error) {
    if (store.value === run) problem.value = `${what}: ${wordsFor(error)}`;
    return undefined;
  } finally {
    busy.value = false;
  }
}

export const begin = (procedure: string): Promise<Execution | undefined> =>
  send('', { procedure, ...me() }, `${procedure} was not begun`);

export interface Deed {
  kind: ActKind;
  step?: string;
  reason?: string;
  choice?: number;
  command?: number;
}
/** Does one thing in a procedure; true if the server took it. */
export async function act(number: number, deed: Deed): Promise<boolean> {
  const { kind, step = '', reason = '', choice, command } = deed;
  const body = {
    kind,
    step,
    reason: reason.trim(),
    ...(choice !== undefined && { choice }),
    ...(command !== undefined && { command: String(command) }),
    ...me(),
  };
  const what = `${kind}${step && ` of ${step.replaceAll('_', ' ')}`}`;
  return (await send(`/${number}/acts`, body, `${what}: not done`)) !== undefined;
}

/** What was done with it, oldest first. */
export const actsOf = async (run: number, number: number): Promise<ActItem[]> =>
  (await read<{ acts: ActItem[] }>(`/runs/${run}/procedures/${number}/acts`)).acts;

// ---- What is offered to a position ---------------------------------------------------------------------------------

/** Which of the acts that are open the position has a part in. The server judges each. */
export function offered(acts: readonly ActKind[], one: Partial<Step>, mine: string): ActKind[] {
  const directs = mine === DIRECTOR;
  const signatures = one.signatures_wanted ?? [];
  const wanted = signatures.includes(mine) && !one.signatures?.some((each) => each.position === mine);
  // what lacks nothing but signatures is done by them: a tick beside them would do nothing
  const isForSignatures = signatures.length > 0 && (!one.reason_wanted || !!one.by);
  const has: Record<ActKind, boolean> = {
    tick: !isForSignatures && (directs || mine === one.who),
    choose: directs || mine === one.who,
    acknowledge: directs || mine === one.who,
    sign: wanted,
    skip: directs,
    stop: directs,
    sent: mine === 'command',
    release: directs || one.hold === undefined || one.hold === '' || mine === one.hold,
    hold: true,
  };
  return acts.filter((kind) => has[kind]);
}

/** The same of a procedure as a whole: what holds it is released by whoever holds it, or by the flight director. */
export const offeredOfWhole = ({ acts, held }: Execution, mine: string): ActKind[] =>
  offered(acts, {}, mine).filter((kind) => kind !== 'release' || mine === DIRECTOR || held.startsWith(`${myName()} (`));

/** Who is asked to act on a step: the position that is awaited. */
export function awaitedOf(step: Step): string[] {
  if (step.acts.includes('release')) return [step.hold || DIRECTOR];
  const unsigned = step.signatures_wanted.filter((each) => !step.signatures.some((given) => given.position === each));
  if (step.acts.includes('sign') && unsigned.length > 0) return unsigned;
  return [step.who];
}

// ---- How it looks --------------------------------------------------------------------------------------------------

interface Look {
  shape: string;
  token: string;
  word: string;
}
export const STEP_LOOKS: Record<StepState, Look> = {
  waiting: { shape: '○', token: 'dim', word: 'waiting' },
  held: { shape: '‖', token: 'caution', word: 'held' },
  active: { shape: '▷', token: 'accent', word: 'now' },
  late: { shape: '▲', token: 'caution', word: 'late' },
  checked: { shape: '✓', token: 'good', word: 'checked' },
  ticked: { shape: '✓', token: 'good', word: 'ticked' },
  skipped: { shape: '–', token: 'caution', word: 'skipped' },
  not_taken: { shape: '·', token: 'dim', word: 'not taken' },
};
export const VERDICTS: Record<Condition['verdict'], Status> = {
  holds: 'holds',
  does_not_hold: 'missing',
  not_known: 'unknown',
};

export const isOver = ({ state }: Pick<Step, 'state'>): boolean =>
  ['checked', 'ticked', 'skipped', 'not_taken'].includes(state);
/** Whether somebody or something has to do with a step now: its turn has come, or it waits for its release. */
export const isNow = (step: Pick<Step, 'state'>): boolean => !isOver(step) && step.state !== 'waiting';

const tripped = ({ tripped_us, acknowledged }: Watchdog): boolean => tripped_us !== undefined && !acknowledged;
export const trippedOf = ({ watchdogs }: Execution): Watchdog[] => watchdogs.filter(tripped);

/** The look of a procedure: what is worst of it first. */
export function lookOf(one: Execution): Look {
  switch (one.part) {
    case 'confirmed':
      return { shape: '✓', token: 'good', word: 'confirmed' };
    case 'ended':
      return { shape: '–', token: 'caution', word: 'ended, not confirmed' };
    case 'stopped':
      return { shape: '✖', token: 'caution', word: 'stopped' };
  }
  const dogs = trippedOf(one);
  if (dogs.length > 0)
    return { shape: '▲', token: 'caution', word: `watchdog ${dogs[0]?.watchdog.replaceAll('_', ' ')}` };
  if (one.held !== '') return STEP_LOOKS.held;
  const now = one.steps.filter(isNow);
  if (now.some(({ state }) => state === 'late')) return STEP_LOOKS.late;
  return now.length > 0 && now.every(({ state }) => state === 'held')
    ? { ...STEP_LOOKS.held, word: 'waits for its release' }
    : { ...STEP_LOOKS.active, word: 'under way' };
}

/** "revision 1, a draft". */
export const revisionWords = ({ revision, approvals }: { revision: number; approvals: Approval[] }): string =>
  `revision ${revision}, ${
    approvals.length === 0 ? 'a draft' : `approved by ${approvals.map(({ name, on }) => `${name} on ${on}`).join(', ')}`
  }`;

/** "#1 Start, held: send parameters, do edl". */
export function lineOf(one: Execution): string {
  const now = one.steps.filter(isNow).map(({ step }) => step.replaceAll('_', ' '));
  return `#${one.number} ${one.title}, ${lookOf(one).word}${now.length > 0 ? `: ${now.join(', ')}` : ''}`;
}
