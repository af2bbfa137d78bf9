// SPDX-License-Identifier: Apache-2.0
// The position that the person at this browser has, as they say: chosen once, kept here, told with each act.
import { signal } from '@preact/signals';
import { access, mayAct } from '../access/model';
import { uplink } from '../commands/line';

const KEPT = 'aeolis-position';

export const position = signal(localStorage.getItem(KEPT) ?? '');

export function choosePosition(chosen: string): void {
  position.value = chosen;
  if (chosen === '') localStorage.removeItem(KEPT);
  else localStorage.setItem(KEPT, chosen);
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

/** The name with which this browser's acts are signed. */
export const myName = (): string => (access.value.state === 'in' ? access.value.user : uplink.value.controller.trim());

/** Without accounts whoever acts gives a name. */
export const lacksName = (): boolean => myName() === '';

/** What this browser lacks before anything can be done; '': nothing. */
export function lacking(): string {
  if (!mayAct()) return 'observers take no part';
  if (position.value === '') return 'choose your position first';
  return lacksName() ? 'type your name first' : '';
}
