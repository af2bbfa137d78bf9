// SPDX-License-Identifier: Apache-2.0
// The panel of rehearsals: the runs, and the start of new ones.
import { signal } from '@preact/signals';
import { mayInstruct, mayRehearse, whyNotRehearse } from '../access/model';
import { outcomeWords } from '../clocks/model';
import { openedLater } from '../design/opened_later';
import { STATUS } from '../design/status';
import { canContinue, isReal } from '../mode/model';
import { wordsFor } from '../run/api';
import { startRehearsal, watch } from '../run/session';
import { pastRange, runNow, runs, scenarios, store } from '../run/shown';
import { isGoing } from '../run/start';
import { fromEntry } from '../run/time';
import { EndRun } from './end_run';
import { JumpForm } from './jump';
import { InstructorPanel } from './instructor_panel';
import { forgetPlan, planOrder, whyNotPlan } from './plan_choice';
import { PlanChoice } from './plan_choice_view';
import './style.css';

const Review = openedLater(async () => (await import('./review')).Review);

const scenario = signal('nominal');
const seed = signal('1');
/** The order for which an answer is awaited. */
const starting = signal<Parameters<typeof startRehearsal>[0] | undefined>(undefined);
const left = signal('');
const refused = signal('');

/** Starts a run, or says beside the list of runs why the server does not. */
export async function begin(order: Parameters<typeof startRehearsal>[0]): Promise<void> {
  if (starting.value) return;
  starting.value = order;
  refused.value = left.value = '';
  try {
    await startRehearsal(order, () => starting.value === order);
  } catch (error) {
    refused.value = wordsFor(error);
  } finally {
    if (starting.value === order) starting.value = undefined;
    left.value = '';
  }
}

/** The cut-off run that is being continued. */
const continued = () => (starting.value && 'continue_run' in starting.value ? starting.value.continue_run : undefined);

/** The progress of continuing a cut-off run, which is flown again first. Only the server knows how far it is. */
function CatchingUp() {
  const run = continued();
  if (run === undefined) return left.value ? <p role="status">{left.value}</p> : null;
  const items = runs.value.find((each) => Number(each.run) === run)?.lastSeq;
  return (
    <p role="status" data-testid="catching-up">
      <progress aria-label={`run ${run} is flown again`} /> run {run} is flown again
      {items !== undefined && ` through its ${String(items)} items`}, each held against the archive; then it goes on{' '}
      <button
        type="button"
        onClick={() => {
          starting.value = undefined;
          left.value = `Run ${run} catches up by itself, and stands in the list as running once it goes on.`;
        }}
      >
        leave it alone
      </button>
    </p>
  );
}

/** Why no run can be begun now; empty: one can. */
export function whyNotBegin(): string {
  const going = runs.value.find(isGoing);
  if (!mayRehearse()) return whyNotRehearse('starting and ending');
  if (pastRange.value) return 'from a past view nothing is started or ended; Esc leaves it';
  if (starting.value) return 'a run begins';
  return going ? `run ${going.run} goes on; end it first` : '';
}

export const beginProblem = () => refused.value;

async function start(plan: ReturnType<typeof planOrder>): Promise<void> {
  await begin({ scenario: scenario.value, seed: seed.value, pace: 1, ...plan });
  if (refused.value === '') forgetPlan();
}

export function Rehearsal() {
  const run = runNow();
  const allowed = mayRehearse();
  const going = runs.value.find(isGoing);
  const names = scenarios.value.length > 0 ? scenarios.value : [{ name: 'nominal', title: '' }];
  const badSeed = !/^\d{1,15}$/.test(seed.value);
  const past = pastRange.value; // a past view sends nothing and shows nothing of the present
  const plans = allowed && mayInstruct() && !going && !past;
  const badPlan = plans ? whyNotPlan() : '';
  const blocked = whyNotBegin() !== '';
  const unready = blocked || badSeed || badPlan !== '';
  return (
    <div class="table-box" data-testid="rehearsal">
      <form
        class="table-tools start"
        onSubmit={(event) => {
          event.preventDefault();
          if (!unready) void start(plans ? planOrder() : {});
        }}
      >
        <label>
          scenario{' '}
          <select
            value={scenario.value}
            data-testid="scenario"
            disabled={!allowed}
            onChange={(event) => (scenario.value = event.currentTarget.value)}
          >
            {names.map((each) => (
              <option key={each.name} value={each.name} title={each.title}>
                {each.name}
              </option>
            ))}
          </select>
        </label>
        <label>
          seed{' '}
          <input
            class="seed"
            value={seed.value}
            inputMode="numeric"
            disabled={!allowed}
            aria-invalid={badSeed}
            onInput={(event) => (seed.value = event.currentTarget.value)}
          />
        </label>
        {plans && <PlanChoice scenario={scenario.value} />}
        <button type="submit" disabled={unready} data-testid="start-rehearsal">
          start a rehearsal
        </button>
        {going && allowed && !past && !isReal(going) && (
          <EndRun run={Number(going.run)} name="stop-rehearsal" words={`end run ${going.run}`} />
        )}
        <span class="start-words">
          {!allowed
            ? `${STATUS.missing.shape} ${whyNotRehearse('starting and ending')}`
            : past
              ? `${STATUS.missing.shape} from a past view nothing is started or ended; Esc leaves it`
              : badSeed
                ? '✖ a seed is a whole number'
                : badPlan
                  ? `✖ ${badPlan}`
                  : starting.value
                    ? '… starting'
                    : going
                      ? isReal(going)
                        ? 'a real landing is followed; none is rehearsed beside it'
                        : 'one is going on; end it to start another'
                      : names.find((each) => each.name === scenario.value)?.title}
        </span>
      </form>
      {going && allowed && !past && !isReal(going) && <JumpForm />}
      <CatchingUp />
      {refused.value && (
        <p role="alert" class="status-alarm refused" data-testid="rehearsal-problem">
          ✖ {refused.value}
        </p>
      )}
      {going && run?.going && !isReal(run.run) && !past && <InstructorPanel />}
      {past && <p class="not-past">▲ The list is of now; of the run that is shown it says nothing that came later.</p>}
      <div class="table-scroll" tabIndex={0} role="group" aria-label="runs">
        {store.value?.run.state === 'finished' && !isReal(store.value.run) && <Review />}
        <table data-testid="run-list">
          <thead>
            <tr>
              <th>run</th>
              <th>scenario</th>
              <th class="number">seed</th>
              <th>state</th>
              <th>outcome</th>
              <th>started</th>
              <th class="number">items</th>
              <th>show</th>
            </tr>
          </thead>
          <tbody>
            {runs.value.map((each) => {
              const shown = run?.id === Number(each.run);
              const state = shown && past ? 'past' : shown && run ? run.run.state : each.state;
              const now = shown && run ? run.run : each;
              return (
                <tr key={String(each.run)} class={shown ? 'shown' : ''} data-run={String(each.run)} data-state={state}>
                  <td class="number">{String(each.run)}</td>
                  <td>
                    {each.scenario}
                    {each.forkedFrom && (
                      <span class="status-dim">
                        {' '}
                        fork of {String(each.forkedFrom.run)} at {fromEntry(each.forkedFrom.eS, { tenths: true })}
                      </span>
                    )}
                  </td>
                  <td class="number">{String(each.seed)}</td>
                  <td>
                    {state === 'past' ? '◧ ' : state === 'interrupted' ? '▲ ' : ''}
                    {state}
                  </td>
                  <td>{state === 'past' ? '—' : outcomeWords(now.outcome, state)}</td>
                  <td>{each.started}</td>
                  <td class="number">{state === 'past' ? '—' : String(now.lastSeq)}</td>
                  <td>
                    {shown ? (
                      '◀ shown '
                    ) : (
                      <button type="button" onClick={() => watch(isGoing(each) ? 0 : Number(each.run))}>
                        show
                      </button>
                    )}
                    {state === 'finished' && !isReal(each) && (
                      <a href={`?panel=debrief&run=${String(each.run)}`} target="_blank" rel="noopener">
                        debrief
                      </a>
                    )}
                    {state === 'interrupted' && canContinue(each) && (
                      <button
                        type="button"
                        disabled={blocked}
                        data-testid={`continue-${String(each.run)}`}
                        title="flown again up to its last item, then it goes on"
                        onClick={() => void begin({ continue_run: Number(each.run), pace: 1 })}
                      >
                        {continued() === Number(each.run) ? 'catching up…' : 'continue'}
                      </button>
                    )}
                  </td>
                </tr>
              );
            })}
          </tbody>
        </table>
        {runs.value.length === 0 && <p class="none">no run in the archive yet</p>}
      </div>
    </div>
  );
}
