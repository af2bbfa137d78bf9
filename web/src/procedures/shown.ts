// SPDX-License-Identifier: Apache-2.0
// What the panel shows: a procedure of the run by its number, those that are over, or the library; and what it focuses.
import { computed } from '@preact/signals';
import { signalOfRun } from '../run/shown';
import { begin, executions, underWay } from './model';
import type { Execution } from './model';

const chosen = signalOfRun<number | 'library' | 'over' | undefined>(undefined);

export function show(what: number | 'library' | 'over'): void {
  chosen.value = what;
}

/** What was chosen, as far as it is there at the instant shown; else the newest under way, else the library. */
export const shownNow = computed<Execution | 'library' | 'over'>(() => {
  const wanted = chosen.value;
  if (wanted === 'library' || wanted === 'over') return wanted;
  return (executions.value ?? []).find(({ number }) => number === wanted) ?? underWay.value.at(-1) ?? 'library';
});

/**
 * Focuses what comes next after something was done, unless the person went elsewhere: the row of the step of now, not
 * its button, so that a second press does nothing.
 */
export function goOn(): void {
  requestAnimationFrame(() => {
    if (document.activeElement && document.activeElement !== document.body) return;
    const next = ['[data-next]', '[data-testid="position-change"]'];
    next
      .map((each) => document.querySelector<HTMLElement>(`.procedures ${each}`))
      .find(Boolean)
      ?.focus();
  });
}

/** Begins a procedure, shows it, and goes to its first step of now. */
export async function beginIt(procedure: string): Promise<void> {
  const begun = await begin(procedure);
  if (!begun) return;
  show(begun.number);
  goOn();
}
