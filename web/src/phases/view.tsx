// SPDX-License-Identifier: Apache-2.0
// The strip of phases, legible across a room.
import { isLost } from '../run/connection';
import { cutoff, dictionary, runNow, timepoints } from '../run/shown';
import { fromEntry } from '../run/time';
import { predicted } from '../timeline/now';
import { saidOf, withSaid } from '../waiting/model';
import { nextWords, phaseSteps } from './model';
import './style.css';

const SHAPES = { done: '✓', now: '▶', ahead: '○' } as const;

const capital = (words: string) => words.replace(/^./, (letter) => letter.toUpperCase());

/** The vehicle's own word for its state has the large words where it names the phase: "Parachute descent". */
const isNamed = ({ title, detail }: { title: string; detail: string }) => detail.includes(title.toLowerCase());

export function Phases() {
  const run = runNow();
  if (!dictionary.value) return null;
  const plan = timepoints.value;
  const foreseen = run ? withSaid(predicted.value, saidOf(run, plan, cutoff.value)) : [];
  const steps = phaseSteps(run, dictionary.value, plan, cutoff.value, foreseen);
  // The last phase of a landing that is over does not go on; of a past it does.
  const isOver = cutoff.value === Infinity && run?.run.outcome === 'touchdown';
  // without a connection the clock stands still, and nothing is counted down
  const stands = isLost.value && cutoff.value === Infinity;
  const seen_e_s = run && !stands ? Math.min(run.seenSclk, cutoff.value) - run.entrySclk : NaN;
  return (
    <ol class="phases" data-testid="phases" aria-label="Phases of the landing">
      {steps.map((step) => (
        <li
          key={step.title}
          class={`phase phase-${step.state}`}
          aria-current={step.state === 'now' ? 'step' : undefined}
          data-testid={step.state === 'now' ? 'phase-now' : undefined}
        >
          <b>
            <span aria-hidden="true">{step.state === 'now' && isOver ? SHAPES.done : SHAPES[step.state]}</span>{' '}
            {isNamed(step) ? capital(step.detail) : step.title}
          </b>
          <small>
            {step.state === 'now' ? (
              <>
                <span>
                  {(!isNamed(step) && step.detail) ||
                    (step.since_e_s !== undefined && `from ${fromEntry(step.since_e_s)}`)}
                </span>{' '}
                <i>{nextWords(steps, seen_e_s)}</i>
              </>
            ) : step.state === 'done' ? (
              step.since_e_s !== undefined && `from ${fromEntry(step.since_e_s)}`
            ) : (
              step.predicted_e_s !== undefined &&
              `${step.predicted_e_s < seen_e_s ? 'predicted' : '≈'} ${fromEntry(step.predicted_e_s)}`
            )}
          </small>
          {step.part !== undefined && <span class="phase-part" style={{ width: `${(step.part * 100).toFixed(1)}%` }} />}
        </li>
      ))}
    </ol>
  );
}
