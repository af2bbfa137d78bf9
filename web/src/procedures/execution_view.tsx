// SPDX-License-Identifier: Apache-2.0
// One procedure of the run: how it stands, its steps by part, its watchdogs, and what people did.
import { useEffect, useRef, useState } from 'preact/hooks';
import { cutoff, runNow, takesActs } from '../run/shown';
import type { RunStore } from '../run/store';
import { secondsOfErt } from '../run/time';
import { beginIt } from './shown';
import { Conditions, Reason, StepRow, clockOf, inWords, start } from './step';
import { actsOf, busy, isNow, lookOf, offered, offeredOfWhole, printOf, revisionWords, trippedOf } from './model';
import type { ActItem, ActKind, Execution, Step, Watchdog } from './model';
import { byWords, lacking, position, positionWords } from './position';

export const PARTS = [
  ['preconditions', 'Preconditions, in any order'],
  ['body', 'Main body'],
  ['confirmation', 'Confirmation, in any order'],
] as const;

function WatchdogRow({ dog, one, run }: { dog: Watchdog; one: Execution | undefined; run: RunStore }) {
  const isTripped = dog.tripped_us !== undefined;
  const waits = isTripped && !dog.acknowledged;
  const mayAct = one !== undefined && takesActs();
  return (
    <li class={`step watchdog ${waits ? 'watchdog-tripped' : ''}`} data-watchdog={dog.watchdog}>
      <div class="step-head">
        <span class={`step-mark status-${waits ? 'caution' : 'dim'}`}>{waits ? '▲' : isTripped ? '✓' : '○'}</span>
        <b class="step-name">watchdog {inWords(dog.watchdog)}</b>
        <span class="step-who">{positionWords(dog.who)}</span>
        <span class="step-when">{isTripped ? `tripped ${clockOf(run, dog.tripped_us)}` : one ? 'watches' : ''}</span>
      </div>
      <div class="step-body">
        <p>
          {dog.text}
          {dog.hold && ' It holds the procedure.'}
        </p>
        <Conditions calm of={dog.conditions} label={`conditions of watchdog ${inWords(dog.watchdog)}`} />
        {dog.acknowledged && (
          <p>
            acknowledged by {dog.acknowledged.by} ({positionWords(dog.acknowledged.position)}),{' '}
            {clockOf(run, dog.acknowledged.at_us)}
          </p>
        )}
        {mayAct && (
          <div class="step-acts">
            {offered(dog.acts, { who: dog.who }, position.value).includes('acknowledge') && (
              <button
                type="button"
                data-act="acknowledge"
                data-first
                disabled={busy.value || lacking() !== ''}
                aria-label={`acknowledge watchdog ${inWords(dog.watchdog)}`}
                onClick={() => start(one.number, { kind: 'acknowledge', step: dog.watchdog }, 'acknowledge', false)}
              >
                acknowledge
              </button>
            )}
            {waits && dog.begin !== '' && (
              <button type="button" disabled={busy.value || lacking() !== ''} onClick={() => void beginIt(dog.begin)}>
                begin {inWords(dog.begin)}
              </button>
            )}
          </div>
        )}
      </div>
    </li>
  );
}

/** Watchdogs that have not tripped, or were seen: folded away. */
export function Watchdogs({ of, one, run }: { of: readonly Watchdog[]; one: Execution | undefined; run: RunStore }) {
  if (of.length === 0) return null;
  const seen = of.filter(({ acknowledged }) => acknowledged !== undefined).length;
  return (
    <details class="watchdogs">
      <summary>
        {of.length} {of.length === 1 ? 'watchdog' : 'watchdogs'}
        {seen > 0 && `, ${seen} acknowledged`}
      </summary>
      <ul class="steps">
        {of.map((dog) => (
          <WatchdogRow key={dog.watchdog} dog={dog} one={one} run={run} />
        ))}
      </ul>
    </details>
  );
}

/** What people did with it, oldest first, as far as it was done by the instant shown. */
function History({ one, run }: { one: Execution; run: RunStore }) {
  const [acts, setActs] = useState<ActItem[] | 'failed'>();
  const [isOpened, setOpened] = useState(false);
  const version = run.proceduresVersion;
  useEffect(() => {
    if (!isOpened) return undefined;
    let wanted = true;
    actsOf(run.id, one.number).then(
      (list) => wanted && setActs(list),
      () => wanted && setActs((before) => before ?? 'failed'),
    );
    return () => {
      wanted = false;
    };
  }, [isOpened, one.number, version]);
  return (
    <details
      class="procedure-history"
      data-testid="procedure-history"
      onToggle={(event) => setOpened(event.currentTarget.open)}
    >
      <summary>What was done, by whom</summary>
      {isOpened && acts === undefined && <p class="none">asking…</p>}
      {acts === 'failed' && <p class="none">? the server did not tell</p>}
      {Array.isArray(acts) && (
        <ol>
          {acts
            .filter(({ ert_us }) => run.knownBy(secondsOfErt(ert_us), cutoff.value))
            .map(({ seq, ert_us, procedure_act: of }) => (
              <li key={seq}>
                <time>{clockOf(run, ert_us)}</time> {of.kind} {inWords(of.step)}
                {of.kind === 'choose' && of.choice !== undefined && ` way ${of.choice + 1}`}
                {of.kind === 'sent' && ` as #${of.command}`}, {of.by} ({positionWords(of.position)})
                {of.reason && `: “${of.reason}”`}
              </li>
            ))}
        </ol>
      )}
    </details>
  );
}

function Head({ one, run }: { one: Execution; run: RunStore }) {
  const look = lookOf(one);
  const mine = takesActs() ? offeredOfWhole(one, position.value) : [];
  const stops = busy.value || lacking() !== '';
  const button = (kind: ActKind, words: string, needsReason: boolean) =>
    mine.includes(kind) && (
      <button
        type="button"
        class={needsReason ? 'quiet' : ''}
        data-act={kind}
        data-first={!needsReason || undefined}
        disabled={stops}
        aria-label={`${words} the procedure`}
        onClick={() => start(one.number, { kind }, words, needsReason)}
      >
        {words}
        {needsReason && ' …'}
      </button>
    );
  return (
    <div class="procedure-head" data-testid="procedure-head">
      <h3 class="on-paper">{one.title}</h3>
      <div class="step-acts">
        <h3 class={`status-${look.token}`}>
          {look.shape} {look.word}
        </h3>
        <span>
          #{one.number}, {revisionWords(one)}; begun {clockOf(run, one.begun_us)} by {byWords(one.begun_by)}
          {!one.over && !run.going && '; it was under way when the run ended'}
        </span>
        {button('hold', 'hold', true)}
        {button('stop', 'stop', true)}
        <a href={printOf(one.procedure)} target="_blank" rel="noopener">
          print the library’s
        </a>
      </div>
      {one.held !== '' && (
        <div class="step-acts status-caution" role="status">
          ‖ held by {byWords(one.held)} {button('release', 'release', false)}
          {takesActs() && !mine.includes('release') && (
            <small>whoever holds it, or the flight director, releases it</small>
          )}
        </div>
      )}
      <Reason number={one.number} place="" />
    </div>
  );
}

/** Brings the steps of now into sight when they change, in their list alone. */
function useInSight(one: Execution) {
  const list = useRef<HTMLDivElement>(null);
  const now = one.steps
    .filter(isNow)
    .map(({ step }) => step)
    .join();
  useEffect(() => {
    const first = list.current?.querySelector<HTMLElement>('.watchdog-tripped, .step-now');
    const scrolled = list.current?.closest<HTMLElement>('.table-scroll');
    if (!first || !scrolled) return;
    const [row, box] = [first.getBoundingClientRect(), scrolled.getBoundingClientRect()];
    const above = parseFloat(getComputedStyle(scrolled).scrollPaddingTop) || 0;
    if (row.top < box.top + above || row.bottom > box.bottom) scrolled.scrollTop += row.top - box.top - above - 2;
  }, [one.number, now]);
  return list;
}

export function Steps({ steps, one }: { steps: readonly Step[]; one: Execution | undefined }) {
  return (
    <>
      {PARTS.map(([part, title]) => {
        const its = steps.filter((step) => step.part === part);
        if (its.length === 0) return null;
        return (
          <section key={part} aria-label={title}>
            <h4>{title}</h4>
            <ol class="steps">
              {its.map((step) => (
                <StepRow key={step.step} step={step} one={one} />
              ))}
            </ol>
          </section>
        );
      })}
    </>
  );
}

export function ExecutionView({ one }: { one: Execution }) {
  const run = runNow();
  const list = useInSight(one);
  if (!run) return null;
  const waiting = trippedOf(one);
  return (
    <div ref={list} data-testid="procedure" data-number={one.number} data-part={one.part}>
      <Head one={one} run={run} />
      {waiting.length > 0 && (
        <ul class="steps" aria-label="watchdogs that tripped">
          {waiting.map((dog) => (
            <WatchdogRow key={dog.watchdog} dog={dog} one={one} run={run} />
          ))}
        </ul>
      )}
      <Steps steps={one.steps} one={one} />
      <Watchdogs of={one.watchdogs.filter((dog) => !waiting.includes(dog))} one={one} run={run} />
      <History key={one.number} one={one} run={run} />
    </div>
  );
}
