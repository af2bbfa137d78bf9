// SPDX-License-Identifier: Apache-2.0
// The instructor's panel of a running rehearsal: faults to inject, a line for notes, the plan, and the list so far. It
// is folded away, since the people rehearsed may look at the same screen.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { access, mayInstruct, mayRehearse, whyNotInstruct } from '../access/model';
import { Signature } from '../commands/signature';
import { STATUS } from '../design/status';
import { runNow } from '../run/shown';
import { fromEntry } from '../run/time';
import { FaultForm, faultWords } from './faults';
import { LibraryForm } from './library_form';
import { busy, messageWords, ofRun, refreshInterventions, write } from './instructor';
import type { Intervention } from './instructor';
import { planOf, refreshPlan, titleOf } from './plan';
import type { Plan } from './plan';
import { PlanView } from './plan_view';

const AGAIN_MS = 3000; // chosen: interval of requests for the entries of another instructor, while it is open

const open = signal(false);
const text = signal('');

export function InterventionList({ of, plan }: { of: readonly Intervention[]; plan?: Plan | undefined }) {
  return (
    <ul class="interventions" data-testid="interventions">
      {of.map(({ e_s, fault, note, skipped, inject }, i) => (
        <li key={i}>
          <time>{fromEntry(e_s, { tenths: true })}</time>{' '}
          {fault ? (
            <>
              ▲ {faultWords(fault)}
              {inject && <span class="status-dim"> as planned: {titleOf(plan, inject)}</span>}
            </>
          ) : skipped ? (
            <>– skipped: {titleOf(plan, inject ?? '')}</>
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
  const plan = run && planOf(run);
  useEffect(() => {
    const refresh = () => void Promise.all([refreshInterventions(), refreshPlan()]);
    refresh();
    const timer = setInterval(refresh, AGAIN_MS);
    return () => clearInterval(timer);
  }, [id]);
  return (
    <>
      <FaultForm />
      <LibraryForm />
      <NoteForm />
      <p role="status" data-testid="instructor-message">
        {messageWords()}
      </p>
      {plan && <PlanView of={plan} going />}
      {run && <InterventionList of={ofRun(run)} plan={plan} />}
      <p class="status-dim">
        {access.value.state === 'in'
          ? 'Until the run is over, the server shows this only to instructors.'
          : 'Until the run is over this stands nowhere else. This server has no accounts: whoever opens this fold can read it.'}
      </p>
    </>
  );
}

/** The panel, for users with the right to instruct. Who may only start and end a run is told of the right. */
export function InstructorPanel() {
  if (!mayInstruct())
    return mayRehearse() ? (
      <p class="status-dim" data-testid="not-instructor">
        {STATUS.missing.shape} {whyNotInstruct('faults and notes of a rehearsal')}
      </p>
    ) : null;
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
