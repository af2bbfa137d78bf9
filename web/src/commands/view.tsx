// Commands: one line with completion, a form from the dictionary, arming and typed confirmation in place, and the
// history with what is known of each stage.
import { useLayoutEffect, useRef } from 'preact/hooks';
import type { DictionaryCommand } from '../gen/aeolis/v1/run_pb';
import { Panel } from '../design/panel';
import { latestSend } from '../clocks/model';
import { inWords } from '../run/dictionary';
import { cutoff, dictionary, pastRange, runNow, takesCommands, timepoints } from '../run/session';
import { duration, fromEntry } from '../run/time';
import {
  back, choiceIndex, choose, chosen, complete, confirmation, fields, formText, forward, inArguments, line, message, offered,
  openCommandLine, step, type, typed,
} from './line';
import { isHazardous, newestEvidence, preconditionsOf, rangeText, stageCells } from './model';
import './style.css';

const HISTORY_SHOWN = 12;

function onKey(event: KeyboardEvent): void {
  if (event.key === 'Enter') void forward();
  else if (event.key === 'Escape') back();
  else if (event.key === 'Tab' && step.value === 'type' && line.value.trim() !== '' && !event.shiftKey && (inArguments.value?.offers ?? offered.value).length > 0) complete();
  else if (event.key === 'ArrowDown' && step.value === 'type') choiceIndex.value = Math.min((inArguments.value?.offers ?? offered.value).length - 1, choiceIndex.value + 1);
  else if (event.key === 'ArrowUp' && step.value === 'type') choiceIndex.value = Math.max(0, choiceIndex.value - 1);
  else if (event.key !== '/' || line.value !== '') return; // the key that opens the line, pressed in it, is no text
  event.preventDefault();
  event.stopPropagation();
}

const SHOWN = 8;

function Offers() {
  const within = inArguments.value;
  if (within) {
    return (
      <ul class="offers" role="listbox" id="offers" aria-label={`arguments of ${within.command.name}`} data-testid="argument-offers">
        {within.offers.slice(0, SHOWN).map((offer, index) => {
          const argument = within.command.arguments.find((each) => `${each.name}=` === offer);
          return (
            <li key={offer} id={`offer-${index}`} role="option" aria-selected={index === choiceIndex.value} onClick={() => {
              choiceIndex.value = index;
              complete();
              openCommandLine();
            }}>
              <b>{within.stem}{offer}</b> <span>{argument && `${argument.unit} ${rangeText(argument)} ${argument.text}`}</span>
            </li>
          );
        })}
        {within.offers.length === 0 && <li class="none">Enter goes on</li>}
      </ul>
    );
  }
  return (
    <ul class="offers" role="listbox" id="offers" aria-label="commands of the dictionary">
      {offered.value.slice(0, SHOWN).map((command, index) => (
        <li key={command.name} id={`offer-${index}`} role="option" aria-selected={index === choiceIndex.value} onClick={() => {
          choose(command.name);
          openCommandLine();
        }}>
          <b>{isHazardous(command) ? '▲ ' : ''}{command.name}</b> <span>{command.text}</span>
        </li>
      ))}
      {offered.value.length === 0 && <li class="none">no command has these words</li>}
    </ul>
  );
}

function Arrival() {
  const run = runNow();
  if (!run) return null;
  const light = run.run.lightTimeS;
  const arrives = (run.clocks?.eS ?? run.seenE) + light;
  const send = latestSend(run, timepoints.value);
  return (
    <p class="arrival">
      Arrives at Mars at <output>{fromEntry(arrives)}</output>, its effect can be seen after <output>{duration(2 * light)}</output>.
      {send && (send.left_s >= 0 ? ` ${duration(send.left_s)} before ${inWords(send.first)}.` : ` ▲ Too late for ${inWords(send.first)}.`)}
    </p>
  );
}

function Review({ command }: { command: DictionaryCommand }) {
  const words = dictionary.value;
  const conditions = words ? preconditionsOf(command, words, runNow()) : [];
  const filled = fields.value.filter((field) => field.from === 'solution').length;
  return (
    <div class="review" data-testid="command-review">
      <p><b>{command.name}</b> {command.text}</p>
      {command.reasonForWarning && <p class="caution">▲ {command.reasonForWarning}</p>}
      {fields.value.length > 0 && (
        <>
          {filled > 0 && <p>{filled} of {fields.value.length} filled from ground’s navigation solution; type to change one.</p>}
          <div class="fields">
            {fields.value.map((field) => (
              <label key={field.argument.name} class={field.problem !== undefined ? 'bad' : ''} title={field.argument.text}>
                <span>{field.argument.name}</span>
                <input value={field.text} placeholder={field.value === undefined ? 'needed' : String(field.value)}
                  aria-invalid={field.problem !== undefined} disabled={typed.value.given.has(field.argument.name) || step.value !== 'review'}
                  onKeyDown={onKey}
                  onInput={(event) => (formText.value = new Map([...formText.value, [field.argument.name, event.currentTarget.value]]))} />
                <small>{field.argument.unit} {field.problem ?? rangeText(field.argument)}</small>
              </label>
            ))}
          </div>
        </>
      )}
      {conditions.length > 0 && (
        <ul class="preconditions">
          {conditions.map((condition) => (
            <li key={condition.words} class={condition.holds === undefined ? 'unknown' : condition.holds ? 'holds' : 'missing'}>
              {condition.holds === undefined ? '?' : condition.holds ? '✓' : '✖'} {condition.words} <output>{condition.value}</output>
            </li>
          ))}
        </ul>
      )}
      <Arrival />
      {step.value === 'review' && (
        <p class="next"><kbd>Enter</kbd> {isHazardous(command) ? 'arms it; nothing is sent yet' : 'sends it'} · <kbd>Esc</kbd> goes back</p>
      )}
    </div>
  );
}

function Armed({ command }: { command: DictionaryCommand }) {
  const input = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => {
    input.current?.focus(); // before the next key can be typed
    input.current?.scrollIntoView?.({ block: 'nearest' });
  }, []);
  return (
    <div class="armed" data-testid="command-armed">
      <b>▲ ARMED: {command.name}</b>
      <label>
        <span> Type <b>{command.name}</b> and press Enter to send. Esc disarms.</span>
        <input ref={input} data-testid="command-confirmation" autocomplete="off" spellcheck={false} value={confirmation.value}
          onInput={(event) => (confirmation.value = event.currentTarget.value)}
          onKeyDown={(event) => {
            const escaped = event.key === 'Escape';
            onKey(event);
            if (escaped) openCommandLine();
          }} />
      </label>
    </div>
  );
}

const STAGE_SHAPES = { ok: '✓', failed: '✖', unknown: '?', pending: '…', none: '' } as const;
const STAGE_WORDS = { ok: 'seen', failed: 'failed', unknown: 'not known', pending: 'due', none: 'nothing known' } as const;

function History() {
  const run = runNow();
  if (!run) return null;
  const known = (at: string) => !(run.sclkSeenAt(at) > cutoff.value);
  const rows = [...run.commands.values()].sort((a, b) => b.command - a.command)
    .map((row) => ({ row, cells: stageCells(row, known) }))
    .filter(({ cells }) => cells.some((cell) => cell.look !== 'none')).slice(0, HISTORY_SHOWN);
  return (
    <ol class="history" data-testid="command-history">
      {rows.map(({ row, cells }) => (
        <li key={row.command} data-command={row.name}>
          <div><b>{row.name} #{row.command}</b> <small title={row.arguments}>{newestEvidence(cells)}</small></div>
          <ol class="stages">
            {cells.map((cell) => (
              <li key={cell.stage} class={`stage stage-${cell.look}`} data-stage={cell.stage} data-look={cell.look}
                title={`${cell.stage}: ${STAGE_WORDS[cell.look]}. ${cell.evidence} ${cell.at}`}>
                <i>{STAGE_SHAPES[cell.look]}</i><span>{cell.stage}</span>
              </li>
            ))}
          </ol>
        </li>
      ))}
      {rows.length === 0 && <li class="none">no command in this run yet</li>}
    </ol>
  );
}

export function Commands() {
  const command = chosen.value;
  const canSend = takesCommands();
  return (
    <Panel name="commands" title="Command" extra={<span><kbd>/</kbd> to type</span>}>
      <div class="command-line">
        <input data-testid="command-line" role="combobox" aria-expanded={step.value === 'type' && line.value !== ''} aria-controls="offers"
          aria-activedescendant={step.value === 'type' && line.value !== '' ? `offer-${choiceIndex.value}` : undefined}
          aria-label="command line" autocomplete="off" spellcheck={false} placeholder={canSend ? 'type a command in words' : pastRange.value ? 'nothing can be sent from the past' : 'this run takes no commands'}
          disabled={!canSend} value={line.value} onInput={(event) => type(event.currentTarget.value)} onKeyDown={onKey} />
      </div>
      {canSend && step.value === 'type' && line.value.trim() !== '' && <Offers />}
      {canSend && command && <Review command={command} />}
      {canSend && command && step.value === 'armed' && <Armed command={command} />}
      {message.value && (
        <p class={`message ${message.value.good === undefined ? '' : message.value.good ? 'good' : 'bad'}`} role="status" data-testid="command-message">
          {message.value.good === undefined ? '' : message.value.good ? '✓ ' : '✖ '}{message.value.text}
        </p>
      )}
      <History />
    </Panel>
  );
}

