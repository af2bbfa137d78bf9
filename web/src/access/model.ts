// SPDX-License-Identifier: Apache-2.0
// Who looks at the page, and what they may do. A server without accounts lets everyone on its own machine do everything.
import { effect, signal } from '@preact/signals';
import { Refused, call, turnedAway, wordsFor } from '../run/api';

interface Session {
  accounts: boolean;
  user: string;
  role: string;
  rights: string[];
  /** The password was given by another: until its owner has chosen one, nothing else is answered. */
  choose_password?: boolean;
}

/**
 * "asking": not known yet; "open": no accounts; "in": logged in; "out": a log-in is needed, "expired" when there was one before.
 * "choose": a password of their own is to be chosen first. "none": a server that knows of no sessions.
 */
type Access =
  | { state: 'asking' | 'none' | 'open' }
  | { state: 'out'; expired: boolean; user: string }
  | { state: 'choose'; user: string }
  | { state: 'in'; user: string; role: string; rights: string[] };

export const access = signal<Access>({ state: 'asking' });
export const problem = signal('');
export const busy = signal(false);

/** Asks who we are; throws where no server answers. */
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

/** In place of the one that another gave. */
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
    location.reload(); // nothing of what was shown stays in the page
  } catch (error) {
    problem.value = wordsFor(error);
  }
}

/** Resolves once what is shown may be shown. */
export function admitted(): Promise<void> {
  return new Promise((resolve) => {
    const stop = effect(() => {
      if (!['open', 'in', 'none'].includes(access.value.state)) return;
      queueMicrotask(() => stop());
      resolve();
    });
  });
}

/** Observers send nothing; for everyone else the server decides, command by command. After the end of a session what is typed stays, and is refused. */
export function mayAct(now: Access = access.value): boolean {
  return now.state !== 'in' || now.role !== 'observer';
}

/** Rehearsals and campaigns. Whose session lacks the right is told so; the server decides. */
export function mayRehearse(now: Access = access.value): boolean {
  return now.state !== 'in' || now.rights.includes('rehearse');
}

/** For who may not: `what` needs a right that this session lacks. '' where there is nothing to say. */
export function whyNotRehearse(what: string, now: Access = access.value): string {
  return now.state === 'in' ? `${what} need the right to rehearse; you are ${now.user}, ${now.role}` : '';
}

effect(() => {
  if (turnedAway.value > 0) turnAway();
});
