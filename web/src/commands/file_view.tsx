// SPDX-License-Identifier: Apache-2.0
// A command file in the command panel: chosen or pasted, each command with the ground's answer, then one arming and one
// sending.
import { signal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { STATUS } from '../design/status';
import { inWords } from '../run/dictionary';
import { notify, runNow, store } from '../run/shown';
import {
  backFile,
  commands,
  disarmFile,
  file,
  forwardFile,
  hazardous,
  outcome,
  read,
  stage,
  text,
  triedNow,
  tryFile,
  typedNames,
} from './file';
import { FILE_OCTETS_MAX, TOO_LONG } from './file_model';
import type { FileReply } from './file_model';

const TYPED_MS = 150; // chosen: delay after the last key
const AGAIN_MS = 1000; // chosen: as for the review of one command

const open = signal(false); // the ground is asked only while the form is open

async function take(chosen: File | undefined): Promise<void> {
  if (!chosen) return;
  if (chosen.size > FILE_OCTETS_MAX) notify(`${chosen.name}: ${TOO_LONG}`);
  else read(await chosen.text());
}

/** The ground's answer to one command; empty if the check did not reach it. */
function word(reply: FileReply | undefined) {
  if (!reply) return <td class="unknown">{STATUS.unknown.shape} not looked at</td>;
  if (!reply.accepted) return <td class="missing">✖ {reply.reason}</td>;
  return (
    <td>
      <span class="holds">✓</span> {reply.octets.length / 2} octets, at Mars <output>{reply.arrives}</output> SCET
      {reply.useful_before !== '' && (
        <>
          , to leave by <output>{reply.latest_useful}</output> ERT to come before {inWords(reply.useful_before)}
        </>
      )}
      {reply.too_late_for.length > 0 && (
        <span class="caution"> ▲ too late for {reply.too_late_for.map(inWords).join(', ')}</span>
      )}
      {reply.arguments !== '' && (
        <small class="encoded" tabIndex={0} role="group" aria-label="arguments as encoded">
          {reply.arguments}
        </small>
      )}
    </td>
  );
}

function Lines() {
  const told = triedNow.value;
  return (
    <table class="file-lines" data-testid="file-lines">
      <caption>
        {told?.problem !== undefined
          ? `✖ ${told.problem}`
          : !told?.answer
            ? '? the ground has not answered the dry run yet'
            : told.answer.accepted
              ? '✓ All would be taken as they stand here.'
              : `✖ None would go: ${told.answer.reason}`}
      </caption>
      <tbody>
        {commands.value.map((each, i) => (
          <tr key={i}>
            <th scope="row">
              {i + 1} {hazardous.value.includes(each.command) && '▲ '}
              {each.command}
            </th>
            {word(told?.answer?.commands[i])}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Armed({ onKey }: { onKey: (event: KeyboardEvent) => void }) {
  const input = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => input.current?.focus(), []);
  return (
    <div class="armed" data-testid="file-armed">
      <b>
        ▲ ARMED: {commands.value.length} {commands.value.length === 1 ? 'command' : 'commands'}
      </b>
      <label>
        <span>
          {' '}
          Type <b>{hazardous.value.join(' ')}</b> and press Enter to send all of them. Esc disarms.
        </span>
        <input
          ref={input}
          data-testid="file-confirmation"
          autocomplete="off"
          spellcheck={false}
          value={typedNames.value}
          onKeyDown={onKey}
          onInput={(event) => (typedNames.value = event.currentTarget.value)}
        />
      </label>
    </div>
  );
}

function Reviewed() {
  const key = text.value;
  useEffect(() => {
    const soon = setTimeout(() => void tryFile(), TYPED_MS);
    const again = setInterval(() => void tryFile(), AGAIN_MS);
    return () => {
      clearTimeout(soon);
      clearInterval(again);
    };
  }, [key, store.value?.id]);
  const onKey = (event: KeyboardEvent) => {
    if (event.key === 'Enter') void forwardFile();
    else if (event.key === 'Escape') backFile();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <>
      <Lines />
      {stage.value === 'armed' ? (
        <Armed onKey={onKey} />
      ) : (
        <button
          type="button"
          data-testid="file-forward"
          disabled={stage.value === 'sending' || !triedNow.value?.answer?.accepted}
          onClick={() => void forwardFile()}
        >
          {stage.value === 'sending'
            ? 'sending'
            : hazardous.value.length > 0
              ? 'arm; nothing is sent yet'
              : commands.value.length === 1
                ? 'send it'
                : `send all ${commands.value.length}`}
        </button>
      )}
    </>
  );
}

function Opened() {
  const problem = file.value && 'problem' in file.value ? file.value.problem : undefined;
  const sending = stage.value === 'sending';
  const box = useRef<HTMLTextAreaElement>(null);
  const was = useRef(stage.value);
  useLayoutEffect(() => {
    // The focused element is gone: move the focus to where the work continues.
    if (was.current !== 'review' && stage.value === 'review' && document.activeElement === document.body) {
      (text.value === '' ? box.current : document.querySelector<HTMLElement>('[data-testid="file-forward"]'))?.focus();
    }
    was.current = stage.value;
  }, [stage.value]);
  return (
    <>
      <p>
        All of it is checked before the first goes; when one command is refused none goes.{' '}
        <label class="file-choice">
          choose a file
          <input
            type="file"
            accept=".json,application/json"
            data-testid="file-chosen"
            disabled={sending}
            onChange={(event) => {
              void take(event.currentTarget.files?.[0]);
              event.currentTarget.value = '';
            }}
          />
        </label>{' '}
        or paste it:
      </p>
      <textarea
        ref={box}
        data-testid="file-text"
        aria-label="command file as JSON"
        rows={4}
        spellcheck={false}
        placeholder='{"commands": [{"command": "NO_OP"}]}'
        value={text.value}
        disabled={stage.value !== 'review'}
        onInput={(event) => read(event.currentTarget.value)}
      />
      {problem !== undefined && (
        <p class="verdict missing" data-testid="file-problem">
          ✖ {problem}
        </p>
      )}
      {commands.value.length > 0 && <Reviewed />}
      {outcome.value && (
        <p class={`message ${outcome.value.good ? 'good' : 'bad'}`} role="status" data-testid="file-message">
          {outcome.value.good ? '✓' : '✖'} {outcome.value.text}
        </p>
      )}
    </>
  );
}

export function CommandFile() {
  if (!runNow()) return null;
  return (
    <details
      class="command-file"
      data-testid="command-file"
      open={open.value}
      onToggle={(event) => {
        open.value = event.currentTarget.open;
        if (!open.value) disarmFile();
      }}
    >
      <summary>command file</summary>
      {open.value && <Opened />}
    </details>
  );
}
