// SPDX-License-Identifier: Apache-2.0
// The state of a command file: read, tried out while shown, armed where needed, sent once.
import { computed, signal } from '@preact/signals';
import { learnAccess } from '../access/model';
import { Refused, isOpen, wordsFor } from '../run/api';
import { change } from '../run/connection';
import { dictionary, store } from '../run/shown';
import type { RunStore } from '../run/store';
import { confirms, hazardousIn, readFile, sequenceOf } from './file_model';
import type { SequenceAnswer } from './file_model';
import { uplink } from './line';

export const text = signal('');
export const stage = signal<'review' | 'armed' | 'sending'>('review');
export const typedNames = signal('');
export const outcome = signal<{ good: boolean; text: string } | undefined>(undefined);

export const file = computed(() => (text.value.trim() === '' ? undefined : readFile(text.value)));
export const commands = computed(() => (file.value && 'commands' in file.value ? file.value.commands : []));
export const hazardous = computed(() => (dictionary.value ? hazardousIn(commands.value, dictionary.value) : []));

/** The ground's answer to the commands as shown; `problem`: why there is none. */
export const tried = signal<{ of: string; answer?: SequenceAnswer; problem?: string } | undefined>(undefined);
const looks = signal(0); // counts openings of the form; an answer belongs to one of them
const key = () => JSON.stringify([looks.value, store.value?.id, uplink.value.controller, commands.value]);
export const triedNow = computed(() => (tried.value?.of === key() ? tried.value : undefined));

/** Reads a file. Ignored while a file is sent, because the answer belongs to the displayed one. */
export function read(typed: string): void {
  if (stage.value === 'sending') return;
  text.value = typed;
  stage.value = 'review';
  typedNames.value = '';
  outcome.value = undefined;
}

// chosen: a hundred commands are encoded and checked one by one, behind the gateway's other work
const ANSWER_WITHIN_MS = 60_000;

const isAnswer = (answer: unknown): answer is SequenceAnswer =>
  Array.isArray((answer as SequenceAnswer | null | undefined)?.commands);

/** Asks the ground. A refusal is an answer too. */
async function ask(run: RunStore, dryRun: boolean): Promise<SequenceAnswer> {
  try {
    const answer = await change<unknown>(
      `/runs/${run.id}/sequences`,
      sequenceOf(commands.value, hazardous.value, uplink.value.controller.trim(), dryRun),
      ANSWER_WITHIN_MS,
    );
    if (isAnswer(answer)) return answer;
    throw new Refused(0, 'the answer cannot be read: whether it was taken is not known');
  } catch (error) {
    if (error instanceof Refused && isAnswer(error.answer)) return error.answer;
    throw error;
  }
}

let trying = false;

/** Asks for a dry run of the file. One request at a time; otherwise the next round asks. */
export async function tryFile(): Promise<void> {
  const run = store.value;
  if (trying || !run || commands.value.length === 0 || stage.value === 'sending') return;
  const of = key();
  let found: Omit<NonNullable<typeof tried.value>, 'of'>;
  trying = true;
  try {
    found = { answer: await ask(run, true) };
  } catch (error) {
    found = {
      problem:
        error instanceof Refused && error.status > 0 ? wordsFor(error) : 'the ground does not answer the dry run',
    };
  } finally {
    trying = false;
  }
  if (of === key()) tried.value = { of, ...found };
}

/**
 * Takes one step: arms the file if it has a hazardous command, then sends it. Only a file that the ground has accepted.
 */
export async function forwardFile(): Promise<void> {
  const run = store.value;
  if (stage.value === 'sending' || !run || !triedNow.value?.answer?.accepted) return;
  if (hazardous.value.length > 0 && stage.value === 'review') {
    stage.value = 'armed';
    return;
  }
  if (stage.value === 'armed' && !confirms(typedNames.value, hazardous.value)) {
    outcome.value = { good: false, text: `type ${hazardous.value.join(' ')} to confirm; nothing was sent` };
    return;
  }
  stage.value = 'sending';
  try {
    const answer = await ask(run, false);
    const numbers = answer.commands.map((each) => each.command).filter((number) => number !== '0');
    outcome.value = answer.accepted
      ? {
          good: !answer.reason,
          text: `all ${numbers.length} taken: #${numbers[0]}${numbers.length > 1 ? ` to #${numbers.at(-1)}` : ''}${answer.reason && `; ${answer.reason}`}`,
        }
      : {
          good: false,
          text: `refused: ${answer.reason}; ${numbers.length > 0 ? `taken was ${numbers.map((number) => `#${number}`).join(', ')}` : 'nothing was sent'}`,
        };
    if (numbers.length > 0) text.value = ''; // so that another Enter does not send them again
    // the user's rights may have been withdrawn meanwhile
    if (!answer.accepted) void learnAccess().catch(() => undefined);
  } catch (error) {
    const said = wordsFor(error);
    const open = isOpen(error);
    outcome.value = {
      good: false,
      text: !open
        ? said.endsWith('nothing was sent')
          ? said
          : `refused: ${said}; nothing was sent`
        : `${said}${error instanceof Refused && error.status === 0 ? '' : ': whether it was taken is not known'}; the history below will say`,
    };
    if (open)
      text.value = ''; // so that another Enter does not send them again
    else void learnAccess().catch(() => undefined);
  }
  stage.value = 'review';
  typedNames.value = '';
}

export function backFile(): void {
  if (stage.value === 'armed') stage.value = 'review';
  typedNames.value = '';
}

/** Disarms the file and drops the ground's answer, which belonged to one run at one time. */
export function disarmFile(another = false): void {
  looks.value += 1;
  if (another) outcome.value = undefined; // its numbers belong to the other run
  backFile();
}
