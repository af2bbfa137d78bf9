// A run as it was flown: when each timepoint came by plan, prediction, tone, UHF and recording, what flight reported between them, and what was
// silent meanwhile.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { AsFlownReport } from '../gen/aeolis/v1/run_pb';
import { linkTitle } from '../links/model';
import { ask, pastRange, runNow, store } from '../run/session';
import { flownEvent, flownRow, silenceWords, summaryOf } from './model';

const AGAIN_MS = 5000; // ours: while a run goes on; counting it is work for the archive
const report = signal<{ run: number; of: AsFlownReport } | undefined>(undefined);
const problem = signal<string | undefined>(undefined);

async function refresh(): Promise<void> {
  const run = store.value;
  if (!run) return;
  try {
    const of = await ask<AsFlownReport>('report', `/runs/${run.id}/report`);
    if (store.value === run) report.value = { run: run.id, of };
    problem.value = undefined;
  } catch (error) {
    problem.value = error instanceof Error ? error.message : String(error);
  }
}

export function Flown() {
  const run = runNow();
  const id = run?.id;
  useEffect(() => {
    let told = -1;
    const look = () => {
      const through = store.value?.completeThrough ?? -1;
      if (through === told) return;
      told = through;
      void refresh();
    };
    look();
    const timer = setInterval(look, AGAIN_MS);
    return () => clearInterval(timer);
  }, [id]);
  if (!run) return null;
  const of = report.value?.run === run.id ? report.value.of : undefined;
  return (
    <div class="table-box" data-testid="flown">
      {pastRange.value && <p class="not-past">▲ The report is of the whole run, with all that is known of it now.</p>}
      <div class="table-tools">
        <span data-testid="flown-summary">{of ? summaryOf(of) : problem.value ? `✖ ${problem.value}` : 'asking the archive…'}</span>
        <a href={`api/v1/runs/${run.id}/report`} download={`as-flown-${run.id}.json`}>take the report as JSON</a>
        <a href={`api/v1/runs/${run.id}/report?format=csv`} download={`as-flown-${run.id}.csv`}>its timepoints and events as CSV</a>
      </div>
      <div class="table-scroll" tabIndex={0} role="region" aria-label="timepoints and events as flown">
        {of && (
          <table data-testid="flown-table">
            <thead><tr><th>timepoint</th><th class="number">planned</th><th class="number" title="at entry interface, by the timeline’s rule over the anchors that ground had then">predicted</th><th class="number">by tone</th><th class="number">by UHF</th><th class="number">recorded</th>
              <th class="number" title="later than the previous timepoint and the minimum offset from it">margin</th><th>verdict</th></tr></thead>
            <tbody>
              {of.timepoints.map(flownRow).map((row) => (
                <tr key={row.name} data-flown={row.name}>
                  <td>{row.name}</td><td class="number">{row.planned}</td><td class="number">{row.predicted}</td><td class="number">{row.tone}</td><td class="number">{row.uhf}</td><td class="number">{row.recorded}</td>
                  <td class="number">{row.margin}</td><td>{row.verdict}</td>
                </tr>
              ))}
            </tbody>
          </table>
        )}
        {of && of.events.length > 0 && (
          <section aria-label="events as flown">
            <h3>Events</h3>
            <table data-testid="flown-events">
              <thead><tr><th>event</th><th class="number" title="by the anchor of that name, as the design had it when the run began">predicted</th><th class="number">by UHF</th><th class="number">recorded</th><th>as flight reported it</th></tr></thead>
              <tbody>
                {of.events.map(flownEvent).map((row) => (
                  <tr key={row.name} data-flown-event={row.name}>
                    <td>{row.name}</td><td class="number">{row.predicted}</td><td class="number">{row.uhf}</td><td class="number">{row.recorded}</td><td>{row.text}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </section>
        )}
        {of && of.silences.length > 0 && (
          <section aria-label="silences">
            <h3>Silences</h3>
            <ul>{of.silences.map((silence) => <li key={`${silence.link}${silence.fromES}`}>{linkTitle(silence.link)}, {silenceWords(silence)}</li>)}</ul>
          </section>
        )}
      </div>
    </div>
  );
}
