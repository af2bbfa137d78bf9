// SPDX-License-Identifier: Apache-2.0
// The plan of a run: its purpose, and its injects in order with what has become of each. While the run goes on an
// inject that waits has its buttons, and what a good team does is folded away; afterwards all of it is open, for paper.
import { busy, message, messageWords } from './instructor';
import { fateOf, injectNow, skip } from './plan';
import type { Inject, Plan } from './plan';

const LOOKS = { waiting: '', done: 'status-caution', skipped: 'status-dim' } as const;

/** The buttons of an inject that waits. */
function Orders({ of }: { of: Inject }) {
  const orders = [
    ['now', injectNow],
    ['skip', skip],
  ] as const;
  return orders.map(([word, order]) => (
    <button
      key={word}
      type="button"
      aria-label={`${word}: ${of.title}`}
      disabled={busy.value}
      data-testid={`inject-${word}-${of.inject}`}
      onClick={(event) => {
        event.currentTarget.closest('li')?.focus(); // the button goes away with the order
        void order(of);
      }}
    >
      {word}
    </button>
  ));
}

function Team({ of }: { of: Inject }) {
  return (
    <ul aria-label={`a good team, ${of.title}`}>
      {of.team.map((each) => (
        <li key={each}>{each}</li>
      ))}
    </ul>
  );
}

function InjectRow({ of, going }: { of: Inject; going: boolean }) {
  return (
    <li tabIndex={going ? -1 : undefined} data-inject={of.inject} data-state={of.state}>
      <div class="inject-head">
        <span class={LOOKS[of.state]}>{fateOf(of, going)}</span> <b>{of.title}</b>{' '}
        <span class="status-dim">{of.when || 'by hand'}</span> {going && of.state === 'waiting' && <Orders of={of} />}
      </div>
      {going && message.value?.inject === of.inject && (of.state === 'waiting' || !message.value.good) && (
        <p>{messageWords()}</p>
      )}
      {of.does && (
        <p>
          <span class="status-dim">does</span> {of.does}
        </p>
      )}
      {of.shows && (
        <p>
          <span class="status-dim">shows</span> {of.shows}
        </p>
      )}
      {of.team.length > 0 &&
        (going ? (
          <details>
            <summary>what a good team does</summary>
            <Team of={of} />
          </details>
        ) : (
          <>
            <p class="status-dim">a good team</p>
            <Team of={of} />
          </>
        ))}
    </li>
  );
}

export function PlanView({ of, going }: { of: Plan; going: boolean }) {
  return (
    <section class="plan" data-testid="plan">
      <h3>Plan: {of.title || of.name}</h3>
      {of.purpose && <p>{of.purpose}</p>}
      <ol class="injects" aria-label="injects">
        {of.injects.map((each) => (
          <InjectRow key={each.inject} of={each} going={going} />
        ))}
      </ol>
    </section>
  );
}
