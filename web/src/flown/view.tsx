// SPDX-License-Identifier: Apache-2.0
// A run as flown: the time of each timepoint by plan, prediction, tone, live telemetry and recording, the events between them, and
// the silences.
import { signal } from '@preact/signals';
import type { AsFlownReport } from '../gen/aeolis/v1/run_pb';
import { linkTitle } from '../links/model';
import { reportOfRun } from '../run/report';
import { pastRange, runNow } from '../run/shown';
import { FLOWN_ORDER, flownEvent, flownRow, inOrder, silenceWords, summaryOf } from './model';
import type { FlownColumn } from './model';
import './style.css';

const order = signal<{ column: FlownColumn; down: boolean } | undefined>(undefined);
const TIPS: Partial<Record<FlownColumn, string>> = {
  predicted: 'at entry interface, by the anchors that ground had then',
  'Δ plan, s': 'flown less planned, by the best source',
  'Δ prediction, s': 'flown less predicted, by the best source',
  margin: 'beyond the minimum offset from the previous one',
};

/** A head that puts the rows in order: up, down, and back to the order of the timeline. */
function Head({ column }: { column: FlownColumn }) {
  const down = order.value?.column === column ? order.value.down : undefined;
  const next = () =>
    (order.value = down === undefined ? { column, down: column.startsWith('Δ') } : turned(column, down));
  return (
    <th
      class={column === 'timepoint' || column === 'verdict' ? '' : 'number'}
      aria-sort={down === undefined ? 'none' : down ? 'descending' : 'ascending'}
    >
      <button type="button" class="order" title={TIPS[column]} onClick={next}>
        {column} {down === undefined ? '' : down ? '▼' : '▲'}
      </button>
    </th>
  );
}

const turned = (column: FlownColumn, down: boolean) =>
  down === column.startsWith('Δ') ? { column, down: !down } : undefined;

const AGAIN_MS = 5000; // chosen: during a run, since the report is work for the archive
const flown = reportOfRun<AsFlownReport>('report', 'report', AGAIN_MS);

export function Flown() {
  const run = runNow();
  const of = flown.use();
  if (!run) return null;
  return (
    <div class="table-box" data-testid="flown">
      {pastRange.value && <p class="not-past">▲ The report is of the whole run, with all that is known of it now.</p>}
      <div class="table-tools">
        <span data-testid="flown-summary">
          {of ? summaryOf(of) : flown.problem.value ? `✖ ${flown.problem.value}` : 'asking the archive…'}
        </span>
        <a href={`api/v1/runs/${run.id}/report`} download={`as-flown-${run.id}.json`}>
          take the report as JSON
        </a>
        <a href={`api/v1/runs/${run.id}/report?format=csv`} download={`as-flown-${run.id}.csv`}>
          its timepoints and events as CSV
        </a>
      </div>
      <div class="table-scroll" tabIndex={0} role="region" aria-label="timepoints and events as flown">
        {of && (
          <table data-testid="flown-table">
            <thead>
              <tr>
                {(Object.keys(FLOWN_ORDER) as FlownColumn[]).map((column) => (
                  <Head key={column} column={column} />
                ))}
              </tr>
            </thead>
            <tbody>
              {inOrder(of.timepoints, order.value)
                .map(flownRow)
                .map((row) => (
                  <tr key={row.name} data-flown={row.name} data-menu={`timepoint ${row.name}`}>
                    <td>{row.name}</td>
                    <td class="number">{row.planned}</td>
                    <td class="number">{row.predicted}</td>
                    <td class="number">{row.tone}</td>
                    <td class="number">{row.uhf}</td>
                    <td class="number">{row.recorded}</td>
                    <td class="number">{row.againstPlan}</td>
                    <td class="number">{row.againstPrediction}</td>
                    <td class="number">{row.margin}</td>
                    <td>{row.verdict}</td>
                  </tr>
                ))}
            </tbody>
          </table>
        )}
        {of && of.events.length > 0 && (
          <section aria-label="events as flown">
            <h3>Events</h3>
            <table data-testid="flown-events">
              <thead>
                <tr>
                  <th>event</th>
                  <th class="number" title="by the anchor of that name, when the run began">
                    predicted
                  </th>
                  <th class="number">by telemetry</th>
                  <th class="number">recorded</th>
                  <th>as flight reported it</th>
                </tr>
              </thead>
              <tbody>
                {of.events.map(flownEvent).map((row) => (
                  <tr key={row.name} data-flown-event={row.name} data-menu={`timepoint ${row.name}`}>
                    <td>{row.name}</td>
                    <td class="number">{row.predicted}</td>
                    <td class="number">{row.uhf}</td>
                    <td class="number">{row.recorded}</td>
                    <td>{row.text}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </section>
        )}
        {of && of.silences.length > 0 && (
          <section aria-label="silences">
            <h3>Silences</h3>
            <ul>
              {of.silences.map((silence) => (
                <li key={`${silence.link}${silence.fromES}`}>
                  {linkTitle(silence.link)}, {silenceWords(silence, run.entryKnown)}
                </li>
              ))}
            </ul>
          </section>
        )}
      </div>
    </div>
  );
}
