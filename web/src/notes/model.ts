// SPDX-License-Identifier: Apache-2.0
// The shift log of a run, with remarks at instants of the run.
import { signal } from '@preact/signals';
import { uplink } from '../commands/line';
import { wordsFor } from '../run/api';
import { change, read } from '../run/connection';
import { store } from '../run/shown';
import type { RunStore } from '../run/store';
import { secondsOfErt } from '../run/time';

export interface NoteRow {
  seq: number;
  text: string;
  by: string;
  ert_s: number;
  sclk: number | undefined;
  call: string; // of a standard call its id; empty: it is none
  readsBack: number; // the call that it reads back, by its number; 0: none
}
interface NoteList {
  notes?: {
    seq: string;
    ert_us: string;
    note: { text: string; by?: string; sclk?: number; call?: string; reads_back?: string };
  }[];
  next_after?: string | number;
}

const PAGES = 20; // chosen: number of answers that are put together
export const OCTETS = 4000; // the server's limit

export const notes = signal<{ run: number; all: NoteRow[] } | undefined>(undefined);
export const problem = signal('');
export const writing = signal(false);

let asking = false;

export async function refreshNotes(): Promise<void> {
  const run = store.value;
  if (!run || asking) return;
  asking = true;
  try {
    const known = notes.value?.run === run.id ? notes.value.all : [];
    const all = [...known];
    let after = all.at(-1)?.seq ?? 0;
    for (let page = 0; page < PAGES; ++page) {
      const list = await read<NoteList>(`/runs/${run.id}/notes${after > 0 ? `?after=${after}` : ''}`);
      for (const { seq, ert_us, note } of list.notes ?? []) {
        if (Number(seq) > (all.at(-1)?.seq ?? 0))
          all.push({
            seq: Number(seq),
            text: note.text,
            by: note.by ?? '',
            ert_s: secondsOfErt(ert_us),
            sclk: note.sclk,
            call: note.call ?? '',
            readsBack: Number(note.reads_back ?? 0),
          });
      }
      after = Number(list.next_after ?? 0);
      if (after === 0) break;
    }
    if (store.value === run) notes.value = { run: run.id, all };
  } catch {
    // The header reports the lost connection; the next round asks again.
  } finally {
    asking = false;
  }
}

/** Writes a note into the log of a run once. Returns why it was not written; empty: it was. */
export async function keepNote(run: RunStore, text: string, sclk: number | undefined): Promise<string> {
  const octets = new TextEncoder().encode(text.trim()).length;
  if (octets === 0) return 'there is nothing to write down';
  if (octets > OCTETS) return `it has ${octets} octets; a note has at most ${OCTETS}`;
  writing.value = true;
  try {
    await change(`/runs/${run.id}/notes`, {
      text: text.trim(),
      by: uplink.value.controller.trim(),
      ...(sclk !== undefined && { sclk }),
    });
    await refreshNotes();
    return '';
  } catch (error) {
    return `it was not written down: ${wordsFor(error)}`;
  } finally {
    writing.value = false;
  }
}

/** Writes a note of the run shown; true if it was written. */
export async function write(text: string, sclk: number | undefined): Promise<boolean> {
  const run = store.value;
  if (!run || writing.value) return false;
  problem.value = '';
  problem.value = await keepNote(run, text, sclk);
  return problem.value === '';
}

/**
 * The notes newest first, in a past view those written by then. Every search word must occur in the text or the name.
 */
export function found(
  all: readonly NoteRow[],
  search: string,
  run: Pick<RunStore, 'sclkSeenAt'>,
  cutoff: number,
): NoteRow[] {
  const words = search
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== '');
  return all
    .filter((row) => {
      const text = `${row.text} ${row.by}`.toLowerCase();
      return words.every((word) => text.includes(word)) && !(run.sclkSeenAt(row.ert_s) > cutoff);
    })
    .reverse();
}
