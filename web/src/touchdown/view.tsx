// SPDX-License-Identifier: Apache-2.0
// The touchdown as a result: reported or confirmed, its figures, its place, and what still comes.
import { useEffect } from 'preact/hooks';
import { STATUS } from '../design/status';
import { prediction } from '../prediction/model';
import { toggleReplay } from '../replay/model';
import { isLost } from '../run/connection';
import { cutoff, dictionary, pastRange, runNow, timepoints } from '../run/shown';
import { focusPanel } from '../shortcuts/model';
import type { Tab } from '../places/model';
import { fromEntry } from '../run/time';
import { ellipseWords, Path } from '../vehicle/path';
import { refreshTouchdown, restOf, resultsOf } from './model';
import { touchdownKnown } from './shown';
import type { TouchdownStep } from './shown';
import './style.css';

const LOOKS = {
  done: { ...STATUS.holds, word: 'holds' },
  waiting: { ...STATUS.missing, word: 'waited for' },
  unknown: STATUS.unknown,
  never: { ...STATUS.never, word: 'never told' },
  contradicted: { ...STATUS.failed, word: 'contradicted' },
} as const satisfies Record<TouchdownStep['state'], object>;

const LOOK_MS = 500; // chosen: how often it is looked whether to ask anew
const AROUND_ELLIPSE = 0.55; // chosen: of its longer axis, from the target to the edge of the map

const VERDICTS = {
  reported: { ...STATUS.holds, words: 'Touchdown reported' },
  confirmed: { ...STATUS.good, words: 'Touchdown confirmed' },
  contradicted: { ...STATUS.failed, words: 'Touchdown contradicted' },
} as const;

/** Opens a panel here, or alone where this page has no tabs. */
function Open({ panel, keyName, words, run }: { panel: Tab; keyName: string; words: string; run: number }) {
  return (
    <a
      href={`?panel=${panel}&run=${run}`}
      onClick={(event) => {
        if (!document.querySelector('[data-testid="panel-data"]')) return;
        event.preventDefault();
        focusPanel(panel);
      }}
    >
      {words} <kbd>{keyName}</kbd>
    </a>
  );
}

export function Touchdown() {
  const run = runNow();
  const words = dictionary.value;
  const look = run && words && { run, words, plan: timepoints.value, cutoff: cutoff.value, lost: isLost.value };
  const of = touchdownKnown.value;
  useEffect(() => {
    void refreshTouchdown();
    const timer = setInterval(() => void refreshTouchdown(), LOOK_MS);
    return () => clearInterval(timer);
  }, [run?.id, cutoff.value]);
  if (!look || !of) return <p class="none">Asking the server for the touchdown…</p>;
  if (of.verdict === 'untold') return <p class="none">No touchdown has been told.</p>;
  const verdict = VERDICTS[of.verdict];
  const done = of.steps.filter(({ state }) => state === 'done').length;
  const never = of.steps.filter(({ state }) => state === 'never').length;
  const miss = of.place;
  const ellipse = prediction.value?.ellipse;
  return (
    <div class="touchdown-box">
      <div
        class="touchdown"
        data-testid="touchdown"
        data-verdict={of.verdict}
        tabIndex={0}
        role="region"
        aria-label="touchdown"
      >
        <h3 class={`status-${verdict.token}`}>
          {verdict.shape} {verdict.words}{' '}
          <span class="touchdown-when">
            {fromEntry((of.sclk ?? NaN) - look.run.entrySclk, { tenths: true })}, {done} of {of.steps.length} signals
            {never > 0 && `, ${never} never told`}
          </span>
        </h3>
        <dl class="touchdown-figures" data-testid="touchdown-figures">
          {resultsOf(look, of).map(({ name, value, unit, note, more }) => (
            <div key={name} title={more ? `${note}. ${more}` : note}>
              <dt>{name}</dt>
              <dd>
                <output>{value}</output> {unit}
                <small>{note}</small>
              </dd>
            </div>
          ))}
        </dl>
        <ol class="touchdown-steps" data-testid="touchdown-steps">
          {of.steps.map(({ name, state, words: evidence }) => (
            <li key={name} data-state={state} title={evidence}>
              <span class={`status-${LOOKS[state].token}`} title={LOOKS[state].word}>
                {LOOKS[state].shape}
              </span>
              <span>
                {name}
                <small>{evidence}</small>
              </span>
            </li>
          ))}
        </ol>
        <div class="touchdown-map">
          {miss ? (
            <Path
              points={[]}
              now={miss}
              stale={false}
              label="Touchdown and target from above"
              ellipse={ellipse}
              least_m={(ellipse?.majorM ?? 0) * AROUND_ELLIPSE}
            />
          ) : (
            <p>The place is not known.</p>
          )}
          {ellipse && miss?.inside_ellipse !== undefined && (
            <small data-testid="in-ellipse">
              {miss.inside_ellipse ? 'inside' : '▲ outside'} {ellipseWords(ellipse)}
            </small>
          )}
          {miss && <small data-testid="place-rests-on">{`The place rests on ${miss.rests_on}.`}</small>}
        </div>
        <div class="touchdown-next" data-testid="touchdown-next">
          {restOf(look, pastRange.value === undefined).map((rest) => (
            <p key={rest.words}>
              {rest.part !== undefined && rest.part < 1 && (
                <progress max={1} value={rest.part} aria-label="of the recording" />
              )}{' '}
              {rest.words}
            </p>
          ))}
          <p class="touchdown-links">
            <Open panel="flown" keyName="f" words="as flown" run={look.run.id} />
            <Open panel="verdicts" keyName="v" words="verdicts" run={look.run.id} />
            <button type="button" class="quiet" onClick={toggleReplay}>
              {pastRange.value ? 'leave the past' : 'replay'} <kbd>y</kbd>
            </button>
          </p>
        </div>
      </div>
    </div>
  );
}
