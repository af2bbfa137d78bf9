// SPDX-License-Identifier: Apache-2.0
// The procedures of the library, each with what it is for, its steps, its print, and the button that begins it.
import { useEffect, useState } from 'preact/hooks';
import { wordsFor } from '../run/api';
import { runNow, takesActs } from '../run/shown';
import { Steps, Watchdogs } from './execution_view';
import { busy, library, printOf, refreshForm, revisionWords } from './model';
import type { Entry, Form } from './model';
import { lacking } from './position';
import { beginIt } from './shown';

/** Its steps, before anybody begins it. */
function Whole({ procedure }: { procedure: string }) {
  const run = runNow();
  const [form, setForm] = useState<Form | string>();
  useEffect(() => {
    let wanted = true;
    refreshForm(procedure).then(
      (found) => wanted && setForm(found),
      (error: unknown) => wanted && setForm(wordsFor(error)),
    );
    return () => {
      wanted = false;
    };
  }, [procedure]);
  if (form === undefined) return <p class="none">asking…</p>;
  if (typeof form === 'string') return <p class="status-alarm">✖ {form}</p>;
  return (
    <div data-testid="procedure-form">
      <p>{form.entry.purpose}</p>
      <p>
        <small>{form.source}</small>
      </p>
      <Steps steps={form.steps} one={undefined} />
      {run && <Watchdogs of={form.watchdogs} one={undefined} run={run} />}
    </div>
  );
}

function EntryRow({ entry, canBegin }: { entry: Entry; canBegin: boolean }) {
  const [isOpened, setOpened] = useState(false);
  return (
    <li class="library-entry" data-procedure={entry.procedure}>
      <div class="step-head">
        {entry.findings.length === 0 && canBegin && (
          <button
            type="button"
            data-act="begin"
            data-first
            disabled={busy.value || lacking() !== ''}
            aria-label={`begin ${entry.title}`}
            onClick={() => void beginIt(entry.procedure)}
          >
            begin
          </button>
        )}
        <button type="button" class="step-name" aria-expanded={isOpened} onClick={() => setOpened(!isOpened)}>
          {entry.title}
        </button>
        <span class="library-revision">{revisionWords(entry)}</span>
        <a href={printOf(entry.procedure)} target="_blank" rel="noopener" aria-label={`print ${entry.title}`}>
          print
        </a>
      </div>
      <div class="step-body">
        <p>{entry.begin_when}</p>
        {entry.findings.length > 0 && (
          <p class="status-caution">
            ▲ It breaks {entry.findings.length} {entry.findings.length === 1 ? 'rule' : 'rules'} and cannot be begun:{' '}
            {entry.findings[0]}
          </p>
        )}
        {isOpened && <Whole procedure={entry.procedure} />}
      </div>
    </li>
  );
}

export function Library() {
  const run = runNow();
  const known = library.value;
  if (known === undefined) return <p class="none">asking…</p>;
  if (known === 'none') return <p class="none">This server has no procedures.</p>;
  if (known.procedures.length === 0) return <p class="none">The library has no procedure.</p>;
  return (
    <ul class="library" data-testid="procedure-library">
      {known.procedures.map((entry) => (
        <EntryRow key={entry.procedure} entry={entry} canBegin={run !== undefined && takesActs()} />
      ))}
    </ul>
  );
}
