// SPDX-License-Identifier: Apache-2.0
// Standard calls: lines of the shift log by one key, and their read-backs. The list is the mission's; who read what
// back, and when, is in the log.
import { signal } from '@preact/signals';
import { myName } from '../commands/signature';
import { notes, refreshNotes } from '../notes/model';
import type { NoteRow } from '../notes/model';
import { position } from '../procedures/position';
import { wordsFor } from '../run/api';
import { change } from '../run/connection';
import { dictionary, store } from '../run/shown';
import { duration } from '../run/time';

/** Of the mission's list. */
export interface StandardCall {
  call: string;
  key: string;
  says: string;
  asks: string; // what is given with it; empty: nothing
}
export const standardCalls = (): readonly StandardCall[] => dictionary.value?.reply.calls ?? [];
/** Within so long a call should be read back. */
export const readBackWithin = (): number => dictionary.value?.reply.readBackS ?? 0;

/** A call of the log with the first line that reads it back. */
export interface Call {
  made: NoteRow;
  readBack: NoteRow | undefined;
}

/** The calls in a log, oldest first. */
export function callsOf(all: readonly NoteRow[]): Call[] {
  const readBacks = new Map<number, NoteRow>();
  for (const row of all) if (row.readsBack > 0 && !readBacks.has(row.readsBack)) readBacks.set(row.readsBack, row);
  return all
    .filter(({ call, readsBack }) => call !== '' && readsBack === 0)
    .map((made) => ({ made, readBack: readBacks.get(made.seq) }));
}

/** What is known of a read-back at `now_s`. `late`: it has not come within the mission's time, or before the end. */
export function readBackWords(
  { made, readBack }: Call,
  now_s: number,
  within_s: number,
  isOver = false,
): { words: string; state: 'done' | 'waits' | 'late' } {
  if (readBack)
    return {
      words: `read back by ${readBack.by || 'someone'} ${duration(readBack.ert_s - made.ert_s)} later`,
      state: 'done',
    };
  const age_s = Math.max(0, now_s - made.ert_s);
  if (isOver) return { words: 'not read back', state: 'late' };
  return age_s > within_s
    ? { words: `not read back for ${duration(age_s)}`, state: 'late' }
    : { words: 'not read back yet', state: 'waits' };
}

const SHOWN_S = 300; // chosen: so old a call is a matter of the log

/** The calls that wait for a read-back, the newest first. */
export const waiting = (all: readonly NoteRow[], now_s: number): Call[] =>
  callsOf(all)
    .filter(({ made, readBack }) => !readBack && now_s - made.ert_s <= SHOWN_S)
    .reverse();

/** The newest call of another that waits for a read-back. */
export const toReadBack = (calls: readonly Call[]): Call | undefined => calls.find(({ made }) => made.by !== myName());

export const problem = signal('');
export const saying = signal(false);

/** Says one line once. True if it is in the log. */
async function say(line: object): Promise<boolean> {
  const run = store.value;
  if (!run || saying.value) return false;
  if (myName() === '') {
    problem.value = 'type your name first';
    return false;
  }
  saying.value = true;
  problem.value = '';
  try {
    await change(`/runs/${run.id}/notes`, { by: myName(), position: position.value, ...line });
    await refreshNotes();
    return true;
  } catch (error) {
    problem.value = wordsFor(error);
    return false;
  } finally {
    saying.value = false;
  }
}

export const makeCall = ({ call }: StandardCall, given = ''): Promise<boolean> =>
  say({ call, ...(given !== '' && { text: given }) });
export const readBack = ({ made }: Call): Promise<boolean> => say({ reads_back: String(made.seq) });

/** Reads back the newest call of another. @returns whether there is nothing more to say about it */
export async function readBackNewest(now_s: number): Promise<boolean> {
  await refreshNotes();
  const run = store.value;
  const all = notes.value && run && notes.value.run === run.id ? notes.value.all : [];
  const call = toReadBack(waiting(all, now_s));
  if (call) return readBack(call);
  problem.value = 'no call of another waits to be read back';
  return false;
}
