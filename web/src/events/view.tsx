import { signal } from '@preact/signals';
import { Panel } from '../design/panel';
import { pastRange, runNow } from '../run/session';
import { fromEntry } from '../run/time';
import { LEVELS, eventLines, levelShape, levelWords, sourceWords } from './model';
import './style.css';

const from = signal<(typeof LEVELS)[number]>('ACTIVITY_LO');
const search = signal('');
const SHOWN = 250;

export function Events() {
  const run = runNow();
  const { lines, warnings } = run
    ? eventLines(run, { from: from.value, search: search.value, range: pastRange.value }, SHOWN)
    : { lines: [], warnings: 0 };
  return (
    <Panel name="events" title="Events" extra={
      <>
        {warnings > 0 && <b class="warnings">▲ {warnings} {warnings === 1 ? 'warning' : 'warnings'}</b>}
        <input type="search" placeholder="search" aria-label="search events" value={search.value} data-testid="event-search"
          onInput={(event) => (search.value = event.currentTarget.value)} />
        <select aria-label="least level shown" value={from.value}
          onChange={(event) => (from.value = event.currentTarget.value as (typeof LEVELS)[number])}>
          {LEVELS.map((level) => <option key={level} value={level}>{levelWords(level)} and above</option>)}
        </select>
      </>
    }>
      <ol class="events table-scroll" tabIndex={0} aria-label="events, newest first" data-testid="event-list">
        {lines.map((line) => {
          const source = sourceWords(line);
          return (
            <li key={line.key} class={`event level-${line.level}`} data-event={line.name}>
              <time>{fromEntry(line.e_s, { tenths: true })}</time>
              <span class="shape" title={line.explanation ? 'explanation' : levelWords(line.level)}>{line.explanation ? '?' : levelShape(line.level)}</span>
              <div>
                {line.explanation && <small>why: </small>}{line.text}
                {line.why.map((why) => <small key={why} class="why">why: {why}</small>)}
              </div>
              <span class="source" title={source.words}>{source.shape}</span>
            </li>
          );
        })}
        {lines.length === 0 && <li class="none">no event yet{search.value ? ` with “${search.value}”` : ''}</li>}
      </ol>
    </Panel>
  );
}
