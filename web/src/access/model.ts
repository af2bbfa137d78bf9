// SPDX-License-Identifier: Apache-2.0
// The user of the page and their rights. A server without accounts grants all rights to everyone on its own machine.
import { effect, signal } from '@preact/signals';
import { Refused, call, turnedAway, wordsFor } from '../run/api';

interface Session {
  accounts: boolean;
  user: string;
  role: string;
  rights: string[];
  /**
   * The password was set by another person. Until its owner has chosen a new one, the server refuses everything else.
   */
  choose_password?: boolean;
}

/**
 * "asking": not known yet. "open": no accounts. "in": logged in. "out": a log-in is needed; `expired` after an earlier
 * one. "choose": the user must first choose a password. "none": the server has no sessions.
 */
type Access =
  | { state: 'asking' | 'none' | 'open' }
  | { state: 'out'; expired: boolean; user: string }
  | { state: 'choose'; user: string }
  | { state: 'in'; user: string; role: string; rights: string[] };

export const access = signal<Access>({ state: 'asking' });
export const problem = signal('');
export const busy = signal(false);

/** Asks the server for the session. Throws if no server answers. */
export async function learnAccess(): Promise<void> {
  try {
    const session = await call<Session>('GET', '/session');
    if (!session.accounts) access.value = { state: 'open' };
    else if (session.user === '') turnAway();
    else if (session.choose_password) access.value = { state: 'choose', user: session.user };
    else access.value = { state: 'in', user: session.user, role: session.role, rights: session.rights ?? [] };
  } catch (error) {
    if (!(error instanceof Refused) || error.status === 0) throw error;
    if (error.status === 401) turnAway();
    else if (error.status === 404) access.value = { state: 'none' };
    else throw error;
  }
}

function turnAway(): void {
  const now = access.peek();
  access.value =
    now.state === 'out' ? now : { state: 'out', expired: now.state === 'in', user: now.state === 'in' ? now.user : '' };
}

export const logIn = (user: string, password: string): Promise<void> =>
  enter(() => call('POST', '/session', { user, password }));

/** Replaces the password that another person set. */
export async function choosePassword(given: string, chosen: string, again: string): Promise<void> {
  const now = access.value;
  if (now.state !== 'choose') return;
  if (chosen !== again) problem.value = 'the two are not the same: type them again';
  else
    await enter(() =>
      call('PATCH', `/users/${encodeURIComponent(now.user)}`, { current_password: given, password: chosen }),
    );
}

async function enter(ask: () => Promise<unknown>): Promise<void> {
  if (busy.value) return;
  busy.value = true;
  problem.value = '';
  try {
    await ask();
    await learnAccess();
  } catch (error) {
    problem.value = wordsFor(error);
  } finally {
    busy.value = false;
  }
}

export async function logOut(): Promise<void> {
  try {
    await call('DELETE', '/session');
    location.reload(); // the page keeps nothing that it showed
  } catch (error) {
    problem.value = wordsFor(error);
  }
}

/** Resolves once the user may see the console. */
export function admitted(): Promise<void> {
  return new Promise((resolve) => {
    const stop = effect(() => {
      if (!['open', 'in', 'none'].includes(access.value.state)) return;
      queueMicrotask(() => stop());
      resolve();
    });
  });
}

/**
 * Whether the user may send at all: observers may not. For the others the server decides on each command. After the end
 * of a session typed text stays, and the server refuses it.
 */
export function mayAct(now: Access = access.value): boolean {
  return now.state !== 'in' || now.role !== 'observer';
}

/** Whether the user may send hazardous commands, and so direct the flight. */
export function mayDirect(now: Access = access.value): boolean {
  return now.state !== 'in' || now.rights.includes('hazardous');
}

/** Whether the user may start rehearsals and campaigns. The page explains a missing right; the server decides. */
export function mayRehearse(now: Access = access.value): boolean {
  return now.state !== 'in' || now.rights.includes('rehearse');
}

/** Whether the user may inject faults, follow a plan of injects and read what is hidden from the others. */
export function mayInstruct(now: Access = access.value): boolean {
  return now.state !== 'in' || now.rights.includes('instruct');
}

/** Why the session may not do `what`, for lack of a right. Empty if nothing is known. */
const whyNot =
  (right: string) =>
  (what: string, now: Access = access.value) =>
    now.state === 'in' ? `${what} need the right to ${right}; you are ${now.user}, ${now.role}` : '';
export const whyNotRehearse = whyNot('rehearse');
export const whyNotInstruct = whyNot('instruct');

effect(() => {
  if (turnedAway.value > 0) turnAway();
});
