// SPDX-License-Identifier: Apache-2.0
// Whether the anomaly report is open. What it consists of is loaded when it is first opened.
import { signal } from '@preact/signals';

/** "kept": it was written into the shift log, and says so for a moment. */
export const reportState = signal<'closed' | 'open' | 'kept'>('closed');
/** Whether something was typed into it: leaving then asks first. */
export const reportTyped = signal(false);
export const leavingAsks = signal(false);

/** Opens a report of what is on the screen; one that is open gets the focus. */
export function openReport(): void {
  if (reportState.value === 'open') document.querySelector<HTMLElement>('[data-testid="report-cause"]')?.focus();
  else reportTyped.value = leavingAsks.value = false;
  reportState.value = 'open';
}

/** Returns whether there was one to leave. What was typed is thrown away at the second time only. */
export function leaveReport(): boolean {
  if (reportState.value === 'closed') return false;
  if (reportState.value === 'open' && reportTyped.value && !leavingAsks.value) leavingAsks.value = true;
  else reportState.value = 'closed';
  return true;
}
