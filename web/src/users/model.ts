// Accounts, tokens of programs and what everyone did: for administrators. Nothing of it is kept in the page longer than it is shown.
import { signal } from '@preact/signals';
import { call, wordsFor } from '../run/api';

export const ROLES = ['observer', 'controller', 'director', 'administrator'] as const;
export type Role = (typeof ROLES)[number];

export interface User {
  user: string;
  role: string;
}
export interface Token {
  name: string;
  role: string;
}
export interface AuditEntry {
  entry: string;
  at: string;
  who: string;
  from: string;
  action: string;
  detail: string;
  outcome: string;
  hash: string;
}

export const users = signal<User[]>([]);
export const tokens = signal<Token[]>([]);
export const audit = signal<AuditEntry[]>([]);
export const auditAfter = signal('');
export const message = signal<{ good: boolean; text: string } | undefined>(undefined);
/** Shown once, for the server keeps no readable copy. */
export const newToken = signal<{ name: string; token: string } | undefined>(undefined);
export const busy = signal(false);

const AUDIT_LIMIT = 100;

export async function refreshUsers(): Promise<void> {
  try {
    const [all, programs, log] = await Promise.all([
      call<{ users?: User[] }>('GET', '/users'), call<{ tokens?: Token[] }>('GET', '/tokens'),
      call<{ entries?: AuditEntry[] }>('GET', `/audit?${auditAfter.value && `after=${auditAfter.value}&`}limit=${AUDIT_LIMIT}`),
    ]);
    users.value = all.users ?? [];
    tokens.value = programs.tokens ?? [];
    audit.value = log.entries ?? [];
  } catch (error) {
    message.value = { good: false, text: wordsFor(error) };
  }
}

/** Does one thing once, says what became of it, and asks for the lists again. */
export async function change(words: string, what: () => Promise<unknown>): Promise<boolean> {
  if (busy.value) return false;
  busy.value = true;
  message.value = undefined;
  try {
    await what();
    message.value = { good: true, text: words };
    await refreshUsers();
    return true;
  } catch (error) {
    message.value = { good: false, text: `not done: ${wordsFor(error)}` };
    return false;
  } finally {
    busy.value = false;
  }
}

const at = (path: string, name: string) => `${path}/${encodeURIComponent(name)}`;

export const addUser = (user: string, role: string, password: string) =>
  change(`${user} is ${role} now`, () => call('POST', '/users', { user, role, password }));
export const setRole = (user: string, role: string) => change(`${user} is ${role} now`, () => call('PATCH', at('/users', user), { role }));
export const setPassword = (user: string, password: string) => change(`${user} has a new password`, () => call('PATCH', at('/users', user), { password }));
export const setOwnPassword = (user: string, current: string, password: string) =>
  change('your password is changed', () => call('PATCH', at('/users', user), { current_password: current, password }));
export const removeUser = (user: string) => change(`${user} is removed`, () => call('DELETE', at('/users', user)));
export const addToken = (name: string, role: string) =>
  change(`the token ${name} is made`, async () => {
    const made = await call<{ token: string }>('POST', '/tokens', { name, role });
    newToken.value = { name, token: made.token };
  });
export const removeToken = (name: string) => change(`the token ${name} is void`, () => call('DELETE', at('/tokens', name)));
