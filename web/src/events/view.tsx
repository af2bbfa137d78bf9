// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import { Foot } from '../design/foot';
import { Panel } from '../design/panel';
import { STATUS } from '../design/status';
import { pastRange, runNow } from '../run/shown';
import { fromEntry } from '../run/time';
import { LEVELS, eventLines, levelShape, levelWords, sourceWords } from './model';
import './style.css';

const from = signal<(typeof LEVELS)[number]>('ACTIVITY_LO');
const search = signal('');
const SHOWN = 250;
/** Levels whose rows are in the alarm's colour. */
const WORST = new Set<string>(['FATAL', 'WARNING_HI']);

/** Moves the focus from the search into the results and back. */
function onSearchKey(event: KeyboardEvent): void {
  if (event.key !== 'Enter' && event.key !== 'ArrowDown') return;
  event.preventDefault();
  document.querySelector<HTMLElement>('[data-testid="event-list"]')?.focus();
}

export function Events() {
  const run = runNow();
  const { lines, found, alarms, warnings } = run
    ? eventLines(run, { from: from.value, search: search.value, range: pastRange.value }, SHOWN)
    : { lines: [], found: 0, alarms: 0, warnings: 0 };
  return (
    <Panel
      name="events"
      title="Events"
      extra={
        <>
          {search.value.trim() !== '' && (
            <span role="status" data-testid="events-found">
              {found} found
            </span>
          )}
          {alarms > 0 && (
            <b class="status-alarm" title={warnings > 0 ? `and ${warnings} of a warning` : undefined}>
              {STATUS.alarm.shape} {alarms} alarm {alarms === 1 ? 'event' : 'events'}
            </b>
          )}
          {warnings > 0 && alarms === 0 && (
            <b class={`warnings ${lines.some(({ level, alarm }) => !alarm && WORST.has(level)) ? 'status-alarm' : ''}`}>
              ▲ {warnings} warning {warnings === 1 ? 'event' : 'events'}
            </b>
          )}
          <input
            type="search"
            placeholder="search"
            aria-label="search events"
            value={search.value}
            data-testid="event-search"
            onInput={(event) => (search.value = event.currentTarget.value)}
            onKeyDown={onSearchKey}
          />
          <select
            aria-label="this level and above"
            value={from.value}
            onChange={(event) => (from.value = event.currentTarget.value as (typeof LEVELS)[number])}
          >
            {LEVELS.map((level) => (
              <option key={level} value={level}>
                ≥ {levelWords(level)}
              </option>
            ))}
          </select>
        </>
      }
    >
      <ol class="events table-scroll" tabIndex={0} aria-label="events, newest first" data-testid="event-list">
        {lines.map((line) => {
          const source = sourceWords(line);
          return (
            <li
              key={line.key}
              class={`event level-${line.level} ${line.alarm ? 'is-alarm' : ''}`}
              data-event={line.name || undefined}
              data-menu={line.name === '' ? undefined : `timepoint ${line.name}`}
              data-at={line.e_s}
            >
              <time>{fromEntry(line.e_s, { tenths: true })}</time>
              <span class="shape" title={line.explanation ? 'explanation' : levelWords(line.level)}>
                {line.alarm ? STATUS.alarm.shape : levelShape(line.level)}
              </span>
              <div>
                {line.explanation && <small>why: </small>}
                {line.named && <b>{line.named}</b>}
                {line.text}
                {line.why.map((why) => (
                  <small key={why} class="why">
                    why: {why}
                  </small>
                ))}
              </div>
              <span class="source" title={source.words}>
                {source.shape}
              </span>
            </li>
          );
        })}
        {found > lines.length && <li class="none">{found - lines.length} older ones: search, or ask for a range</li>}
        {lines.length === 0 && <li class="none">no event yet{search.value ? ` with “${search.value}”` : ''}</li>}
        <Foot as="li" />
      </ol>
    </Panel>
  );
}
