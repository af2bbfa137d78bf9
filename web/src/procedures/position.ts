// SPDX-License-Identifier: Apache-2.0
// The position that the person at this browser has in procedures: one of those that are theirs, else the one that they
// say, chosen once and kept here. It is told with each act.
import { computed, signal } from '@preact/signals';
import { mayAct } from '../access/model';
import { lacksName, myPositions } from '../positions/model';

const KEPT = 'aeolis-position';

const chosen = signal(localStorage.getItem(KEPT) ?? '');

/** Who has several acts from the chosen one of them, else from the first. */
export const position = computed<string>(() => {
  const held = myPositions.value;
  return held.length === 0 || held.includes(chosen.value) ? chosen.value : (held[0] as string);
});

export function choosePosition(name: string): void {
  chosen.value = name;
  if (name === '') localStorage.removeItem(KEPT);
  else localStorage.setItem(KEPT, name);
}

const inWords = (name: string): string =>
  name.replaceAll('_', ' ').replace(/\b(edl|gnc)\b/g, (word) => word.toUpperCase());

/** "edl_communications" → "EDL communications". */
export const positionWords = (name: string): string => inWords(name).replace(/^./, (letter) => letter.toUpperCase());

/**
 * "a_ng (flight_director): by_hand" → "a_ng (flight director): by_hand". The names of positions and watchdogs are ids;
 * names of people and reasons stay as they were written.
 */
export const byWords = (by: string): string => by.replace(/^watchdog \w+$|\([a-z_]+\)(?=:|$)/, (id) => inWords(id));

/** What this browser lacks before anything can be done; '': nothing. */
export function lacking(): string {
  if (!mayAct()) return 'observers take no part';
  if (position.value === '') return 'choose your position first';
  return lacksName() ? 'type your name first' : '';
}
