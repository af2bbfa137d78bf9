// SPDX-License-Identifier: Apache-2.0
// Whether the list of standard calls is open. What it consists of is loaded when it is first wanted.
import { signal } from '@preact/signals';
import { mayAct } from '../access/model';
import { dictionary, notify, takesActs } from '../run/shown';

/** "read back": the newest call that waits for it is read back at once, and the list stays closed if it can be. */
export const callsAsked = signal<'nothing' | 'list' | 'read back'>('nothing');
/** Set soon after the page has been built: from then on calls of others are shown as they come. */
export const callsReady = signal(false);

const hasCalls = () => (dictionary.value?.reply.calls.length ?? 0) > 0;

export const callsShown = (): boolean =>
  hasCalls() && takesActs() && (callsReady.value || callsAsked.value !== 'nothing');

export function askCalls(what: 'list' | 'read back'): void {
  const why = !hasCalls()
    ? 'the mission has no standard calls'
    : !takesActs()
      ? 'calls are made while a run goes on, and not from the past'
      : mayAct()
        ? ''
        : 'observers make no calls';
  if (why) notify(`No call: ${why}.`);
  else callsAsked.value = what;
}
