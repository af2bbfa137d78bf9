// SPDX-License-Identifier: Apache-2.0
// The instructor's panel of a running rehearsal: faults to inject, a line for notes, and the list so far. It is folded
// away, since the people rehearsed may look at the same screen.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { access, mayRehearse } from '../access/model';
import { Signature } from '../commands/signature';
import { runNow } from '../run/shown';
import { fromEntry } from '../run/time';
import { FaultForm, faultWords } from './faults';
import { busy, message, ofRun, refreshInterventions, write } from './instructor';
import type { Intervention } from './instructor';

const AGAIN_MS = 3000; // chosen: interval of requests for the entries of another instructor, while it is open

const open = signal(false);
const text = signal('');

export function InterventionList({ of }: { of: readonly Intervention[] }) {
  return (
    <ul class="interventions" data-testid="interventions">
      {of.map(({ e_s, fault, note }, i) => (
        <li key={i}>
          <time>{fromEntry(e_s, { tenths: true })}</time>{' '}
          {fault ? (
            <>▲ {faultWords(fault)}</>
          ) : (
            <>
              <b>{note?.by || 'unsigned'}</b> {note?.text}
            </>
          )}
        </li>
      ))}
    </ul>
  );
}

function NoteForm() {
  return (
    <form
      class="table-tools"
      onSubmit={(event) => {
        event.preventDefault();
        const sent = text.value;
        void write(sent).then((written) => {
          if (written && text.value === sent) text.value = ''; // text typed meanwhile is the next note
        });
      }}
    >
      <input
        class="note-text"
        data-testid="instructor-note"
        aria-label="write an instructor’s note"
        placeholder="what you see them do; Enter keeps it with its instant"
        value={text.value}
        onInput={(event) => (text.value = event.currentTarget.value)}
      />
      <Signature />
      <button type="submit" disabled={busy.value}>
        keep
      </button>
    </form>
  );
}

function OpenPanel() {
  const run = runNow();
  const id = run?.id;
  useEffect(() => {
    void refreshInterventions();
    const timer = setInterval(() => void refreshInterventions(), AGAIN_MS);
    return () => clearInterval(timer);
  }, [id]);
  return (
    <>
      <FaultForm />
      <NoteForm />
      <p role="status" data-testid="instructor-message">
        {message.value && `${message.value.good ? '●' : '✖'} ${message.value.text}`}
      </p>
      {run && <InterventionList of={ofRun(run)} />}
      <p class="status-dim">
        {access.value.state === 'in'
          ? 'Until the run is over the server tells this only to who may rehearse.'
          : 'Until the run is over this stands nowhere else. This server has no accounts: whoever opens this fold can read it.'}
      </p>
    </>
  );
}

/** The panel, for users with the right to rehearse; others do not see that it exists. */
export function InstructorPanel() {
  if (!mayRehearse()) return null;
  return (
    <details
      class="instructor"
      data-testid="instructor"
      open={open.value}
      onToggle={(event) => (open.value = event.currentTarget.open)}
    >
      <summary>Instructor: break something, write notes for the review</summary>
      {open.value && <OpenPanel />}
    </details>
  );
}
