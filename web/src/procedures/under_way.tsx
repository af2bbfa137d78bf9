// SPDX-License-Identifier: Apache-2.0
// Beside the timeline: the procedures under way, each with what it is at, who does it and how long it still has.
import { stream } from '../run/connection';
import { runNow } from '../run/shown';
import { focusPanel } from '../shortcuts/model';
import { awaitedOf, isNow, lookOf, trippedOf, underWay } from './model';
import type { Execution, Step } from './model';
import { positionWords } from './position';
import { show } from './shown';
import { inWords, isAfterEnd, leftWords } from './step';
import { useProcedures } from './view';

/** The step that is named: the one that has the least time left, else the first. */
const named = (now: readonly Step[]): Step | undefined =>
  [...now].sort((one, other) => Number(one.limit_us ?? Infinity) - Number(other.limit_us ?? Infinity))[0];

function Line({ one }: { one: Execution }) {
  const run = runNow();
  const look = lookOf(one);
  const now = one.steps.filter(isNow);
  const step = named(now);
  const [dog] = trippedOf(one);
  const left = run && step && leftWords(run, step);
  return (
    <li data-testid={`under-way-${one.number}`}>
      <button
        type="button"
        class="quiet"
        title={dog?.text ?? step?.text}
        onClick={() => {
          show(one.number);
          focusPanel('procedures');
        }}
      >
        <b title={one.title}>
          <span class={`status-${look.token}`} role="img" aria-label={look.word}>
            {look.shape}
          </span>{' '}
          {one.title}
        </b>
        {left && <span class={`under-way-left ${left.late ? 'status-caution' : ''}`}>{left.words}</span>}
        {dog ? (
          <span class="status-caution under-way-step">
            watchdog {inWords(dog.watchdog)}: {positionWords(dog.who)}
          </span>
        ) : (
          step && (
            <span class="under-way-step">
              {inWords(step.step)}: {awaitedOf(step).map(positionWords).join(', ')}
              {now.length > 1 && ` +${now.length - 1} more`}
            </span>
          )
        )}
      </button>
    </li>
  );
}

export function UnderWay() {
  useProcedures();
  const run = runNow();
  if (!run || underWay.value.length === 0 || isAfterEnd(run)) return null;
  return (
    <section
      class={`under-way ${stream.value.state === 'lost' ? 'is-old' : ''}`}
      data-testid="under-way"
      aria-label="procedures under way"
      tabIndex={0}
    >
      <h3>
        Procedures <kbd>8</kbd>
      </h3>
      <ul>
        {underWay.value.map((one) => (
          <Line key={one.number} one={one} />
        ))}
      </ul>
    </section>
  );
}
