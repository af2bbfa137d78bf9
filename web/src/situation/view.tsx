// SPDX-License-Identifier: Apache-2.0
// The banner: the one thing that matters most now, as a sentence, with what it counts down to.
import { STATUS } from '../design/status';
import { runNow } from '../run/shown';
import { fromEntry } from '../run/time';
import { aside, listShown, lookOf, pointAt, putAside, situationNow, toggleList } from './model';
import type { Line } from './model';
import './style.css';

/** The evidence of an entry, which leads to its instant. */
function Evidence({ line }: { line: Line }) {
  if (Number.isNaN(line.since_e_s)) return null;
  return (
    <button
      type="button"
      class="quiet situation-evidence"
      title={line.evidence === '' ? 'show this instant' : `${line.evidence}: show its instant`}
      onClick={() => pointAt(line.since_e_s)}
    >
      {fromEntry(line.since_e_s)}
    </button>
  );
}

function Entry({ line }: { line: Line }) {
  const look = lookOf(line);
  return (
    <li class={`look-${look}`}>
      <span aria-hidden="true">{STATUS[look].shape}</span> <span>{line.sentence}</span>
      <output>{line.countdown}</output>
      <Evidence line={line} />
      {line.aside && <small>put aside</small>}
    </li>
  );
}

export function Situation() {
  const run = runNow();
  const { first, more } = situationNow(run);
  if (!run && !first) return null;
  const look = first ? lookOf(first) : 'never';
  const waiting = more.filter((line) => !line.aside).length;
  return (
    <section class={`situation look-${look}`} data-testid="situation" data-rank={first?.rank} aria-label="situation">
      <span class="situation-shape" aria-hidden="true">
        {STATUS[look].shape}
      </span>
      <b aria-live={first?.rank === 'lost' ? 'assertive' : 'polite'} data-testid="situation-sentence">
        {first?.sentence ?? 'Nothing has been told yet'}
      </b>
      <output data-testid="situation-countdown">{first?.countdown}</output>
      {first && <Evidence line={first} />}
      {first?.rank === 'news' && (
        <button type="button" class="quiet" onClick={() => putAside(first)}>
          put aside <kbd>x</kbd>
        </button>
      )}
      {more.length > 0 && (
        <button
          type="button"
          class="quiet"
          aria-expanded={listShown.value}
          onClick={toggleList}
          data-testid="situation-more"
        >
          {waiting > 0 ? `+${waiting} more` : `${aside.value.size} put aside`} <kbd>m</kbd>
        </button>
      )}
      {listShown.value && more.length > 0 && (
        <ol data-testid="situation-list">
          {more.map((line) => (
            <Entry key={line.key} line={line} />
          ))}
        </ol>
      )}
    </section>
  );
}

/** The states that last, beside the badge. */
export function Lasting() {
  return (
    <>
      {situationNow(runNow()).lasting.map(({ words, sentence }) => (
        <span key={words} class="lasting" title={sentence} data-testid="lasting">
          {words}
        </span>
      ))}
    </>
  );
}
