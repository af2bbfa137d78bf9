// SPDX-License-Identifier: Apache-2.0
// Standard calls: the list that a key opens, and a line for each call that nobody has read back.
import { useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { Signature, myName } from '../commands/signature';
import { STATUS } from '../design/status';
import { notes, refreshNotes } from '../notes/model';
import { position, positionWords } from '../procedures/position';
import { runNow, tick } from '../run/shown';
import type { RunStore } from '../run/store';
import {
  makeCall,
  problem,
  readBack,
  readBackNewest,
  readBackWithin,
  readBackWords,
  saying,
  standardCalls,
  toReadBack,
  waiting,
} from './model';
import type { StandardCall } from './model';
import { callsAsked } from './opened';
import './style.css';

const close = () => {
  callsAsked.value = 'nothing';
  problem.value = '';
};

/** The list. Its keys act in it alone: who types elsewhere makes no call. */
function List() {
  const box = useRef<HTMLElement>(null);
  const asking = useSignal<StandardCall | undefined>(undefined);
  const given = useSignal('');
  useLayoutEffect(() => {
    const before = document.activeElement;
    const element = box.current;
    (element?.querySelector<HTMLElement>('input') ?? element)?.focus();
    return () => {
      if (
        before instanceof HTMLElement &&
        (document.activeElement === document.body || element?.contains(document.activeElement))
      )
        before.focus();
    };
  }, []);
  const make = async (call: StandardCall) => {
    if (call.asks !== '' && asking.value !== call) {
      asking.value = call;
      given.value = '';
      requestAnimationFrame(() => box.current?.querySelector<HTMLElement>('[data-testid=call-given]')?.focus());
      return;
    }
    if (await makeCall(call, given.value.trim())) close();
    else if (myName() === '') box.current?.querySelector<HTMLElement>('.signature')?.focus();
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    event.stopPropagation(); // no key of the page acts under it
    const inField = event.target instanceof HTMLInputElement;
    if (event.key === 'Escape') {
      if (asking.value) {
        asking.value = undefined;
        box.current?.focus();
      } else close();
    } else if (event.key === 'Enter' && inField && !event.repeat) {
      if (asking.value) void make(asking.value);
      else box.current?.focus(); // the name is given
    } else {
      const call = inField || event.repeat ? undefined : standardCalls().find(({ key }) => key === event.key);
      if (!call) return;
      void make(call);
    }
    event.preventDefault();
  };
  return (
    <section
      class="calls-list corner-sheet"
      role="dialog"
      aria-label="standard calls"
      data-testid="calls"
      tabIndex={-1}
      ref={box}
      onKeyDown={onKeyDown}
    >
      <h2>
        <span>Call{position.value && `, as ${positionWords(position.value)}`}</span>
        <button type="button" class="quiet" onClick={close}>
          close <kbd>Esc</kbd>
        </button>
      </h2>
      <Signature />
      {asking.value ? (
        <label>
          {asking.value.says}: {asking.value.asks}
          <input
            data-testid="call-given"
            maxLength={200}
            autocomplete="off"
            value={given.value}
            onInput={(event) => (given.value = event.currentTarget.value)}
          />
        </label>
      ) : (
        <ul>
          {standardCalls().map((call) => (
            <li key={call.call}>
              <button type="button" data-call={call.call} disabled={saying.value} onClick={() => void make(call)}>
                <kbd>{call.key}</kbd> {call.says}
                {call.asks && ' …'}
              </button>
            </li>
          ))}
        </ul>
      )}
      {problem.value && (
        <p role="alert" class="status-alarm" data-testid="call-problem">
          ✖ {problem.value}
        </p>
      )}
    </section>
  );
}

const LOOKS = { waits: STATUS.next, late: STATUS.missing } as const;

/** The calls that wait to be read back. */
function Waiting({ run }: { run: RunStore }) {
  void tick.value;
  const all = notes.value?.run === run.id ? notes.value.all : [];
  const now_s = run.ertNow_s;
  const calls = waiting(all, now_s);
  const next = toReadBack(calls);
  if (calls.length === 0) return null;
  return (
    <ul
      class="calls-waiting"
      data-testid="calls-waiting"
      aria-label="calls that nobody has read back"
      aria-live="polite"
    >
      {calls.map((call) => {
        const { words, state } = readBackWords(call, now_s, readBackWithin());
        const look = LOOKS[state === 'late' ? 'late' : 'waits'];
        return (
          <li key={call.made.seq} data-state={state}>
            <span class={`status-${look.token}`}>{look.shape}</span> <b>{call.made.text}</b>{' '}
            <span class="status-dim">
              {call.made.by}, {words}
            </span>{' '}
            {call.made.by !== myName() && (
              <button type="button" disabled={saying.value} onClick={() => void readBack(call)}>
                read back {call === next && <kbd>6</kbd>}
              </button>
            )}
          </li>
        );
      })}
    </ul>
  );
}

export function Calls() {
  const run = runNow();
  const asked = callsAsked.value;
  useEffect(() => void refreshNotes(), [run?.id, run?.notesVersion]);
  useEffect(() => {
    if (asked !== 'read back' || !run) return;
    void readBackNewest(run.ertNow_s).then((isDone) => {
      callsAsked.value = isDone || problem.value === '' ? 'nothing' : 'list'; // the list has room for what is wrong
    });
  }, [asked, run?.id]);
  if (!run) return null;
  return (
    <>
      <Waiting run={run} />
      {asked === 'list' && <List />}
    </>
  );
}
