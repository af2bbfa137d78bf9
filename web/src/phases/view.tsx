// The strip that says where in the landing we are.
import { cutoff, dictionary, store, tick } from '../run/session';
import { fromEntry } from '../run/time';
import { phaseSteps } from './model';
import './style.css';

const SHAPES = { done: '✓', now: '▶', ahead: '○' } as const;

export function Phases() {
  void tick.value;
  if (!dictionary.value) return null;
  return (
    <ol class="phases" data-testid="phases" aria-label="Phases of the landing">
      {phaseSteps(store.value, dictionary.value, cutoff.value).map((step) => (
        <li key={step.title} class={`phase phase-${step.state}`} aria-current={step.state === 'now' ? 'step' : undefined}
          data-testid={step.state === 'now' ? 'phase-now' : undefined}>
          <span aria-hidden="true">{SHAPES[step.state]}</span> <b>{step.title}</b> <em>{step.detail}</em>
          <small>{step.state === 'ahead' || step.since_e_s === undefined ? '' : `from ${fromEntry(step.since_e_s)}`}</small>
        </li>
      ))}
    </ol>
  );
}
