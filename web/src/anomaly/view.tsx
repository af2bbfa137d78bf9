// SPDX-License-Identifier: Apache-2.0
// The anomaly report: the text prepared at the instant at which it was opened, to be edited, with a field for what its
// author thinks the cause is. It becomes a note of the shift log of the run that it is about.
import { untracked, useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useMemo, useRef } from 'preact/hooks';
import { mayAct } from '../access/model';
import { Signature } from '../commands/signature';
import { uplink } from '../commands/line';
import { OCTETS, keepNote, writing } from '../notes/model';
import { notify } from '../run/shown';
import { focusPanel, takeBackArmed } from '../shortcuts/model';
import { CAUSE_LETTERS, firstLine, reportOf } from './model';
import { instantNow } from './now';
import { leaveReport, leavingAsks, reportState, reportTyped } from './opened';
import './style.css';

const KEPT_MS = 5000; // chosen: long enough to be read

/** Keeps the focus while it is shown, and gives it back afterwards unless it has gone elsewhere. */
function useFocusWithin() {
  const box = useRef<HTMLElement>(null);
  useLayoutEffect(() => {
    const before = document.activeElement;
    const element = box.current;
    (element?.querySelector<HTMLElement>('input') ?? element?.querySelector('button'))?.focus();
    return () => {
      const { activeElement } = document;
      const isElsewhere = activeElement !== document.body && !element?.contains(activeElement);
      if (!isElsewhere && before instanceof HTMLElement && before !== document.body) before.focus();
    };
  }, []);
  return box;
}

function Form() {
  const made = useMemo(() => {
    const instant = untracked(() => (mayAct() ? instantNow() : undefined));
    return instant && reportOf(instant);
  }, []);
  const box = useFocusWithin();
  const cause = useSignal('');
  const text = useSignal(made ? made.text : '');
  const problem = useSignal('');
  const whole = made ? `${firstLine(cause.value, made.view)}\n${text.value.trim()}` : '';
  const octets = new TextEncoder().encode(whole).length;

  const send = async () => {
    if (!made || writing.value) return;
    leavingAsks.value = false;
    problem.value = '';
    const why = await keepNote(made.run, whole, made.sclk);
    const isStillOpen = box.current?.isConnected === true;
    if (why === '') {
      if (isStillOpen) reportState.value = 'kept';
    } else if (isStillOpen) {
      problem.value = why;
      const name = box.current?.querySelector<HTMLInputElement>('.signature');
      if (uplink.value.controller.trim() === '') name?.focus(); // a note needs a name
    } else notify(`The anomaly report: ${why}`);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    event.stopPropagation(); // no key of the page acts under it
    const field = event.target instanceof HTMLElement ? event.target.dataset.testid : undefined;
    if (event.key === 'Escape') {
      if (!takeBackArmed()) leaveReport();
    } else if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) {
      if (!event.repeat) void send();
    } else if (event.key === 'Enter' && field === 'report-cause') {
      box.current?.querySelector('textarea')?.focus();
    } else return;
    event.preventDefault();
  };
  const onInput = () => {
    reportTyped.value = true;
    leavingAsks.value = false;
  };

  return (
    <section
      class="report corner-sheet"
      role="dialog"
      aria-labelledby="report-title"
      data-testid="report"
      ref={box}
      onKeyDown={onKeyDown}
    >
      <h2>
        <span id="report-title">Anomaly report{made && `, ${made.at}`}</span>
        <button type="button" class="quiet" onClick={leaveReport}>
          {leavingAsks.value ? 'throw it away' : 'close'} <kbd>Esc</kbd>
        </button>
      </h2>
      {!made ? (
        <p data-testid="report-none">
          {mayAct()
            ? 'There is no run to report on.'
            : 'Observers write nothing into the shift log, so they send no anomaly report: tell a controller what you see.'}
        </p>
      ) : (
        <>
          <label>
            What I think it is
            <input
              data-testid="report-cause"
              placeholder="the cause; may stay empty"
              maxLength={CAUSE_LETTERS}
              autocomplete="off"
              value={cause.value}
              onInput={(event) => {
                cause.value = event.currentTarget.value;
                onInput();
              }}
            />
          </label>
          <p class="report-first" data-testid="report-first">
            {firstLine(cause.value, made.view)}
          </p>
          <textarea
            data-testid="report-text"
            aria-label="text of the report"
            spellcheck={false}
            value={text.value}
            onInput={(event) => {
              text.value = event.currentTarget.value;
              onInput();
            }}
          />
          {problem.value && (
            <p role="alert" class="status-alarm" data-testid="report-problem">
              ✖ {problem.value}
            </p>
          )}
          {leavingAsks.value && (
            <p role="alert" class="status-caution" data-testid="report-asks">
              ▲ It is not in the shift log. Esc again throws it away; Ctrl Enter sends it.
            </p>
          )}
          <footer>
            <button type="button" class="primary" data-testid="report-send" disabled={writing.value} onClick={send}>
              send to the shift log <kbd>Ctrl Enter</kbd>
            </button>
            <Signature />
            <small class={octets > OCTETS ? 'status-alarm' : ''}>
              {octets} of {OCTETS} octets
            </small>
          </footer>
        </>
      )}
    </section>
  );
}

function Kept() {
  useEffect(() => {
    const timer = setTimeout(leaveReport, KEPT_MS);
    return () => clearTimeout(timer);
  }, []);
  return (
    <section class="report report-kept" data-testid="report-kept" aria-label="anomaly report">
      <p>
        <span role="status">
          <span class="status-good" aria-hidden="true">
            ✓
          </span>{' '}
          The anomaly report is in the shift log.
        </span>{' '}
        <button type="button" class="quiet" onClick={() => focusPanel('notes')}>
          show it <kbd>n</kbd>
        </button>
      </p>
    </section>
  );
}

export function AnomalyReport() {
  return reportState.value === 'kept' ? <Kept /> : <Form />;
}
