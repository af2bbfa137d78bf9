// SPDX-License-Identifier: Apache-2.0
// Campaigns: start one, watch its landing ellipse fill, cancel it, continue it; and the results of earlier ones.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { mayRehearse, whyNotRehearse } from '../access/model';
import { STATUS } from '../design/status';
import { Canvas } from '../draw/canvas';
import { scenarios } from '../run/shown';
import {
  busy,
  campaigns,
  cancel,
  caseWords,
  choose,
  chosen,
  ellipseWords,
  flyingNow,
  limits,
  look,
  message,
  openedCase,
  orderProblem,
  report,
  spreadRows,
  start,
  stateWords,
  touchdowns,
} from './model';
import type { CampaignReport, CampaignState, Failure } from './model';
import { caseAt, drawTouchdowns } from './picture';
import './style.css';

const LOOK_EVERY_MS = 1000;
const LOOKS_IDLE = 5; // chosen: with none flying, every fifth look only, in case another user has started one

const scenario = signal('campaign');
const cases = signal('200');
const seed = signal('1');

function Order() {
  const flying = flyingNow();
  const allowed = mayRehearse();
  const problem = orderProblem(cases.value, seed.value, limits.value.cases_max);
  const names = scenarios.value.length > 0 ? scenarios.value.map((each) => each.name) : ['campaign'];
  const known = campaigns.value.find((each) => each.campaign === `${scenario.value}-${seed.value}`);
  const goesOn = known !== undefined && known.kept > 0;
  const hint = !allowed
    ? `${STATUS.missing.shape} ${whyNotRehearse('starting and cancelling')}`
    : problem
      ? `✖ ${problem}`
      : goesOn && !flying
        ? `${known.kept} cases of it are kept`
        : '';
  return (
    <form
      class="table-tools campaign-form"
      onSubmit={(event) => {
        event.preventDefault();
        if (!problem && !flying && allowed && !busy.value) void start(scenario.value, Number(cases.value), seed.value);
      }}
    >
      <label>
        scenario{' '}
        <select
          value={scenario.value}
          data-testid="campaign-scenario"
          onChange={(event) => (scenario.value = event.currentTarget.value)}
        >
          {names.map((name) => (
            <option key={name} value={name}>
              {name}
            </option>
          ))}
        </select>
      </label>
      <label>
        cases{' '}
        <input
          class="count"
          value={cases.value}
          inputMode="numeric"
          aria-invalid={problem?.startsWith('cases') === true}
          data-testid="campaign-cases"
          onInput={(event) => (cases.value = event.currentTarget.value)}
        />
      </label>
      <label>
        seed{' '}
        <input
          class="count"
          value={seed.value}
          inputMode="numeric"
          aria-invalid={problem !== undefined && !problem.startsWith('cases')}
          data-testid="campaign-seed"
          onInput={(event) => (seed.value = event.currentTarget.value)}
        />
      </label>
      <button
        type="submit"
        disabled={problem !== undefined || flying !== undefined || !allowed || busy.value}
        data-testid="campaign-start"
      >
        {goesOn ? 'go on' : 'start'}
      </button>
      {flying && (
        <button
          type="button"
          disabled={!allowed || busy.value || flying.state === 'cancelling'}
          data-testid="campaign-cancel"
          onClick={() => void cancel(flying.campaign)}
        >
          {flying.state === 'cancelling' ? 'cancelling' : 'cancel'} {flying.campaign}
        </button>
      )}
      {hint !== '' && <span class="campaign-hint">{hint}</span>}
    </form>
  );
}

function Standing({ state }: { state: CampaignState }) {
  return (
    <p class="campaign-state">
      <b>{state.campaign}</b>
      <progress
        max={Math.max(1, state.cases)}
        value={state.kept}
        aria-label={`cases of ${state.campaign} that are kept`}
      />
      <output data-testid="campaign-state" data-state={state.state} class={state.fault !== '' ? 'status-alarm' : ''}>
        {stateWords(state)}
      </output>
    </p>
  );
}

/** The case of the dot that was clicked, or of the number that is typed. */
function OpenedCase({ state }: { state: CampaignState }) {
  const point = touchdowns.value.find((each) => each.case === openedCase.value);
  const told = point && caseWords(point, state);
  return (
    <div class="campaign-case">
      <label>
        case{' '}
        <input
          class="count"
          inputMode="numeric"
          data-testid="campaign-case"
          placeholder="click a dot"
          value={openedCase.value ?? ''}
          onInput={(event) => (openedCase.value = Number(event.currentTarget.value) || undefined)}
        />
      </label>
      <span role="status" data-testid="campaign-case-told">
        {told ? (
          <>
            {told.words} To fly it alone: <code tabIndex={0}>{told.command}</code>
          </>
        ) : (
          openedCase.value !== undefined && `No case ${openedCase.value} is kept.`
        )}
      </span>
    </div>
  );
}

function Picture({ of }: { of: CampaignReport }) {
  const landed = touchdowns.value.filter((each) => each.outcome === 'touchdown').length;
  const nowhere = touchdowns.value.filter((each) => each.east_m === undefined).length;
  return (
    <figure class="campaign-picture">
      <div>
        <Canvas
          draw={drawTouchdowns}
          testId="campaign-picture"
          onPoint={(x, y) => (openedCase.value = caseAt(x, y))}
          keyOf={() => `${openedCase.value} ${chosen.value} ${touchdowns.value.length} ${report.value?.state.kept}`}
          label={`${landed} touchdowns about the target${of.ellipse ? `; the 99 % ellipse is ${ellipseWords(of.ellipse)}` : ''}`}
        />
      </div>
      <figcaption>
        <span class="rehearsed">●</span> touchdown ({landed}){' '}
        {of.failed > 0 && (
          <span class="status-alarm">
            ✖ no landing ({of.failed}
            {nowhere > 0 && `, ${nowhere} of them without a place`}){' '}
          </span>
        )}
        ◯ 99 % ellipse <OpenedCase state={of.state} />
      </figcaption>
    </figure>
  );
}

function Numbers({ of }: { of: CampaignReport }) {
  const least = of.least_margin;
  return (
    <>
      <p class="campaign-matter" data-testid="campaign-ellipse">
        99 % ellipse: {of.ellipse ? ellipseWords(of.ellipse) : 'two touchdowns make one'}.
      </p>
      <table data-testid="campaign-outcomes">
        <thead>
          <tr>
            <th>outcome</th>
            <th class="number">cases</th>
            <th class="number">share</th>
          </tr>
        </thead>
        <tbody>
          {of.outcomes.map(({ outcome, count }) => (
            <tr key={outcome}>
              <td class={outcome === 'touchdown' ? 'status-good' : 'status-alarm'}>
                {outcome === 'touchdown' ? '✓' : '✖'} {outcome.replace('_', ' ')}
              </td>
              <td class="number">{count}</td>
              <td class="number">{((100 * count) / Math.max(1, of.state.kept)).toFixed(2)} %</td>
            </tr>
          ))}
        </tbody>
      </table>
      <table data-testid="campaign-spreads">
        <thead>
          <tr>
            <th>over the cases</th>
            <th>unit</th>
            <th class="number">least</th>
            <th class="number">1 %</th>
            <th class="number">50 %</th>
            <th class="number">99 %</th>
            <th class="number">largest</th>
            <th class="number">mean</th>
            <th class="number">σ</th>
            <th class="number">cases</th>
          </tr>
        </thead>
        <tbody>
          {spreadRows(of).map((row) => (
            <tr key={row.name}>
              <td>{row.name}</td>
              <td>{row.unit}</td>
              {row.numbers.map((number, i) => (
                <td key={i} class="number">
                  {number}
                </td>
              ))}
              <td class="number">{row.count}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {least && (
        <p data-testid="campaign-margin">
          Least timeline margin {least.margin_s.toFixed(3)} s, of {least.timepoint} in case {least.case}: so much later
          than its minimum offset it was triggered; 0 is one that the timeline held up.
        </p>
      )}
      {of.recontacts > 0 && (
        <p class="status-alarm">✖ cases in which the vehicle was struck by what it had let go: {of.recontacts}</p>
      )}
      <Cases testId="campaign-failures" cases={of.failures} count={of.failed} told={(each) => each.outcome} />
      <Cases
        testId="campaign-outside"
        cases={of.outside}
        count={of.outside_limits}
        told={() => 'landed outside limits'}
      />
    </>
  );
}

function Cases(of: { testId: string; cases: Failure[]; count: number; told: (each: Failure) => string }) {
  if (of.cases.length === 0) return null;
  return (
    <>
      <table data-testid={of.testId}>
        <thead>
          <tr>
            <th class="number">case</th>
            <th>outcome</th>
            <th>reason</th>
          </tr>
        </thead>
        <tbody>
          {of.cases.map((each) => (
            <tr key={each.case}>
              <td class="number">{each.case}</td>
              <td class="status-alarm">✖ {of.told(each).replace('_', ' ')}</td>
              <td class="campaign-reason">{each.reason}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {of.count > of.cases.length && <p>and {of.count - of.cases.length} more</p>}
    </>
  );
}

function Former() {
  return (
    <table data-testid="campaign-list">
      <thead>
        <tr>
          <th>campaign</th>
          <th class="number">kept</th>
          <th class="number">asked for</th>
          <th>state</th>
          <th>show</th>
        </tr>
      </thead>
      <tbody>
        {campaigns.value.map((each) => (
          <tr key={each.campaign} data-campaign={each.campaign} class={each.campaign === chosen.value ? 'shown' : ''}>
            <td>{each.campaign}</td>
            <td class="number">{each.state === 'unreadable' ? '' : each.kept}</td>
            <td class="number">{each.state === 'unreadable' ? '' : each.cases}</td>
            <td title={each.fault}>
              {each.fault !== '' ? '✖ ' : ''}
              {each.state}
            </td>
            <td>
              {each.campaign === chosen.value ? (
                '◀ shown'
              ) : each.state === 'unreadable' ? (
                ''
              ) : (
                <button
                  type="button"
                  aria-label={`show ${each.campaign}`}
                  onClick={() => {
                    choose(each.campaign);
                    void look();
                  }}
                >
                  show
                </button>
              )}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

export function Campaigns() {
  useEffect(() => {
    let looks = 0;
    const timer = setInterval(() => {
      if (!document.hidden && (flyingNow() || ++looks % LOOKS_IDLE === 0)) void look();
    }, LOOK_EVERY_MS);
    void look();
    return () => clearInterval(timer);
  }, []);
  const state = campaigns.value.find((each) => each.campaign === chosen.value);
  const of = report.value;
  return (
    <div class="table-box campaigns" data-testid="campaigns">
      <Order />
      {message.value && (
        <p class={`message ${message.value.good ? 'good' : 'bad'}`} role="status" data-testid="campaign-message">
          {message.value.good ? '✓' : '✖'} {message.value.text}
        </p>
      )}
      {state && <Standing state={state} />}
      <div class="campaign-body">
        {of && <Picture of={of} />}
        <div class="table-scroll" tabIndex={0} role="region" aria-label="what the cases come to">
          <p class="campaign-nature">
            ◪ Statistics of rehearsals, each flown from its own errors. Nothing here is of the vehicle.
          </p>
          {of && of.state.kept > 0 && <Numbers of={of} />}
          {campaigns.value.length > 0 ? (
            <Former />
          ) : (
            <p class="none">
              No campaign lies beside this archive yet. A campaign flies the same landing many times, each with errors
              drawn anew, in threads that give way to everything else.
            </p>
          )}
        </div>
      </div>
    </div>
  );
}
