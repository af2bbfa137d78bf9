// SPDX-License-Identifier: Apache-2.0
// The banner: the one thing that matters most now, as a sentence, with what it counts down to.
import { armedHere, armedLeft_s } from '../commands/armed';
import { openedLater } from '../design/opened_later';
import { STATUS } from '../design/status';
import { modeNow, runNow, takesActs } from '../run/shown';
import { duration, fromEntry } from '../run/time';
import { LOOKS, aside, listShown, lookOf, pointAt, putAside, situationNow, toggleList } from './model';
import type { Line } from './model';
import './style.css';

/** Letters that have room in one line in the large size, at each width; more have the smaller one. */
const ONE_LINE = 68;
/** Letters of news that have room in the largest size beside what can be pressed. */
const NEWS = 48;
/** The same of what is waited for, which has a countdown. */
const WAIT = 33;

/** The evidence of an entry, which leads to its instant. */
function Evidence({ line, words }: { line: Line; words: string }) {
  if (Number.isNaN(line.since_e_s)) return null;
  const told = `${line.evidence === '' ? '' : `${line.evidence}, `}${fromEntry(line.since_e_s)}`;
  return (
    <button
      type="button"
      class="quiet"
      title={`${told}: show this instant`}
      aria-label={`evidence: ${told}`}
      onClick={() => pointAt(line.since_e_s)}
    >
      {words || told}
    </button>
  );
}

function Entry({ line }: { line: Line }) {
  const { shape, token } = STATUS[lookOf(line)];
  return (
    <li>
      <span aria-hidden="true" style={{ color: `var(--${token})` }}>
        {shape}
      </span>{' '}
      <span>{line.sentence}</span>
      <output>{line.countdown}</output>
      {line.aside && <small>put aside</small>}
      <Evidence line={line} words="" />
    </li>
  );
}

/** Ahead of what the server says: what is armed here is this console's alone. */
function ArmedHere() {
  const names = armedHere.value;
  if (names.length === 0) return null;
  const left_s = armedLeft_s();
  return (
    <strong class="armed-here" data-testid="armed-here">
      <span role="alert">▲ ARMED HERE: {names.join(', ')}</span>
      {left_s !== undefined && <small>latest to send in {duration(left_s)}</small>}
    </strong>
  );
}

/** Of a room in which somebody has taken a position. */
const AskedHere = openedLater(async () => (await import('../positions/asked')).AskedHere);

export function Situation() {
  const run = runNow();
  const { first, more } = situationNow(run);
  if (!run && !first) return null;
  // Beside the badge are only its first words.
  const lasts = lastingNow(run).filter(({ sentence }) => ![first, ...more].some((line) => line?.sentence === sentence));
  // What is armed here has the large words.
  const isLong = first && (armedHere.value.length > 0 || first.sentence.length + first.countdown.length > ONE_LINE);
  const isNews = first && first.sentence.length <= (first.countdown === '' ? NEWS : first.namesAwaited ? WAIT : 0);
  const size = isLong ? 'situation-long' : isNews ? 'situation-news' : '';
  const look = first ? lookOf(first) : 'never';
  const [next, waiting] = [more.find((line) => !line.aside), more.filter((line) => !line.aside).length];
  return (
    <section
      class={`situation ${first?.rank === 'lost' ? 'situation-lost' : ''} ${size}`}
      style={{ '--look': `var(--${STATUS[look].token})` }}
      data-testid="situation"
      data-rank={first?.rank}
      aria-label="situation"
    >
      <ArmedHere />
      {run?.positions && <AskedHere />}
      <span class="situation-shape" aria-hidden="true">
        {STATUS[look].shape}
      </span>
      <b aria-live={first?.rank === 'lost' ? 'assertive' : 'polite'} data-testid="situation-sentence">
        {first?.sentence ?? 'Nothing has been told yet'}
      </b>
      <output data-testid="situation-countdown">{first?.countdown}</output>
      {first && <Evidence line={first} words="why" />}
      {first?.mayGo && (
        <button type="button" class="quiet" onClick={() => putAside(first)}>
          put aside <kbd>x</kbd>
        </button>
      )}
      {more.length + lasts.length > 0 && (
        <button
          type="button"
          class="quiet"
          aria-expanded={listShown.value}
          onClick={toggleList}
          data-testid="situation-more"
        >
          {next && (
            <span title={next.sentence} style={{ color: `var(--${STATUS[lookOf(next)].token})` }}>
              {STATUS[lookOf(next)].shape}{' '}
            </span>
          )}
          {waiting > 0 ? `+${waiting} more` : more.length > 0 ? `${aside.value.size} put aside` : 'what lasts'}{' '}
          <kbd>m</kbd>
        </button>
      )}
      {listShown.value && more.length + lasts.length > 0 && (
        <ol data-testid="situation-list">
          {first && [first, ...more].map((line) => <Entry key={line.key} line={line} />)}
          {lasts.map(({ subject, sentence }) => (
            <li key={`lasting ${subject}`}>
              <span aria-hidden="true" class="caution">
                {STATUS[LOOKS.lasting].shape}
              </span>{' '}
              <span>{sentence}</span>
            </li>
          ))}
        </ol>
      )}
    </section>
  );
}

/** What lasts. Where nothing can be sent, nobody needs to know that it would be too late. */
function lastingNow(run: ReturnType<typeof runNow>) {
  const all = situationNow(run).lasting.filter(
    ({ subject }) => subject !== 'commanding' || ['live', 'rehearsal'].includes(modeNow()),
  );
  const closed = takesActs() ? run?.positions?.board.closed : '';
  const words = 'Commanding is closed';
  return closed ? [...all, { subject: 'room', words, sentence: `${words}: ${closed}` }] : all;
}

/** The states that last, beside the badge. */
export function Lasting() {
  const lasting = lastingNow(runNow());
  if (lasting.length === 0) return null;
  return (
    <ul class="lasting" data-testid="lasting" aria-label="states that last">
      {lasting.map(({ words, sentence }) => (
        <li key={words} title={sentence}>
          {words}
        </li>
      ))}
    </ul>
  );
}
