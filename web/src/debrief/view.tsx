// SPDX-License-Identifier: Apache-2.0
// The debrief of a run that is over, as a page and for paper: its injects against what the room did, what was known
// when, what could have been seen, missed steps, forks, and the score with its evidence.
import type { ComponentChildren } from 'preact';
import { useEffect } from 'preact/hooks';
import { callsOf } from '../calls/model';
import { outcomeWords } from '../clocks/model';
import { STATUS } from '../design/status';
import type { Status } from '../design/status';
import { notes } from '../notes/model';
import { byWords, positionWords } from '../procedures/position';
import type { Execution } from '../procedures/model';
import { planOf } from '../rehearsal/plan';
import type { Plan } from '../rehearsal/plan';
import { Points, termWords } from '../rehearsal/score';
import type { Score, ScoreFault } from '../rehearsal/score';
import { pastRange, runs, store, tick } from '../run/shown';
import type { RunStore } from '../run/store';
import { duration } from '../run/time';
import type { NamedRun } from '../stream/names';
import {
  askDebrief,
  askScores,
  at,
  debrief,
  earthWords,
  endOf,
  knownWhen,
  missedOf,
  nameOf,
  notDone,
  scoresOfForks,
  signWords,
  timelineOf,
  timesOf,
} from './model';
import type { Missed, Row, Times } from './model';
import './style.css';

const ROWS_MOST = 2000; // chosen: a page of some 60 sheets; who wants more asks /score
const FORKS_SCORED = 8; // chosen: each score is as much work for the server as the whole report

function Part({ name, title, children }: { name: string; title: string; children: ComponentChildren }) {
  return (
    <section data-testid={`debrief-${name}`} aria-label={title}>
      <h3>{title}</h3>
      {children}
    </section>
  );
}

/** Words in which no time is broken at the end of a line. */
function Whole({ words }: { words: string }) {
  return <>{words.split(/(E[+−]\d[\d:.]*)/).map((part, i) => (i % 2 === 1 ? <time key={i}>{part}</time> : part))}</>;
}

const None = ({ children }: { children: ComponentChildren }) => <p class="status-dim">{children}</p>;

function Mark({ of, word }: { of: Status; word: string }) {
  const { shape, token } = STATUS[of];
  return (
    <span class={`debrief-mark status-${token}`}>
      {shape} {word}{' '}
    </span>
  );
}

// ---- Injects -------------------------------------------------------------------------------------------------------

function Fault({ of, score, plan, times }: { of: ScoreFault; score: Score; plan: Plan | undefined; times: Times }) {
  const inject = plan?.injects.find((each) => each.inject === of.inject);
  const points = of.inject
    ? score.terms.flatMap(({ judged }) => judged).filter((point) => point.inject === of.inject)
    : [];
  return (
    <li class="debrief-fault" data-fault={of.inject || 'by hand'}>
      <h4>
        {nameOf(of, plan)}{' '}
        <small>{of.inject ? (inject?.when ? `planned ${inject.when}` : 'of the plan, by hand') : 'by hand'}</small>
      </h4>
      {inject?.shows && <p class="status-dim">What of it can be seen: {inject.shows}</p>}
      <table class="debrief-known" aria-label={`what was known when: ${nameOf(of, plan)}`}>
        <tbody>
          {knownWhen(of, times).map(({ what, e_s, where, words }) => (
            <tr key={what} data-known={what}>
              <th scope="row">{what}</th>
              <td class="number">{e_s === undefined ? '—' : at(e_s)}</td>
              <td class="number debrief-utc">{e_s === undefined ? '' : earthWords(times, e_s)}</td>
              <td class="wraps">
                <Whole words={words} />
                {where && (
                  <span class="status-dim">
                    {' '}
                    (<Whole words={where} />)
                  </span>
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      {of.signs.length > 0 && (
        <>
          <h5>What could have been seen</h5>
          <ul class="debrief-lines">
            {of.signs.map((sign) => {
              const { words, missed } = signWords(sign, of.felt_e_s);
              return (
                <li key={sign.name}>
                  <Mark of={missed ? 'never' : 'holds'} word="" />
                  <span>
                    <b>{sign.name}</b>: <Whole words={words} />
                  </span>
                </li>
              );
            })}
          </ul>
        </>
      )}
      {points.length > 0 && (
        <>
          <h5>What was expected, and done</h5>
          <Points of={points} />
        </>
      )}
      {of.not_judged.length > 0 && (
        <>
          <h5>Not judged</h5>
          <ul class="debrief-lines">
            {of.not_judged.map((each) => (
              <li key={each}>
                <Mark of="unknown" word="" />
                <span>{each}</span>
              </li>
            ))}
          </ul>
        </>
      )}
    </li>
  );
}

function Faults({ score, plan, times }: { score: Score; plan: Plan | undefined; times: Times }) {
  const left = notDone(plan);
  return (
    <Part name="faults" title="What was injected, and what was known when">
      {plan && (
        <p>
          Plan: <b>{plan.title || plan.name}</b>. {plan.purpose}
        </p>
      )}
      {score.faults.length === 0 && <None>Nothing was injected.</None>}
      <ol class="debrief-faults">
        {score.faults.map((each, i) => (
          <Fault key={i} of={each} score={score} plan={plan} times={times} />
        ))}
      </ol>
      {left.length > 0 && (
        <ul class="debrief-lines" data-testid="debrief-not-done">
          {left.map(({ inject, title, state, when, e_s }) => (
            <li key={inject}>
              <Mark of="never" word={state === 'skipped' ? 'skipped' : 'not injected'} />
              <span>
                {title} <span class="status-dim">{when || 'by hand'}</span>
                {e_s !== undefined && ` at ${at(e_s - times.lightTime_s)}`}
              </span>
            </li>
          ))}
        </ul>
      )}
    </Part>
  );
}

// ---- The timeline --------------------------------------------------------------------------------------------------

const SIDES = { instructor: 'the instructor', received: 'received on Earth', room: 'the room' } as const;
const LOOKS: Partial<Record<Row['kind'], Status>> = { inject: 'caution', sign: 'holds', alarm: 'alarm' };

function Cell({ row, side }: { row: Row; side: Row['side'] }) {
  if (row.side !== side) return <td />;
  const look = side === 'room' ? undefined : LOOKS[row.kind];
  return (
    <td class="wraps" data-label={SIDES[side]}>
      {look && <span class={`status-${STATUS[look].token}`}>{STATUS[look].shape} </span>}
      {row.by && <b>{row.by} </b>}
      <Whole words={row.words} />
    </td>
  );
}

function Timeline({ score, rows, times }: { score: Score; rows: readonly Row[]; times: Times }) {
  return (
    <Part name="timeline" title="Injects against reactions">
      {score.acts.length === 0 && <None>Nobody acknowledged, wrote, sent or signed anything in this run.</None>}
      {rows.length > ROWS_MOST && (
        <None>
          The first {ROWS_MOST} of {rows.length} rows.
        </None>
      )}
      {rows.length > 0 && (
        <table class="debrief-timeline">
          <thead>
            <tr>
              <th>from entry</th>
              <th>UTC, on Earth</th>
              <th>the instructor did</th>
              <th>Earth received</th>
              <th>the room did</th>
            </tr>
          </thead>
          <tbody>
            {rows.slice(0, ROWS_MOST).map((row, i) => (
              <tr key={i} data-side={row.side} data-kind={row.kind}>
                <td class="number">{at(row.e_s)}</td>
                <td class="number debrief-utc">{earthWords(times, row.e_s)}</td>
                <Cell row={row} side="instructor" />
                <Cell row={row} side="received" />
                <Cell row={row} side="room" />
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </Part>
  );
}

// ---- Procedures ----------------------------------------------------------------------------------------------------

const MISSED: Record<Missed['what'], Status> = {
  skipped: 'caution',
  late: 'caution',
  'not done': 'missing',
  'not acknowledged': 'missing',
};

function Procedure({ of, times }: { of: Execution; times: Times }) {
  const { missed, notReached } = missedOf(of, times);
  return (
    <li data-procedure={of.procedure}>
      <h4>
        {of.title}{' '}
        <small>
          {of.number}, revision {of.revision}, begun {at(times.ofErt(of.begun_us))} by {byWords(of.begun_by)};{' '}
          {endOf(of)}
        </small>
      </h4>
      {missed.length === 0 && (
        <p>
          <Mark of="holds" word="no step was skipped, late, or left when it ended" />
        </p>
      )}
      <ul class="debrief-lines">
        {missed.map(({ what, step, who, text, words }) => (
          <li key={`${what} ${step}`} data-missed={what}>
            <Mark of={MISSED[what]} word={what} />
            <span>
              <b>{step.replaceAll('_', ' ')}</b> ({positionWords(who)}): <Whole words={byWords(words)} />
              <small>{text}</small>
            </span>
          </li>
        ))}
        {notReached.length > 0 && (
          <li data-missed="not reached">
            <Mark of="never" word="not reached" />
            <span>{notReached.map((step) => step.replaceAll('_', ' ')).join(', ')}</span>
          </li>
        )}
      </ul>
    </li>
  );
}

function Procedures({ of, times }: { of: readonly Execution[] | string; times: Times }) {
  return (
    <Part name="procedures" title="Procedures and missed steps">
      {typeof of === 'string' ? (
        <p class="status-alarm">✖ {of}</p>
      ) : of.length === 0 ? (
        <None>No procedure was begun.</None>
      ) : (
        <ol class="debrief-faults">
          {of.map((each) => (
            <Procedure key={each.number} of={each} times={times} />
          ))}
        </ol>
      )}
    </Part>
  );
}

// ---- Calls ---------------------------------------------------------------------------------------------------------

/** Standard calls that nobody read back. Those of the time after the run are none of it: no call can be made then. */
function CallsPart({ run, times }: { run: RunStore; times: Times }) {
  const all = notes.value?.run === run.id ? callsOf(notes.value.all) : [];
  const open = all.filter(({ readBack }) => !readBack);
  return (
    <Part name="calls" title="Standard calls">
      {all.length === 0 ? (
        <None>No standard call was made.</None>
      ) : (
        <p>
          {all.length} {all.length === 1 ? 'call was' : 'calls were'} made, {open.length} of them not read back
          {open.length > 0 && ':'}
        </p>
      )}
      <ul class="debrief-lines">
        {open.map(({ made }) => (
          <li key={made.seq}>
            <Mark of="missing" word="" />
            <span>
              {at(times.ofSeconds(made.ert_s))} <b>{made.by}</b> {made.text}
            </span>
          </li>
        ))}
      </ul>
    </Part>
  );
}

// ---- Forks ---------------------------------------------------------------------------------------------------------

const toDebrief = (run: bigint | number) => `?panel=debrief&run=${run}`;

function Fork({ of, from }: { of: NamedRun; from: number }) {
  const id = Number(of.run);
  return (
    <tr data-fork={id}>
      <td class="number">{id}</td>
      <td class="number">{at(of.forkedFrom?.eS ?? NaN)}</td>
      <td>{outcomeWords(of.outcome, of.state)}</td>
      <td class="wraps">
        {scoresOfForks.value.get(id) ?? (of.state === 'finished' ? 'not asked for' : 'it is not over')}
      </td>
      <td>
        <a href={toDebrief(id)}>its debrief</a> <a href={`?panel=what_if&run=${from}&over=${id}`}>both compared</a>
      </td>
    </tr>
  );
}

function Forks({ run }: { run: RunStore }) {
  const forks = runs.value.filter(({ forkedFrom }) => Number(forkedFrom?.run ?? 0) === run.id);
  const finished = forks.filter(({ state }) => state === 'finished').map(({ run: id }) => Number(id));
  const asked = finished.slice(0, FORKS_SCORED).join();
  useEffect(() => {
    if (asked) void askScores(asked.split(',').map(Number));
  }, [asked]);
  const from = run.run.forkedFrom;
  return (
    <Part name="forks" title="Forks">
      {from && (
        <p>
          This run is a fork of <a href={toDebrief(from.run)}>run {String(from.run)}</a> at {at(from.eS)}: what was done
          before is that run’s.
        </p>
      )}
      {forks.length === 0 ? (
        <None>No fork of this run was tried.</None>
      ) : (
        <table class="debrief-forks">
          <thead>
            <tr>
              <th class="number">run</th>
              <th class="number">forked at</th>
              <th>what came of it</th>
              <th>score</th>
              <th class="debrief-links">see</th>
            </tr>
          </thead>
          <tbody>
            {forks.map((each) => (
              <Fork key={String(each.run)} of={each} from={run.id} />
            ))}
          </tbody>
        </table>
      )}
    </Part>
  );
}

// ---- Score ---------------------------------------------------------------------------------------------------------

function ScorePart({ score }: { score: Score }) {
  const withFaults = new Set(score.faults.map(({ inject }) => inject).filter((inject) => inject !== ''));
  return (
    <Part name="score" title="Score">
      <p>
        <output data-testid="debrief-sum">{score.sum.toFixed(0)} of 100</output>
        {withFaults.size > 0 && (
          <span class="status-dim"> The points of an inject of the plan stand with it above.</span>
        )}
      </p>
      <table class="debrief-terms">
        <tbody>
          {score.terms.map((term) => (
            <tr key={term.name}>
              <th scope="row">{term.name}</th>
              <td class="number">{termWords(term)}</td>
              <td class="wraps">
                {term.why}
                <Points of={term.judged.filter(({ inject }) => !withFaults.has(inject))} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <ul class="debrief-lines" aria-label="facts of the run">
        {score.facts
          .filter(({ of }) => of !== 'fault' && of !== 'alarm')
          .map(({ of, text, e_s }, i) => (
            <li key={i}>
              <span class="debrief-mark status-dim">{of}</span>
              <span>
                <Whole words={`${text}${e_s === undefined ? '' : ` ${at(e_s)}`}`} />
              </span>
            </li>
          ))}
      </ul>
      <p class="status-dim">{score.rule}</p>
    </Part>
  );
}

// ---- The page ------------------------------------------------------------------------------------------------------

function Head({ run, score, times }: { run: RunStore; score: Score | string; times: Times }) {
  const { scenario, seed, started, outcome, state, lightTimeS } = run.run;
  return (
    <div class="debrief-head">
      <h3>
        Run {run.id}: {scenario}, seed {String(seed)}
      </h3>
      <p>
        {outcomeWords(outcome, state)}
        {typeof score !== 'string' && `, ${score.sum.toFixed(0)} of 100 points`}; started <time>{started}</time>;{' '}
        {lightTimeS > 0 ? `light time ${duration(lightTimeS)}` : 'no light time is rehearsed'}.
      </p>
      <p class="status-dim">
        Times are seconds from entry of the signal that Earth receives then
        {Number.isNaN(times.earth(0)) ? '' : ', and UTC on Earth, day of the year first'}.
        {lightTimeS > 0 &&
          ` What is done at the vehicle shows ${duration(lightTimeS)} later; a command arrives as much later.`}{' '}
        What people did after the end is left out.
      </p>
    </div>
  );
}

function Known({ run }: { run: RunStore }) {
  void tick.value; // a store changes without a new object
  useEffect(() => {
    void askDebrief(run);
    const before = document.title;
    document.title = `Aeolis debrief of run ${run.id}`; // the name of the file when it is printed to one
    return () => {
      document.title = before;
    };
  }, [run]);
  const of = debrief.value;
  if (of?.run !== run.id) return <p role="status">asking the server…</p>;
  const { score, notes: written, procedures } = of;
  const times = timesOf(run);
  const plan = planOf(run);
  return (
    <>
      <Head run={run} score={score} times={times} />
      {typeof score === 'string' ? (
        <p class="status-alarm refused" data-testid="debrief-no-score">
          ✖ no injects, acts and score: {score}
        </p>
      ) : (
        <>
          {of.plan && <p class="status-alarm refused">✖ the instructor’s plan: {of.plan}</p>}
          <Faults score={score} plan={plan} times={times} />
          <Timeline score={score} rows={timelineOf(score, plan, written, times)} times={times} />
        </>
      )}
      <Procedures of={procedures} times={times} />
      <CallsPart run={run} times={times} />
      <Forks run={run} />
      {typeof score !== 'string' && <ScorePart score={score} />}
    </>
  );
}

export function Debrief() {
  void tick.value;
  const run = store.value; // the whole run, even where a past is shown as heard
  const over = run && !run.going && run.run.state === 'finished';
  return (
    <div class="table-box debrief" data-testid="debrief">
      {run && over && (
        <div class="table-tools">
          <button type="button" data-testid="debrief-print" onClick={() => window.print()}>
            print it, or keep it as PDF
          </button>
          {pastRange.value && (
            <span class="not-past">▲ The debrief is of the whole run, not of the past that is shown.</span>
          )}
        </div>
      )}
      <div class="table-scroll" tabIndex={0} role="region" aria-label="the whole debrief">
        {!run ? (
          <p class="none">There is no run.</p>
        ) : over ? (
          <Known key={run.id} run={run} />
        ) : (
          <p class="none" data-testid="debrief-not-over">
            {run.going
              ? `Run ${run.id} goes on. It has a debrief when it is over.`
              : `Run ${run.id} was cut off and can be continued. It has a debrief when it is over.`}
          </p>
        )}
      </div>
    </div>
  );
}
