// SPDX-License-Identifier: Apache-2.0
// The review of a finished rehearsal: facts, the instructor's entries, then a score with its rule and terms.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { outcomeWords } from '../clocks/model';
import { isHazardous } from '../commands/model';
import type { AsFlownReport, CommandList, NoteList } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { isReal } from '../mode/model';
import { wordsFor } from '../run/api';
import { ask, read } from '../run/connection';
import { dictionary, pastRange, store, tick } from '../run/shown';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { InterventionList } from './desk';
import { askInterventions, ofRun } from './instructor';
import { RULE, miss_m, score, scoreText, termWords } from './score';
import type { AlarmChange, Landed, Score } from './score';

const ALARM_CHANGES = 200_000; // chosen, some 40 MB: no landing comes near it, and an incomplete list gets no score

const open = signal(false);
const judged = signal<{ run: number; through: number; score: Score } | undefined>(undefined);
const problem = signal('');
const copied = signal<'done' | 'by hand' | undefined>(undefined);

async function alarmChanges(run: number): Promise<AlarmChange[]> {
  const all: AlarmChange[] = [];
  for (let after = 0; ; ) {
    const list = await read<{ changes?: AlarmChange[]; next_after?: string }>(
      `/runs/${run}/alarms${after > 0 ? `?after=${after}` : ''}`,
    );
    for (const change of list.changes ?? []) all.push(change);
    const next = Number(list.next_after ?? 0);
    if (next === 0) return all;
    if (next <= after)
      throw new Error(`the server’s list of alarms does not go on after ${after}: no review is made of a part`);
    if (all.length >= ALARM_CHANGES)
      throw new Error(`run ${run} has more than ${ALARM_CHANGES} changes of alarms: no review is made of a part`);
    after = next;
  }
}

/** The report with all commands and notes: the server gives the first page of each with it. */
async function wholeReport(run: number): Promise<AsFlownReport> {
  const report = await ask<AsFlownReport>('report', `/runs/${run}/report`);
  for (let after = report.commandsNextAfter; after !== 0n; ) {
    const page = await ask<CommandList>('commands', `/runs/${run}/commands?after=${after}`);
    report.commands.push(...page.commands);
    after = page.nextAfter;
  }
  for (let after = report.notesNextAfter; after !== 0n; ) {
    const page = await ask<NoteList>('notes', `/runs/${run}/notes?after=${after}`);
    report.notes.push(...page.notes);
    after = page.nextAfter;
  }
  return report;
}

async function landedOf(run: RunStore): Promise<Landed | undefined> {
  const event = run.events.find((row) => row.fact.name === LAYOUT.landing.event)?.fact;
  if (!event) return undefined;
  const landed: Landed = { e_s: event.sclk - run.entrySclk, words: event.text, miss_m: undefined };
  const { latitude_deg, longitude_deg, radius_m } = LAYOUT.landing.target;
  const [latitude, longitude, radius] = [latitude_deg, longitude_deg, radius_m].map(
    (name) => run.run.solution.find((each) => each.name === name)?.value,
  );
  if (latitude === undefined || longitude === undefined || radius === undefined) return landed;
  const names = LAYOUT.landing.position.filter((name) => dictionary.value?.pick([name]));
  if (names.length < LAYOUT.landing.position.length) return landed;
  const { channels } = await read<{ channels: { value: number[] }[] }>(
    `/runs/${run.id}/channels?names=${names.join(',')}&from=${event.sclk - 1}&to=${event.sclk}`,
  );
  const position = channels.map((channel) => channel.value.at(-1)).filter((value) => value !== undefined);
  return position.length < names.length ? landed : { ...landed, miss_m: miss_m(position, latitude, longitude, radius) };
}

async function judge(run: RunStore): Promise<void> {
  const words = dictionary.value;
  const through = run.completeThrough;
  try {
    const [report, alarms, landed, interventions] = await Promise.all([
      wholeReport(run.id),
      alarmChanges(run.id),
      landedOf(run),
      askInterventions(run),
    ]);
    if (store.value !== run) return;
    judged.value = {
      run: run.id,
      through,
      score: score({
        outcome: outcomeWords(run.run.outcome, run.run.state),
        landed,
        report,
        alarms,
        interventions,
        e_sOf: (ert_s) => run.sclkSeenAt(ert_s) - run.entrySclk,
        channelName: (id) => words?.channel(id)?.name ?? `channel ${id}`,
        isHazardous: (name) => {
          const command = words?.command(name);
          return command !== undefined && isHazardous(command);
        },
      }),
    };
    problem.value = '';
  } catch (error) {
    if (store.value === run) problem.value = wordsFor(error);
  }
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

function Judged({ run, of }: { run: RunStore; of: Score }) {
  const done = ofRun(run);
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
              <td class="wraps">{term.why}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="status-dim">{RULE}</p>
      <p>
        <Copy text={scoreText(title, of, done)} />
      </p>
    </>
  );
}

function Opened({ run }: { run: RunStore }) {
  void tick.value; // a store changes without a new object
  const whole = run.completeThrough >= Number(run.run.lastSeq); // until then the page's own data of the run have holes
  useEffect(() => {
    copied.value = undefined;
    problem.value = '';
    if (!whole) return;
    if (judged.value?.run !== run.id || judged.value.through !== run.completeThrough) void judge(run);
  }, [run.id, run.completeThrough, whole]);
  const of = whole && judged.value?.run === run.id ? judged.value.score : undefined;
  if (!of)
    return (
      <p role="status">
        {problem.value
          ? `✖ ${problem.value}`
          : whole
            ? 'asking the archive…'
            : 'the run is still coming from the archive…'}
      </p>
    );
  return (
    <>
      {pastRange.value && (
        <p class="not-past">▲ The review is of the whole run, not of the past that the other panels show.</p>
      )}
      <Judged run={run} of={of} />
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
