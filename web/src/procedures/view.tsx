// SPDX-License-Identifier: Apache-2.0
// The panel: which procedure is shown, who the person is, and below it the procedure, those that are over, or the
// library.
import { signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { access, mayAct } from '../access/model';
import { uplink } from '../commands/line';
import { Signature } from '../commands/signature';
import { Foot } from '../design/foot';
import { myPositions } from '../positions/model';
import { Room } from '../positions/view';
import { stream } from '../run/connection';
import { pastRange, runNow, takesActs } from '../run/shown';
import { ExecutionView } from './execution_view';
import { Library } from './library';
import { executions, library, lookOf, problem, refreshLibrary, refreshProcedures, underWay } from './model';
import type { Execution } from './model';
import { choosePosition, lacking, position, positionWords } from './position';
import { goOn, show, shownNow } from './shown';
import { clockOf } from './step';
import './style.css';

const LOOK_MS = 300; // chosen: the interval of looks for news; only news is asked for

/** Keeps the statuses of the run up to date while a component is shown. */
export function useProcedures(): void {
  useEffect(() => {
    const look = () => void refreshProcedures();
    look();
    const timer = setInterval(look, LOOK_MS);
    return () => clearInterval(timer);
  }, []);
}

/** Two of one name are told apart by their numbers. */
const tabTitle = (one: Execution, all: readonly Execution[]): string =>
  all.filter(({ procedure }) => procedure === one.procedure).length > 1 ? `${one.title} #${one.number}` : one.title;

function Tools() {
  const [shown, all] = [shownNow.value, executions.value ?? []];
  const over = all.filter((one) => one.over).length;
  return (
    <div class="table-tools">
      <span class="procedure-tabs" role="group" aria-label="procedures">
        {underWay.value.map((one) => {
          const look = lookOf(one);
          return (
            <button
              type="button"
              key={one.number}
              aria-pressed={typeof shown === 'object' && shown.number === one.number}
              data-testid={`procedure-${one.number}`}
              title={look.word}
              onClick={() => show(one.number)}
            >
              <span class={`status-${look.token}`} role="img" aria-label={look.word}>
                {look.shape}
              </span>{' '}
              {tabTitle(one, all)}
            </button>
          );
        })}
        <button
          type="button"
          aria-pressed={shown === 'library'}
          data-testid="procedures-library"
          onClick={() => show('library')}
        >
          library
        </button>
        {over > 0 && (
          <button
            type="button"
            aria-pressed={shown === 'over'}
            data-testid="procedures-over"
            onClick={() => show('over')}
          >
            {over} over
          </button>
        )}
      </span>
      {takesActs() && library.value !== 'none' && <Me />}
    </div>
  );
}

const changes = signal(false);

/** Who the person is: asked for until it is known, then a word that can be pressed while there is a choice. */
function Me() {
  const lacks = lacking();
  const select = useRef<HTMLSelectElement>(null);
  const isAsked = changes.value;
  const held = myPositions.value;
  useEffect(() => {
    if (isAsked && document.activeElement === document.body) select.current?.focus();
  }, [isAsked]);
  if (access.value.state === 'in' && held.length === 1)
    return <span data-testid="position-held">I am {positionWords(position.value)}</span>;
  if (lacks === '' && !isAsked)
    return (
      <button type="button" class="quiet" data-testid="position-change" onClick={() => (changes.value = true)}>
        I am {positionWords(position.value)}
        {access.value.state !== 'in' && `, ${uplink.value.controller.trim()}`}
      </button>
    );
  const all = library.value === 'none' ? [] : (library.value?.positions ?? []);
  const close = (event: Event) => {
    event.preventDefault();
    if (lacking() !== '') return;
    changes.value = false;
    goOn();
  };
  return (
    <form
      class="procedure-me"
      onSubmit={close}
      onFocusOut={(event) => {
        if (!(event.relatedTarget instanceof Node && event.currentTarget.contains(event.relatedTarget)))
          changes.value = false;
      }}
      onFocusIn={() => (changes.value = true)}
    >
      <label>
        I am{' '}
        <select
          ref={select}
          data-testid="position"
          data-first={position.value === '' || undefined}
          aria-label="your position"
          value={position.value}
          disabled={!mayAct()}
          onChange={(event) => choosePosition(event.currentTarget.value)}
          onKeyDown={(event) => event.key === 'Enter' && close(event)}
        >
          {held.length === 0 && <option value="">choose …</option>}
          {(held.length > 0 ? held : all).map((each) => (
            <option key={each} value={each}>
              {positionWords(each)}
            </option>
          ))}
        </select>
      </label>
      <Signature />
      {lacks !== '' && (
        <span class="status-caution" role="status" data-testid="procedures-lack">
          □ {lacks}
        </span>
      )}
    </form>
  );
}

function Over({ of }: { of: readonly Execution[] }) {
  const run = runNow();
  if (!run) return null;
  return (
    <ul class="library" data-testid="procedures-over-list">
      {of.map((one) => {
        const look = lookOf(one);
        return (
          <li key={one.number} class="library-entry">
            <div class="step-head">
              <span class={`status-${look.token}`}>
                {look.shape} {look.word}
              </span>
              <button type="button" class="step-name" onClick={() => show(one.number)}>
                {one.title} #{one.number}
              </button>
              <span class="step-when">begun {clockOf(run, one.begun_us)}</span>
            </div>
          </li>
        );
      })}
    </ul>
  );
}

/** ↑ ↓ from what can be pressed in one row to that of the next. */
function onArrow(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (!['ArrowDown', 'ArrowUp'].includes(event.key) || target.matches('input, select')) return;
  const list = event.currentTarget as HTMLElement;
  const all = [...list.querySelectorAll<HTMLElement>('button:not(:disabled), summary')];
  const row = (each: HTMLElement) => each.closest('li, .procedure-head, .room, summary');
  const ahead = event.key === 'ArrowDown';
  const isBehind = (each: HTMLElement) =>
    (target.compareDocumentPosition(each) &
      (ahead ? Node.DOCUMENT_POSITION_FOLLOWING : Node.DOCUMENT_POSITION_PRECEDING)) !==
    0;
  const isOfRow = (each: HTMLElement) => target.matches('button, summary') && row(each) === row(target);
  const others = all.filter((each) => isBehind(each) && !isOfRow(each));
  const nearest = ahead ? others[0] : others.at(-1);
  const first = nearest && all.find((each) => row(each) === row(nearest) && isBehind(each));
  const to = target === list ? all[0] : (first ?? nearest);
  if (!to) return;
  event.preventDefault();
  event.stopPropagation();
  to.focus();
}

export function Procedures() {
  const run = runNow();
  useProcedures();
  useEffect(() => {
    if (library.value === undefined) void refreshLibrary();
    const timer = setInterval(() => library.value === undefined && void refreshLibrary(), 2000);
    return () => clearInterval(timer);
  }, []);
  const [shown, isLost] = [shownNow.value, stream.value.state === 'lost'];
  if (library.value === undefined || (run && executions.value === undefined))
    return (
      <p class="none" data-loading role="status">
        asking for the procedures…
      </p>
    );
  return (
    <div class={`table-box procedures ${isLost ? 'is-old' : ''}`} data-testid="procedures">
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="procedure-problem">
          ✖ {problem.value}
        </p>
      )}
      {isLost && <p class="procedures-old">◌ Not connected: as they stood when they were last heard of.</p>}
      {pastRange.value && <p class="not-past">◧ As they stood then; nothing can be done in the past.</p>}
      <div
        class="table-scroll"
        tabIndex={0}
        role="region"
        aria-label={
          shown === 'library'
            ? 'library of procedures'
            : shown === 'over'
              ? 'procedures that are over'
              : `procedure ${shown.title}`
        }
        onKeyDown={onArrow}
      >
        <Room />
        <Tools />
        {shown === 'library' ? (
          <Library />
        ) : shown === 'over' ? (
          <Over of={(executions.value ?? []).filter((one) => one.over)} />
        ) : (
          <ExecutionView key={shown.number} one={shown} />
        )}
        <Foot />
      </div>
    </div>
  );
}
