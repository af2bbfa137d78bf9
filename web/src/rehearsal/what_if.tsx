// SPDX-License-Identifier: Apache-2.0
// Forks and forecasts of the run that is shown: another run that is this one up to some instant, what differs between
// the two, and what would come of it, flown many times: from what ground heard, or, for an instructor, the truth.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { mayAct, mayInstruct, mayRehearse } from '../access/model';
import { outcomeWords } from '../clocks/model';
import { wordsFor } from '../run/api';
import { isReal } from '../mode/model';
import { change, read } from '../run/connection';
import { laidOver, pastRange, runs, store, tick } from '../run/shown';
import { isGoing } from '../run/start';
import type { RunStore } from '../run/store';
import { fromEntry, readFromEntry } from '../run/time';
import { FaultFields, badNumbers, faultWords, pickedFault } from './faults';
import {
  BASES,
  FIGURES,
  assumed,
  basisWords,
  eventName,
  laterBy,
  partText,
  stateText,
  timeIn,
  valuesText,
} from './what_if_model';
import { asksElsewhere } from './fly_out';
import { begin, beginProblem, whyNotBegin } from './view';
import type { Basis, Differences, Forecast } from './what_if_model';

const AGAIN_MS = 1000; // chosen: interval of requests for the progress of a forecast
const CHANNELS_SHOWN = 20; // chosen: those that differ first; the rest is counted

const at = signal('');
const seed = signal('');
const waits = signal(true);
const cases = signal('32');
const basis = signal<Basis>('truth'); // of who may choose
const command = signal('');
const breaks = signal(false);
const problem = signal('');
const busy = signal(false);

const differences = signal<{ run: number; of: Differences | string } | undefined>(undefined);
const forecasts = signal<{ run: number; all: Forecast[] } | undefined>(undefined);
const opened = signal<Forecast | undefined>(undefined); // with its result

async function refreshForecasts(run: RunStore): Promise<void> {
  try {
    const list = await read<{ forecasts?: Forecast[] }>(`/runs/${run.id}/forecasts?limit=100`);
    // the newest first: numbers alone order those of one kind
    const all = (list.forecasts ?? []).sort((one, other) => other.asked.localeCompare(one.asked));
    forecasts.value = { run: run.id, all };
  } catch {
    // the known list stays; the next round asks again
  }
}

async function doing(work: () => Promise<void>): Promise<void> {
  if (busy.value) return;
  busy.value = true;
  problem.value = '';
  try {
    await work();
  } catch (error) {
    problem.value = wordsFor(error);
  } finally {
    busy.value = false;
  }
}

const askForecast = (run: RunStore): Promise<void> =>
  doing(async () => {
    const typed = command.value.trim();
    await change(`/runs/${run.id}/forecasts`, {
      ...(at.value && { at: at.value }),
      cases: Number(cases.value),
      from: mayInstruct() ? basis.value : 'telemetry',
      ...(typed && { commands: [{ command: typed, from_solution: true }] }),
      ...(breaks.value && { faults: [pickedFault()] }),
    });
    await refreshForecasts(run);
  });

const show = (forecast: Forecast): Promise<void> =>
  doing(async () => {
    opened.value = await read<Forecast>(`/runs/${forecast.run}/forecasts/${forecast.forecast}`);
  });

const compare = (run: RunStore, other: number): Promise<void> =>
  doing(async () => {
    differences.value = undefined;
    differences.value = { run: run.id, of: await read<Differences>(`/runs/${run.id}/differences?with=${other}`) };
  });

function Instant({ run }: { run: RunStore }) {
  const past = pastRange.value?.to;
  useEffect(() => {
    if (past !== undefined) at.value = fromEntry(past).replace('−', '-');
  }, [past]);
  const bad = at.value !== '' && readFromEntry(at.value) === undefined;
  return (
    <label>
      at{' '}
      <input
        class="instant"
        value={at.value}
        placeholder={run.going ? 'now' : 'E+3:10'}
        aria-invalid={bad}
        data-testid="what-if-at"
        title="by the vehicle’s clock; from a past view its instant is taken over"
        onInput={(event) => (at.value = event.currentTarget.value)}
      />
    </label>
  );
}

function ForkForm({ run }: { run: RunStore }) {
  const whyNot = whyNotBegin();
  const blocked = whyNot !== '';
  const badSeed = !/^\d{0,15}$/.test(seed.value);
  const without = readFromEntry(at.value) === undefined;
  return (
    <form
      class="table-tools"
      data-testid="fork"
      onSubmit={(event) => {
        event.preventDefault();
        if (blocked || badSeed || without) return;
        const own = seed.value === '' ? {} : { seed: seed.value };
        void begin({ fork: { run: run.id, at: at.value, ...own, paused: waits.value }, pace: 1 });
      }}
    >
      <Instant run={run} />
      <label title="of air, wind, ground and the luck of devices from there on; empty: as in this run">
        seed{' '}
        <input
          class="seed"
          value={seed.value}
          inputMode="numeric"
          placeholder="its own"
          aria-invalid={badSeed}
          onInput={(event) => (seed.value = event.currentTarget.value)}
        />
      </label>
      <label>
        <input
          type="checkbox"
          checked={waits.value}
          onChange={(event) => (waits.value = event.currentTarget.checked)}
        />{' '}
        wait there
      </label>
      <button type="submit" disabled={blocked || badSeed || without} data-testid="fork-go">
        fork run {run.id}
      </button>
      <span>{blocked ? `▲ ${whyNot}` : 'a new run: this one again up to there, then by itself'}</span>
    </form>
  );
}

function DifferenceTable({ of, name }: { of: Differences; name: 'events' | 'timepoints' }) {
  const all = of[name] ?? [];
  if (all.length === 0) return <p>{name}: none differs</p>;
  return (
    <table data-testid={`differences-${name}`}>
      <thead>
        <tr>
          <th>{name}</th>
          <th class="number">in this run</th>
          <th class="number">in the other</th>
          <th class="number">later by</th>
        </tr>
      </thead>
      <tbody>
        {all.map((each) => (
          <tr key={`${each.name} ${each.occurrence}`} title={each.text ?? each.other_text}>
            <th scope="row">{eventName(each)}</th>
            <td class="number">{timeIn(each.e_s)}</td>
            <td class="number">{timeIn(each.other_e_s)}</td>
            <td class="number">{laterBy(each)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function DifferencesOf({ run, of }: { run: RunStore; of: Differences }) {
  const channels = of.channels ?? [];
  return (
    <div data-testid="differences">
      <p>
        {of.part_e_s !== undefined && `They part at ${fromEntry(of.part_e_s, { tenths: true })}. `}
        This run: {outcomeWords(of.run.outcome as typeof run.run.outcome, 'finished')}; the other:{' '}
        {outcomeWords(of.other.outcome as typeof run.run.outcome, 'finished')}.
      </p>
      <DifferenceTable of={of} name="timepoints" />
      <DifferenceTable of={of} name="events" />
      <p>
        channels{of.channels_until_e_s === undefined ? '' : `, up to ${fromEntry(of.channels_until_e_s)}`}:{' '}
        {channels.length} differ, {of.channels_equal ?? 0} do not
        {channels.length > CHANNELS_SHOWN && `; the ${CHANNELS_SHOWN} that differ first:`}
      </p>
      {channels.length > 0 && (
        <table data-testid="differences-channels">
          <thead>
            <tr>
              <th>channel</th>
              <th class="number">differs from</th>
              <th class="number">samples</th>
              <th class="number">most</th>
            </tr>
          </thead>
          <tbody>
            {channels.slice(0, CHANNELS_SHOWN).map((each) => (
              <tr key={each.channel}>
                <th scope="row">{each.channel}</th>
                <td class="number">{fromEntry(each.from_e_s, { tenths: true })}</td>
                <td class="number">
                  {each.differing} of {each.samples}
                </td>
                <td class="number">
                  {each.largest === undefined
                    ? '—'
                    : `${each.largest.toPrecision(3)} at ${fromEntry(each.largest_e_s ?? NaN)}`}
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </div>
  );
}

/** Another run in the plots, under what is shown. */
function InPlots({ run }: { run: RunStore }) {
  const others = runs.value.filter((each) => Number(each.run) !== run.id && !isGoing(each));
  if (others.length === 0) return null;
  return (
    <label class="table-tools">
      in the plots, dashed{' '}
      <select
        data-testid="over-plots"
        onChange={(event) => (laidOver.value = Number(event.currentTarget.value) || undefined)}
      >
        <option value="0">no other run</option>
        {others.map((each) => (
          <option key={String(each.run)} value={String(each.run)} selected={Number(each.run) === laidOver.value}>
            run {String(each.run)}, {each.scenario}
          </option>
        ))}
      </select>
    </label>
  );
}

function Compare({ run }: { run: RunStore }) {
  const parent = run.run.forkedFrom && Number(run.run.forkedFrom.run);
  const others = runs.value.filter((each) => Number(each.run) !== run.id && !isGoing(each));
  const known = differences.value?.run === run.id ? differences.value.of : undefined;
  if (run.going) return <p>once this run is over</p>;
  if (others.length === 0) return <p>there is no other run that is over</p>;
  const chosen = parent ?? Number(others[0]?.run);
  return (
    <>
      <form
        class="table-tools"
        onSubmit={(event) => {
          event.preventDefault();
          void compare(run, Number(new FormData(event.currentTarget).get('other')));
        }}
      >
        <label>
          lay over run{' '}
          <select name="other" data-testid="compare-with" key={chosen}>
            {others.map((each) => (
              <option key={String(each.run)} value={String(each.run)} selected={Number(each.run) === chosen}>
                {String(each.run)}, {each.scenario}
              </option>
            ))}
          </select>
        </label>
        <button type="submit" disabled={busy.value} data-testid="compare">
          list what differs
        </button>
      </form>
      {known && typeof known !== 'string' && <DifferencesOf run={run} of={known} />}
    </>
  );
}

function Result({ of }: { of: Forecast }) {
  const { result } = of;
  if (!result) return null;
  const sides = [result.without, ...(result.with ? [result.with] : [])];
  const outside = sides.flatMap((side, i) =>
    (side.outside_limits ?? []).slice(0, 3).map((each) => ({ ...each, side: i === 0 ? 'without' : 'with' })),
  );
  return (
    <div data-testid="forecast-result">
      <p>
        Run {of.run} at {fromEntry(of.at_e_s, { tenths: true })}, {basisWords(result)}; assumed:{' '}
        {assumed(of, faultWords)}.
      </p>
      <table>
        <thead>
          <tr>
            <th>median (least … most)</th>
            <th class="number">without</th>
            {result.with && <th class="number">with</th>}
          </tr>
        </thead>
        <tbody>
          <tr>
            <th scope="row">landed within limits (99 % confidence)</th>
            {sides.map((side, i) => (
              <td class="number" key={i}>
                {partText(side.within_limits)}
              </td>
            ))}
          </tr>
          {FIGURES.map((figure) => (
            <tr key={figure.key}>
              <th scope="row">
                {figure.words}, {figure.unit}
              </th>
              {sides.map((side, i) => (
                <td class="number" key={i}>
                  {valuesText(side[figure.key], figure)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      {outside.map((each) => (
        <p key={`${each.side} ${each.case}`}>
          {each.side}, case {each.case}: {each.outcome}: {each.reason}
        </p>
      ))}
    </div>
  );
}

function Forecasts({ run }: { run: RunStore }) {
  useEffect(() => {
    void refreshForecasts(run);
    const timer = setInterval(() => {
      const all = forecasts.value?.run === run.id ? forecasts.value.all : [];
      const known = forecasts.value?.run === run.id;
      if (!known || all.some((each) => each.state === 'flying' || each.state === 'queued')) void refreshForecasts(run);
    }, AGAIN_MS);
    return () => clearInterval(timer);
  }, [run.id, asksElsewhere.value]);
  const all = forecasts.value?.run === run.id ? forecasts.value.all : [];
  const bad =
    !/^[1-9]\d{0,2}$|^1000$/.test(cases.value) ||
    (breaks.value && badNumbers() !== '') ||
    (at.value === '' ? !run.going : readFromEntry(at.value) === undefined);
  return (
    <>
      {mayAct() && (
        <form
          class="table-tools"
          data-testid="forecast"
          onSubmit={(event) => {
            event.preventDefault();
            if (!bad) void askForecast(run);
          }}
        >
          <Instant run={run} />
          {mayInstruct() && (
            <label>
              from{' '}
              <select
                value={basis.value}
                data-testid="forecast-from"
                onChange={(event) => (basis.value = event.currentTarget.value as Basis)}
              >
                {Object.entries(BASES).map(([name, words]) => (
                  <option key={name} value={name}>
                    {name === 'telemetry' ? `${words}; everybody sees it` : words}
                  </option>
                ))}
              </select>
            </label>
          )}
          <label>
            cases{' '}
            <input
              class="seed"
              value={cases.value}
              inputMode="numeric"
              aria-invalid={!/^[1-9]\d{0,2}$|^1000$/.test(cases.value)}
              onInput={(event) => (cases.value = event.currentTarget.value)}
            />
          </label>
          <label title="its arguments are filled in from the navigation solution">
            with the command{' '}
            <input
              class="instant"
              value={command.value}
              placeholder="none"
              data-testid="forecast-command"
              onInput={(event) => (command.value = event.currentTarget.value.toUpperCase())}
            />
          </label>
          <label>
            <input
              type="checkbox"
              checked={breaks.value}
              data-testid="forecast-breaks"
              onChange={(event) => (breaks.value = event.currentTarget.checked)}
            />{' '}
            with a fault
          </label>
          {breaks.value && <FaultFields />}
          <button type="submit" disabled={bad || busy.value} data-testid="forecast-go">
            what if
          </button>
        </form>
      )}
      {all.length > 0 && (
        <table data-testid="forecasts">
          <thead>
            <tr>
              <th class="number">no.</th>
              <th class="number">at</th>
              <th>from</th>
              <th>assumed</th>
              <th>state</th>
              <th>result</th>
            </tr>
          </thead>
          <tbody>
            {all.map((each) => (
              <tr key={each.forecast} data-state={each.state}>
                <td class="number">{each.forecast}</td>
                <td class="number">{fromEntry(each.at_e_s, { tenths: true })}</td>
                <td>{BASES[each.request.from ?? 'truth']}</td>
                <td>{assumed(each, faultWords)}</td>
                <td>{stateText(each)}</td>
                <td>
                  {each.state === 'ready' && (
                    <button type="button" onClick={() => void show(each)}>
                      show
                    </button>
                  )}
                  {(each.state === 'flying' || each.state === 'queued') && mayAct() && (
                    <button
                      type="button"
                      onClick={() =>
                        void doing(async () => {
                          await change(`/runs/${each.run}/forecasts/${each.forecast}/cancel`, {});
                          await refreshForecasts(run);
                        })
                      }
                    >
                      cancel
                    </button>
                  )}
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {opened.value && Number(opened.value.run) === run.id && <Result of={opened.value} />}
    </>
  );
}

export function WhatIf() {
  void tick.value; // a store changes without a new object
  const run = store.value;
  if (!run || isReal(run.run)) return <p class="none">of a rehearsal only: none is shown</p>;
  const words = problem.value || beginProblem();
  return (
    <div class="table-box what-if" data-testid="what-if">
      <div class="table-scroll" tabIndex={0} role="group" aria-label="what if">
        {words && (
          <p role="alert" class="status-alarm" data-testid="what-if-problem">
            ✖ {words}
          </p>
        )}
        {mayRehearse() && (
          <section>
            <h3>Go on otherwise</h3>
            <ForkForm run={run} />
          </section>
        )}
        <section>
          <h3>What would come of it</h3>
          <Forecasts run={run} />
        </section>
        <section>
          <h3>Laid over another run</h3>
          <InPlots run={run} />
          <Compare run={run} />
        </section>
      </div>
    </div>
  );
}
