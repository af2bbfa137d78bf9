// SPDX-License-Identifier: Apache-2.0
// The guide for a first landing: beside the display, never over it. Once put away it stays away.
import { GUIDE_STEPS, guideNow, toggleGuide } from './model';
import './style.css';

export function Guide() {
  const step = guideNow();
  if (!step) return null;
  return (
    <aside class="guide" data-testid="guide" aria-label="guide for a first landing">
      <p class="guide-head">
        <span class="guide-dots" role="img" aria-label={`step ${step.number} of ${GUIDE_STEPS}`}>
          {Array.from({ length: GUIDE_STEPS }, (_, i) => (
            <i key={i} class={i + 1 < step.number ? 'done' : i + 1 === step.number ? 'now' : ''} />
          ))}
        </span>
        <span class="guide-name">Your first landing</span>
        <button type="button" class="quiet" onClick={toggleGuide} data-testid="guide-hide">
          put away <kbd>g</kbd>
        </button>
      </p>
      <h2 aria-live="polite">{step.title}</h2>
      <p>{step.why}</p>
      {step.press.length > 0 && (
        <ol>
          {step.press.map((press) => (
            <li key={`${press.key} ${press.type} ${press.words}`} class={press.done ? 'unseen' : ''}>
              {press.key && <kbd>{press.key}</kbd>}
              {press.type && (
                <>
                  type <kbd>{press.type}</kbd>
                </>
              )}{' '}
              {press.words}
            </li>
          ))}
        </ol>
      )}
    </aside>
  );
}
