// SPDX-License-Identifier: Apache-2.0
// One step of a procedure: its state, who does it, what it waits for by which evidence, and what can be done now.
import { signal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { prepare, step as lineStep } from '../commands/line';
import { STATUS } from '../design/status';
import { cutoff, pastRange, runNow, signalOfRun, store, takesActs, takesCommands } from '../run/shown';
import type { RunStore } from '../run/store';
import { dayOfYear, fromEntry, secondsOfErt } from '../run/time';
import { roughly } from '../situation/countdown';
import { STEP_LOOKS, VERDICTS, act, awaitedOf, busy, executions, isNow, isOver, offered, problem } from './model';
import type { ActKind, Condition, Deed, Execution, Prepared, Signature, Step } from './model';
import { byWords, lacking, position, positionWords } from './position';
import { goOn } from './shown';

export const inWords = (id: string): string => id.replaceAll('_', ' ');

/** An ERT by the clock on top: what was received then. */
export const clockOf = (run: RunStore, us: string | undefined): string =>
  us === undefined ? '' : fromEntry(run.sclkSeenAt(secondsOfErt(us)) - run.entrySclk);

/** Earth's time at the instant shown, seconds since 1970. */
export const earthNow = (run: RunStore): number => run.ertOf(Math.min(run.seenSclk, cutoff.value));

/** Whether what is shown is the end of a run that is over: nothing is of now then. */
export const isAfterEnd = (run: RunStore): boolean => pastRange.value === undefined && !run.going;

/** How long a step still has; undefined: no limit whose instant is known, or it does not run. */
export function leftWords(run: RunStore, step: Step): { words: string; late: boolean; title: string } | undefined {
  if (step.limit_us === undefined || !isNow(step) || isAfterEnd(run)) return undefined;
  const at = secondsOfErt(step.limit_us);
  const left = at - earthNow(run);
  if (Number.isNaN(left)) return undefined;
  const title = `${step.limits}: until ${dayOfYear(at)} ERT`;
  return left < 0 || step.state === 'late'
    ? { words: `late by ${roughly(Math.max(0, -left))}`, late: true, title }
    : { words: `${roughly(left)} left`, late: false, title };
}

/** Words in which no time is broken at the end of a line. */
export function Whole({ words }: { words: string }) {
  return (
    <>
      {words
        .split(/(\d{4}-\d{3}T\S+)/)
        .map((part, index) => (index % 2 === 1 ? <span class="unbroken">{part}</span> : part))}
    </>
  );
}

/** `calm`: of a watchdog, for which it is good that they do not hold. */
export function Conditions({ of, label, calm = false }: { of: readonly Condition[]; label: string; calm?: boolean }) {
  if (of.length === 0) return null;
  return (
    <ul class="step-conditions" aria-label={label}>
      {of.map(({ text, verdict, evidence }) => {
        const isCalm = calm && verdict === 'does_not_hold';
        const { shape, word } = isCalm ? { shape: '○', word: 'does not hold' } : STATUS[VERDICTS[verdict]];
        return (
          <li key={text} class={isCalm ? 'unknown' : VERDICTS[verdict]} data-verdict={verdict}>
            <span role="img" aria-label={word}>
              {shape}
            </span>{' '}
            <span>
              <Whole words={text} />
              {evidence !== '' && (
                <small>
                  {' '}
                  <Whole words={evidence} />
                </small>
              )}
            </span>
          </li>
        );
      })}
    </ul>
  );
}

// ---- Acts that need a reason ---------------------------------------------------------------------------------------

/** What waits for a reason, in place; one at a time. */
export const wanting = signalOfRun<
  { number: number; deed: Deed; words: string; then?: (reason: string) => void } | undefined
>(undefined);
const reason = signal('');

export async function does(number: number, deed: Deed): Promise<void> {
  if (await act(number, deed)) {
    if (wanting.value?.number === number) wanting.value = undefined;
    goOn();
  }
}

/** Does it at once, or asks for the reason first. */
export function start(
  number: number,
  deed: Deed,
  words: string,
  needsReason: boolean,
  then?: (reason: string) => void,
): void {
  problem.value = '';
  if (!needsReason) {
    void does(number, deed);
    return;
  }
  reason.value = '';
  wanting.value = { number, deed, words, ...(then && { then }) };
}

/** The field for the reason, where it belongs to this place. */
export function Reason({ number, place }: { number: number; place: string }) {
  const wants = wanting.value;
  const input = useRef<HTMLInputElement>(null);
  const isHere = wants?.number === number && (wants.deed.step ?? '') === place;
  useLayoutEffect(() => {
    if (isHere) input.current?.focus();
  }, [isHere, wants]);
  if (!wants || !isHere) return null;
  const close = () => {
    wanting.value = undefined;
    goOn();
  };
  return (
    <form
      class="step-reason"
      data-testid="procedure-reason"
      onSubmit={(event) => {
        event.preventDefault();
        if (wants.then) {
          wanting.value = undefined;
          wants.then(reason.value);
        } else void does(number, { ...wants.deed, reason: reason.value });
      }}
      onKeyDown={(event) => {
        if (event.key !== 'Escape') return;
        event.preventDefault();
        event.stopPropagation();
        close();
      }}
    >
      <label>
        {wants.words}: why?{' '}
        <input
          ref={input}
          maxLength={500}
          value={reason.value}
          onInput={(event) => (reason.value = event.currentTarget.value)}
        />
      </label>
      <button type="submit" disabled={reason.value.trim() === '' || busy.value}>
        {wants.words}
      </button>
      <button type="button" class="quiet" onClick={close}>
        not <kbd>Esc</kbd>
      </button>
    </form>
  );
}

// ---- A step's command ----------------------------------------------------------------------------------------------

const argumentWords = ({ name, arguments: given, to_fill, from_solution }: Prepared): string =>
  [
    name,
    ...given.map((each) => `${each.name}=${each.text}`),
    ...to_fill.map((each) => `${each}=…`),
    ...(from_solution ? ['(from ground’s solution)'] : []),
  ].join(' ');

/** Commands of the run that may be the step's, sent since its turn came, which no step has as its own. */
export function untied(run: RunStore, step: Step, all: readonly Execution[]): number[] {
  if (!step.command || step.since_us === undefined) return [];
  const since = secondsOfErt(step.since_us);
  const tied = new Set(all.flatMap((one) => one.steps.map((each) => Number(each.command?.command ?? 0))));
  return [...run.commands.values()]
    .filter((row) => row.name === step.command?.name && !tied.has(row.command))
    .filter((row) => [...row.stages.values()].flat().every(({ ert_s }) => ert_s >= since))
    .map((row) => row.command)
    .sort((one, other) => one - other);
}

/** `why`: the reason for sending it again; '': it is sent for the first time. */
function openCommand(one: Execution, step: Step, command: Prepared, why: string): void {
  const run = store.value;
  problem.value = '';
  prepare({
    command: command.name,
    words: `step ${inWords(step.step)} of ${one.title}`,
    given: new Map(command.arguments.map(({ name, text }) => [name, text])),
    fromSolution: command.from_solution,
    // a command is stored before it is answered, so the server knows the number
    sent: (number) => {
      if (store.value !== run) return; // it is tied to the step by hand
      void act(one.number, { kind: 'sent', step: step.step, command: number, reason: why }).then((taken) => {
        if (taken || store.value !== run) return;
        const untold = `number ${number} was sent, and the step does not know it: tie it to the step here`;
        problem.value = problem.value === '' ? untold : `${problem.value}; ${untold}`;
      });
    },
  });
}

function Command({ one, step, command, run }: { one: Execution; step: Step; command: Prepared; run: RunStore }) {
  return (
    <p class="step-command" data-testid="step-command">
      <code>{argumentWords(command)}</code>{' '}
      {command.command === '0' ? (
        isOver(step) ? (
          <small>not sent</small>
        ) : (
          <small>done once it is {command.until}</small>
        )
      ) : (
        <>
          is <b>#{command.command}</b>{' '}
          <small>
            <Whole words={command.evidence} />
          </small>
        </>
      )}
      {takesActs() &&
        offered(step.acts, step, position.value).includes('sent') &&
        untied(run, step, executions.value ?? []).map((number) => (
          <button
            type="button"
            key={number}
            disabled={busy.value || lacking() !== ''}
            onClick={() =>
              start(
                one.number,
                { kind: 'sent', step: step.step, command: number },
                `it was sent as #${number}`,
                command.command !== '0',
              )
            }
          >
            it was sent as #{number}
          </button>
        ))}
    </p>
  );
}

// ---- What can be done ----------------------------------------------------------------------------------------------

const hasLine = () => document.querySelector('[data-testid="command-line"]') !== null;

/** A command that has failed, or of which something is not known, is sent again for a reason alone. */
function Send({ one, step, command, stops }: { one: Execution; step: Step; command: Prepared; stops: boolean }) {
  const again = command.command !== '0';
  const deed: Deed = { kind: 'sent', step: step.step };
  return (
    <button
      type="button"
      class={again ? 'quiet' : ''}
      data-act="sent"
      data-first={!again || undefined}
      disabled={stops || !takesCommands() || !hasLine() || lineStep.value === 'sending'}
      title={hasLine() ? undefined : 'this page has no command line: send it from the whole console, then tie it here'}
      aria-label={`send the command of step ${inWords(step.step)}${again ? ' again' : ''}`}
      onClick={() => {
        if (!again) return openCommand(one, step, command, '');
        start(one.number, deed, 'send again', true, (why) => openCommand(one, step, command, why));
      }}
    >
      {again ? 'send again …' : 'into the command line'}
    </button>
  );
}

function Acts({ one, step }: { one: Execution; step: Step }) {
  if (!takesActs() || step.acts.length === 0) return null;
  const mine = offered(step.acts, step, position.value);
  const stops = busy.value || lacking() !== '';
  const name = inWords(step.step);
  const button = (kind: ActKind, words: string, needsReason: boolean) =>
    mine.includes(kind) && (
      <button
        type="button"
        key={kind}
        class={kind === 'skip' ? 'quiet' : ''}
        data-act={kind}
        data-first={kind !== 'skip' || undefined}
        disabled={stops}
        aria-label={`${words} step ${name}`}
        onClick={() => start(one.number, { kind, step: step.step }, words, needsReason)}
      >
        {words}
        {needsReason && ' …'}
      </button>
    );
  const isAgain = step.command !== undefined && step.command.command !== '0';
  const main = mine.filter((kind) => kind !== 'skip' && !(kind === 'sent' && isAgain));
  return (
    <div class="step-acts" role="group" aria-label={`what can be done with step ${name}`}>
      {button('release', 'release', false)}
      {button('sign', 'sign', false)}
      {button('tick', 'tick', step.reason_wanted)}
      {mine.includes('sent') && step.command && <Send one={one} step={step} command={step.command} stops={stops} />}
      {main.length === 0 && position.value !== '' && (
        <small>
          waits for{' '}
          {awaitedOf(step)
            .map((each) => positionWords(each))
            .join(', ')}
        </small>
      )}
      {button('skip', 'skip', true)}
    </div>
  );
}

function Choices({ one, step }: { one: Execution; step: Step }) {
  if (step.choices.length === 0) return null;
  const may = takesActs() && offered(step.acts, step, position.value).includes('choose');
  return (
    <ol class="step-choices" aria-label="ways on">
      {step.choices.map((choice, index) => {
        const words = `choose “${choice.text}”`;
        return (
          <li key={choice.text} class={step.chosen === index ? 'chosen' : ''}>
            {may ? (
              <button
                type="button"
                data-act="choose"
                data-first
                disabled={busy.value || lacking() !== ''}
                onClick={() =>
                  start(one.number, { kind: 'choose', step: step.step, choice: index }, words, choice.reason_wanted)
                }
              >
                {choice.text}
                {choice.reason_wanted && ' …'}
              </button>
            ) : (
              <b>
                {step.chosen === index && '✓ '}
                {choice.text}
              </b>
            )}{' '}
            <small>goes to {inWords(choice.go_to)}</small>
            <Conditions of={choice.conditions} label={`what speaks for “${choice.text}”`} />
          </li>
        );
      })}
    </ol>
  );
}

function Signatures({ step, run }: { step: Step; run: RunStore }) {
  if (step.signatures_wanted.length === 0) return null;
  return (
    <ul class="step-signatures" aria-label="signatures">
      {step.signatures_wanted.map((wanted) => {
        const given = step.signatures.find((each: Signature) => each.position === wanted);
        return (
          <li key={wanted} class={given ? 'status-good' : 'status-dim'}>
            {given ? '✓' : '○'} {positionWords(wanted)}
            {given && (
              <small>
                {' '}
                {given.by}, {clockOf(run, given.at_us)}
              </small>
            )}
          </li>
        );
      })}
    </ul>
  );
}

// ---- The step ------------------------------------------------------------------------------------------------------

const opened = signalOfRun<ReadonlySet<string>>(new Set());
function toggle(key: string): void {
  const next = new Set(opened.value);
  if (!next.delete(key)) next.add(key);
  opened.value = next;
}

/** `one`: undefined for a step of the library, which nobody carries out. */
export function StepRow({ step, one }: { step: Step; one: Execution | undefined }) {
  const run = runNow();
  const look = STEP_LOOKS[step.state];
  const now = one !== undefined && isNow(step);
  const key = `${one?.number ?? 'library'} ${step.step}`;
  const isOpened = now || opened.value.has(key);
  const left = run && now ? leftWords(run, step) : undefined;
  const name = inWords(step.step);
  return (
    <li
      class={`step step-${step.state} ${now ? 'step-now' : ''}`}
      data-step={step.step}
      data-next={now || undefined}
      tabIndex={-1}
      data-state={step.state}
    >
      <div class="step-head">
        <span class={`status-${look.token} step-mark`} title={look.word}>
          {look.shape}
        </span>
        {now ? (
          <b class="step-name">{name}</b>
        ) : (
          <button type="button" class="step-name" aria-expanded={isOpened} onClick={() => toggle(key)}>
            {name}
          </button>
        )}
        <span class="step-who">{positionWords(step.who)}</span>
        {!isOpened && (
          <span class="step-brief" title={step.text}>
            {step.text}
          </span>
        )}
        <span class={`step-when ${left?.late ? 'status-caution' : ''}`} title={left?.title}>
          {one && isOver(step) ? (
            <>
              {look.word}
              {step.state !== 'not_taken' && run && ` ${clockOf(run, step.over_us)}`}
            </>
          ) : left ? (
            <>
              {left.late && '▲ '}
              {left.words}
            </>
          ) : now && run ? (
            isAfterEnd(run) ? (
              'not done when the run ended'
            ) : (
              look.word
            )
          ) : (
            ''
          )}
        </span>
      </div>
      {isOpened && run && (
        <div class="step-body">
          <p>{step.text}</p>
          {(step.limits !== '' || (step.hold !== '' && !now)) && (
            <p class="step-limits">
              {[step.hold !== '' && !now && `held until ${positionWords(step.hold)} releases it`, step.limits]
                .filter(Boolean)
                .join('; ')}
            </p>
          )}
          <Conditions of={step.conditions} label={`conditions of step ${name}`} />
          <Signatures step={step} run={run} />
          {step.command && one && <Command one={one} step={step} command={step.command} run={run} />}
          {step.command && !one && (
            <p class="step-command">
              <code>{argumentWords(step.command)}</code> <small>done once it is {step.command.until}</small>
            </p>
          )}
          {one && <Choices one={one} step={step} />}
          {!one &&
            step.choices.map((choice) => (
              <p key={choice.text}>
                {choice.text}: goes to {inWords(choice.go_to)}
              </p>
            ))}
          {step.by !== '' && (
            <p>
              {look.word} by {byWords(step.by)}
              {step.reason && `: “${step.reason}”`}
            </p>
          )}
          {one && <Acts one={one} step={step} />}
          {one && <Reason number={one.number} place={step.step} />}
        </div>
      )}
    </li>
  );
}
