// SPDX-License-Identifier: Apache-2.0
// The review of a finished rehearsal as the server judges it: facts, the instructor's entries, a score with its rule,
// terms and what these rest on, and what became of the instructor's plan.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { isReal } from '../mode/model';
import { wordsFor } from '../run/api';
import { read } from '../run/connection';
import { pastRange, store, tick } from '../run/shown';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { InterventionList } from './instructor_panel';
import { askInterventions, ofRun } from './instructor';
import type { Intervention } from './instructor';
import { askPlan, fateOf, planOf } from './plan';
import type { Plan } from './plan';
import { PlanView } from './plan_view';
import { Points, inOrder, shareWords, termWords } from './score';
import type { Score } from './score';

const open = signal(false);
/** `noPlan`: why the plan cannot be had. A version that no longer reads it still has the score. */
const judged = signal<{ run: number; through: number; score: Score; noPlan: string } | undefined>(undefined);
const problem = signal('');
const copied = signal<'done' | 'by hand' | undefined>(undefined);

async function judge(run: RunStore): Promise<void> {
  const through = Number(run.run.lastSeq);
  try {
    const [score, , noPlan] = await Promise.all([
      read<Score>(`/runs/${run.id}/score`),
      askInterventions(run),
      askPlan(run).then(() => '', wordsFor),
    ]);
    if (store.value !== run) return;
    judged.value = { run: run.id, through, score, noPlan };
    problem.value = '';
  } catch (error) {
    if (store.value === run) problem.value = wordsFor(error);
  }
}

/** The review as text, for copying. */
export function scoreText(title: string, of: Score, interventions: readonly Intervention[], plan?: Plan): string {
  const at = (e_s: number | undefined) => (e_s === undefined ? '' : `${fromEntry(e_s, { tenths: true })} `);
  return [
    title,
    '',
    ...of.facts.map((fact) => `${fact.of}: ${at(fact.e_s)}${fact.text}`),
    '',
    ...interventions.flatMap(({ e_s, note }) =>
      note ? [`instructor's note: ${at(e_s)}${note.by || 'unsigned'}: ${note.text}`] : [],
    ),
    `score: ${of.sum.toFixed(0)} of 100`,
    ...of.terms.flatMap((term) => [
      `  ${term.name}: ${termWords(term)} (${term.why})`,
      ...inOrder(term.judged).map(
        (point) => `    ${at(point.e_s)}${shareWords(point.share)}: ${point.expected}: ${point.evidence}`,
      ),
    ]),
    of.rule,
    '',
    ...(plan
      ? [
          `the instructor's plan: ${plan.title || plan.name}`,
          ...plan.injects.map((each) => `  ${fateOf(each, false)}: ${each.title} (${each.when || 'by hand'})`),
          '',
        ]
      : []),
  ].join('\n');
}

function Copy({ text }: { text: string }) {
  const copy = () => navigator.clipboard.writeText(text).then(() => (copied.value = 'done'));
  return (
    <>
      <button
        type="button"
        data-testid="review-copy"
        onClick={() =>
          void (navigator.clipboard ? copy() : Promise.reject(new Error())).catch(() => (copied.value = 'by hand'))
        }
      >
        copy as text
      </button>
      <span role="status">
        {copied.value === 'done'
          ? ' ✓ copied'
          : copied.value === 'by hand'
            ? ' the browser lets no page copy here: take it from the field'
            : ''}
      </span>
      {copied.value === 'by hand' && (
        <textarea
          readOnly
          rows={6}
          aria-label="the review as text"
          data-testid="review-text"
          value={text}
          onFocus={(event) => event.currentTarget.select()}
        />
      )}
    </>
  );
}

function Judged({ run, of, noPlan }: { run: RunStore; of: Score; noPlan: string }) {
  const done = ofRun(run);
  const plan = planOf(run);
  const notes = done.filter((each) => each.note);
  const title = `Aeolis, review of run ${run.id}: ${run.run.scenario}, seed ${run.run.seed}, ${run.run.started}`;
  return (
    <>
      <table data-testid="review-facts" aria-label="facts">
        <tbody>
          {of.facts.map((fact, i) => (
            <tr key={i} data-of={fact.of}>
              {fact.of === of.facts[i - 1]?.of ? <td /> : <th scope="row">{fact.of}</th>}
              <td class="number">{fact.e_s === undefined ? '' : fromEntry(fact.e_s, { tenths: true })}</td>
              <td class="wraps">{fact.text}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {notes.length > 0 && (
        <>
          <h3>The instructor wrote</h3>
          <InterventionList of={notes} />
        </>
      )}
      <h3>
        Score: <output data-testid="review-score">{of.sum.toFixed(0)} of 100</output>
      </h3>
      <table data-testid="review-terms" aria-label="terms of the score">
        <tbody>
          {of.terms.map((term) => (
            <tr key={term.name}>
              <th scope="row">{term.name}</th>
              <td class="number">{termWords(term)}</td>
              <td class="wraps">
                {term.why}
                <Points of={term.judged} plan={plan} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="status-dim">{of.rule}</p>
      <p>
        <a href={`?panel=debrief&run=${run.id}`} target="_blank" rel="noopener" data-testid="open-debrief">
          the debrief: what was done against what was known, missed steps, forks; for paper, too
        </a>
      </p>
      <p>
        <Copy text={scoreText(title, of, done, plan)} />
      </p>
      {noPlan ? (
        <p class="status-alarm refused" data-testid="review-no-plan">
          ✖ the instructor’s plan: {noPlan}
        </p>
      ) : (
        plan && <PlanView of={plan} going={false} />
      )}
    </>
  );
}

function Opened({ run }: { run: RunStore }) {
  void tick.value; // a store changes without a new object
  const through = Number(run.run.lastSeq);
  useEffect(() => {
    copied.value = undefined;
    problem.value = '';
    if (judged.value?.run !== run.id || judged.value.through !== through) void judge(run);
  }, [run.id, through]);
  const of = judged.value?.run === run.id ? judged.value : undefined;
  if (!of) return <p role="status">{problem.value ? `✖ ${problem.value}` : 'asking the server…'}</p>;
  return (
    <>
      {pastRange.value && (
        <p class="not-past">▲ The review is of the whole run, not of the past that the other panels show.</p>
      )}
      <Judged run={run} of={of.score} noPlan={of.noPlan} />
    </>
  );
}

/** The review of a finished rehearsal. */
export function Review() {
  void tick.value;
  const run = store.value; // the whole run, even where a past is shown as heard
  if (run?.run.state !== 'finished' || isReal(run.run)) return null;
  return (
    <details
      class="rehearsal-review"
      data-testid="review"
      open={open.value}
      onToggle={(event) => (open.value = event.currentTarget.open)}
    >
      <summary>Review of run {run.id}: what happened when, what the instructor did, a score</summary>
      {open.value && <Opened run={run} />}
    </details>
  );
}
