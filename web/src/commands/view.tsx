// SPDX-License-Identifier: Apache-2.0
// Commands: one line with completion; below it the review, the queue and the history.
import type { ComponentChildren } from 'preact';
import { mayAct } from '../access/model';
import { openedLater } from '../design/opened_later';
import { Foot } from '../design/foot';
import { Panel } from '../design/panel';
import { hasNoCommands, pastRange, runNow, takesCommands } from '../run/shown';
import './disarm';
import { History, Queue } from './history';
import {
  back,
  choiceIndex,
  choose,
  chosen,
  complete,
  forward,
  inArguments,
  line,
  lineFocused,
  message,
  offered,
  openCommandLine,
  step,
  type,
} from './line';
import { isHazardous, rangeText, unitText } from './model';
import { Armed, Review } from './review';
import { myName } from './signature';
import './style.css';

const CommandFile = openedLater(async () => (await import('./file_view')).CommandFile);

function onKey(event: KeyboardEvent): void {
  if (event.key === 'Enter') void forward();
  else if (event.key === 'Escape') back();
  else if (event.key === 'Tab' && step.value === 'type' && line.value.trim() !== '' && !event.shiftKey) {
    if (!complete()) return; // Tab then moves to the next field
  } else if (event.key === 'ArrowDown' && step.value === 'type')
    choiceIndex.value = Math.min((inArguments.value?.offers ?? offered.value).length - 1, choiceIndex.value + 1);
  else if (event.key === 'ArrowUp' && step.value === 'type') choiceIndex.value = Math.max(0, choiceIndex.value - 1);
  else if (event.key !== '/' || line.value !== '') return; // '/' in the empty line opens it and is not text
  event.preventDefault();
  event.stopPropagation();
}

const SHOWN = 8;

/** An option to pick by pointer. The command line keeps the focus and handles the keys. */
function Offer({ index, onPick, children }: { index: number; onPick: () => void; children: ComponentChildren }) {
  const pick = () => {
    onPick();
    openCommandLine();
  };
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: the keys are the command line's
    // biome-ignore lint/a11y/useFocusableInteractive: it is named by the command line's aria-activedescendant
    <div id={`offer-${index}`} role="option" aria-selected={index === choiceIndex.value} onClick={pick}>
      {children}
    </div>
  );
}

function Offers() {
  const within = inArguments.value;
  if (within) {
    return (
      <div
        class="offers"
        role="listbox"
        id="offers"
        aria-label={`arguments of ${within.command.name}`}
        data-testid="argument-offers"
      >
        {within.offers.slice(0, SHOWN).map((offer, index) => {
          const argument = within.command.arguments.find((each) => `${each.name}=` === offer);
          return (
            <Offer
              key={offer}
              index={index}
              onPick={() => {
                choiceIndex.value = index;
                complete();
              }}
            >
              <b>
                {within.stem}
                {offer}
              </b>{' '}
              <span>{argument && `${unitText(argument)} ${rangeText(argument)} ${argument.text}`}</span>
            </Offer>
          );
        })}
        {within.offers.length === 0 && <div class="none">Enter goes on</div>}
      </div>
    );
  }
  return (
    <div class="offers" role="listbox" id="offers" aria-label="commands of the dictionary">
      {offered.value.slice(0, SHOWN).map((command, index) => (
        <Offer key={command.name} index={index} onPick={() => choose(command.name)}>
          <b>
            {isHazardous(command) ? '▲ ' : ''}
            {command.name}
          </b>{' '}
          <span>{command.text}</span>
        </Offer>
      ))}
      {offered.value.length === 0 && <div class="none">no command has these words</div>}
    </div>
  );
}

/** Why no command of this person leaves by the rules of the room: a dry run says nothing of it. */
function ClosedByTheRoom() {
  const board = runNow()?.positions?.board;
  const by = board?.seats.find(({ position }) => position === 'command')?.by ?? '';
  const others = by !== '' && by !== myName();
  const closed = others ? `command is held by ${by}` : (board?.closed ?? '');
  if (closed === '') return null;
  return (
    <p class="caution" role="status" data-testid="commanding-closed">
      ▲ {others ? 'Commands are sent by another' : 'Commanding is closed'}: {closed}
    </p>
  );
}

export function Commands() {
  const command = chosen.value;
  const canSend = takesCommands();
  if (hasNoCommands())
    return (
      <Panel name="commands" title="Command">
        <p class="none" data-testid="no-commands">
          This venue has no commands here.
        </p>
      </Panel>
    );
  return (
    <Panel
      name="commands"
      title="Command"
      extra={
        canSend && (
          <span class={lineFocused.value ? 'done-hint' : ''}>
            <kbd>/</kbd> to type
          </span>
        )
      }
    >
      <div class="command-line">
        <input
          data-testid="command-line"
          role="combobox"
          aria-expanded={step.value === 'type' && line.value !== ''}
          aria-controls="offers"
          aria-activedescendant={step.value === 'type' && line.value !== '' ? `offer-${choiceIndex.value}` : undefined}
          aria-label="command line"
          autocomplete="off"
          spellcheck={false}
          placeholder={
            canSend
              ? 'type a command in words'
              : pastRange.value
                ? 'nothing can be sent from the past'
                : mayAct()
                  ? 'this run takes no commands'
                  : 'you may look, not send'
          }
          disabled={!canSend}
          value={line.value}
          onFocus={() => (lineFocused.value = true)}
          onBlur={() => (lineFocused.value = false)}
          onInput={(event) => type(event.currentTarget.value)}
          onKeyDown={onKey}
        />
      </div>
      {canSend && <ClosedByTheRoom />}
      {canSend && step.value === 'type' && line.value.trim() !== '' && <Offers />}
      {canSend && command && <Review command={command} onKey={onKey} />}
      {canSend && command && step.value === 'armed' && <Armed command={command} onKey={onKey} />}
      {message.value && (
        <p
          class={`message ${message.value.good === undefined ? '' : message.value.good ? 'good' : 'bad'}`}
          role="status"
          data-testid="command-message"
        >
          {message.value.good === undefined ? '' : message.value.good ? '✓ ' : '✖ '}
          {message.value.text}
        </p>
      )}
      <Queue />
      {canSend && <CommandFile />}
      <History />
      <Foot />
    </Panel>
  );
}
