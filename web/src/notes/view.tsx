// SPDX-License-Identifier: Apache-2.0
// The shift log: the notes with time and author, a line to write in, and a search.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { mayAct } from '../access/model';
import { callsOf, readBackWithin, readBackWords } from '../calls/model';
import { Signature } from '../commands/signature';
import { Foot } from '../design/foot';
import { STATUS } from '../design/status';
import { cutoff, pastRange, runNow } from '../run/shown';
import { dayOfYear, fromEntry } from '../run/time';
import { found, notes, problem, refreshNotes, write, writing } from './model';
import './style.css';

const AGAIN_MS = 3000; // chosen: interval of requests for the notes of others, while the panel is shown

const text = signal('');
const search = signal('');
const atInstant = signal(false);

/** A note of several lines shows its first; a search opens them, since what it found may stand in any. */
function Text({ text, isOpen }: { text: string; isOpen: boolean }) {
  const [first, ...rest] = text.split('\n');
  if (rest.length === 0) return <p>{text}</p>;
  return (
    <details open={isOpen}>
      <summary>
        {first}{' '}
        <small>
          +{rest.length} {rest.length === 1 ? 'line' : 'lines'}
        </small>
      </summary>
      <p>{rest.join('\n')}</p>
    </details>
  );
}

const LOOKS = { done: STATUS.holds, waits: STATUS.next, late: STATUS.missing } as const;

/** Of a standard call: who read it back, or that nobody has. */
function ReadBack({ of }: { of: ReturnType<typeof readBackWords> | undefined }) {
  if (!of) return null;
  const { shape, token } = LOOKS[of.state];
  return (
    <span class={`status-${token}`} data-read-back={of.state}>
      {shape} {of.words}
    </span>
  );
}

export function Notes() {
  const run = runNow();
  const id = run?.id;
  const told = run?.notesVersion;
  useEffect(() => void refreshNotes(), [id, told]);
  useEffect(() => {
    const timer = setInterval(() => void refreshNotes(), AGAIN_MS);
    return () => clearInterval(timer);
  }, [id]);
  if (!run) return <p class="none">no run</p>;
  const all = notes.value?.run === run.id ? notes.value.all : [];
  const shown = found(all, search.value, run, cutoff.value);
  const instant = Math.min(run.seenSclk, cutoff.value);
  const known = all.filter(({ ert_s }) => run.knownBy(ert_s, cutoff.value));
  const calls = new Map(callsOf(known).map((call) => [call.made.seq, call]));
  const now_s = cutoff.value === Infinity ? run.ertNow_s : run.ertOf(cutoff.value);
  const readBackOf = (seq: number) => {
    const call = calls.get(seq);
    return call && readBackWords(call, now_s, readBackWithin(), !run.going && cutoff.value === Infinity);
  };
  return (
    <div class="table-box" data-testid="notes">
      <form
        class="table-tools"
        onSubmit={(event) => {
          event.preventDefault();
          const sent = text.value;
          void write(sent, atInstant.value ? instant : undefined).then((written) => {
            if (written && text.value === sent) text.value = ''; // text typed meanwhile is the next note
          });
        }}
      >
        <input
          class="note-text"
          data-testid="note-text"
          aria-label="write a note"
          placeholder={mayAct() ? 'write a note; Enter keeps it' : 'observers write no notes'}
          value={text.value}
          disabled={!mayAct()}
          onInput={(event) => (text.value = event.currentTarget.value)}
        />
        <label>
          <input
            type="checkbox"
            data-testid="note-instant"
            checked={atInstant.value}
            onChange={(event) => (atInstant.value = event.currentTarget.checked)}
          />{' '}
          at {fromEntry(instant - run.entrySclk)}
        </label>
        <Signature />
        <button type="submit" disabled={!mayAct() || writing.value}>
          keep
        </button>
        <input
          type="search"
          class="note-search"
          data-testid="note-search"
          aria-label="search notes"
          placeholder="search"
          value={search.value}
          onInput={(event) => (search.value = event.currentTarget.value)}
        />
      </form>
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="note-problem">
          ✖ {problem.value}
        </p>
      )}
      {pastRange.value && (
        <p class="not-past">◧ Only what had been written by then; what you write now is not among these.</p>
      )}
      <ol class="notes table-scroll" tabIndex={0} aria-label="notes, newest first" data-testid="note-list">
        {shown.map((row) => (
          <li
            key={row.seq}
            data-menu={row.sclk === undefined ? undefined : 'instant of a note'}
            data-at={row.sclk === undefined ? undefined : row.sclk - run.entrySclk}
          >
            <time>{dayOfYear(row.ert_s, 3)}</time> <b>{row.by || 'unsigned'}</b>{' '}
            {row.sclk !== undefined && <i>on {fromEntry(row.sclk - run.entrySclk)}</i>}
            <ReadBack of={readBackOf(row.seq)} />
            <Text text={row.text} isOpen={search.value.trim() !== ''} />
          </li>
        ))}
        {shown.length === 0 && (
          <li class="none">{search.value ? `no note has “${search.value}”` : 'nothing is written down yet'}</li>
        )}
        <Foot as="li" />
      </ol>
    </div>
  );
}
