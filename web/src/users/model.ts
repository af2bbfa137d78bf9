// SPDX-License-Identifier: Apache-2.0
// Accounts, tokens and the audit, for administrators. The page keeps them only while they are shown.
import { signal } from '@preact/signals';
import { call, wordsFor } from '../run/api';
import type { Dictionary } from '../run/dictionary';
import { readAll } from '../run/pages';
import { dictionary } from '../run/shown';

export const ROLES = ['observer', 'controller', 'director', 'instructor', 'administrator'] as const;

interface User {
  user: string;
  role: string;
  commands?: string[]; // the only commands allowed; undefined: all commands of the role
}
interface Token {
  name: string;
  role: string;
  /** The account that it counts as. */
  owner?: string;
  commands?: string[];
}
interface AuditEntry {
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
/** The audit page ends before this entry; empty: the newest page. */
export const auditBefore = signal('');
export const message = signal<{ good: boolean; text: string } | undefined>(undefined);
/** The secret of a new token. It is shown once, since the server keeps no readable copy. */
export const newToken = signal<{ name: string; token: string } | undefined>(undefined);
export const busy = signal(false);

const AUDIT_LIMIT = 100;
const OFFERED = 20; // chosen: names offered under a field

/** A page of the audit, newest first; 0: the newest page. */
const auditUpTo = async (before: number): Promise<AuditEntry[]> =>
  (await call<{ entries?: AuditEntry[] }>('GET', `/audit?order=newest&after=${before}&limit=${AUDIT_LIMIT}`)).entries ??
  [];

export async function refreshUsers(): Promise<void> {
  try {
    const [all, programs, log] = await Promise.all([
      readAll<{ users: User[] }, 'users'>('/users', 'users'),
      readAll<{ tokens: Token[] }, 'tokens'>('/tokens', 'tokens'),
      auditUpTo(Number(auditBefore.value)),
    ]);
    users.value = all.users;
    tokens.value = programs.tokens;
    audit.value = log;
  } catch (error) {
    message.value = { good: false, text: wordsFor(error) };
  }
}

export function lookAtAudit(before: string): void {
  auditBefore.value = before;
  void refreshUsers();
}

/** Performs one change, reports the result, and asks for the lists again. */
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

/**
 * Reads command names in any case, separated by commas or spaces. Throws an Error with the names unknown to the
 * dictionary.
 */
function commandsOf(text: string, known: Pick<Dictionary, 'command'> | undefined): string[] {
  const names = [
    ...new Set(
      text
        .toUpperCase()
        .split(/[\s,;]+/)
        .filter((name) => name !== ''),
    ),
  ];
  const strange = names.filter((name) => known?.command(name) === undefined);
  if (strange.length > 0) throw new Error(`the dictionary has no command ${strange.join(', ')}`);
  return names;
}

/** Completions of the typed text: each is the whole field with its last word completed. */
export function offersFor(text: string, all: readonly { name: string }[]): string[] {
  const [, stem = '', begun = ''] = /^([^]*?)([^\s,;]*)$/.exec(text) ?? [];
  return begun === ''
    ? []
    : all
        .filter(({ name }) => name.startsWith(begun.toUpperCase()))
        .slice(0, OFFERED)
        .map(({ name }) => stem + name);
}

const listed = (commands: readonly string[]) => (commands.length > 0 ? { commands } : {});

export const addUser = (user: string, role: string, password: string, commands = '') =>
  change(`${user} is ${role} now`, async () =>
    call('POST', '/users', { user, role, password, ...listed(commandsOf(commands, dictionary.value)) }),
  );
/** Sets the allowed commands; an empty text allows all commands of the role. */
export const setCommands = (user: string, typed: string) =>
  change(`what ${user} may send is changed`, async () => {
    const commands = commandsOf(typed, dictionary.value);
    await call('PATCH', at('/users', user), commands.length > 0 ? { commands } : { all_commands: true });
  });
export const setRole = (user: string, role: string) =>
  change(`${user} is ${role} now`, () => call('PATCH', at('/users', user), { role }));
export const setPassword = (user: string, password: string) =>
  change(`${user} has a new password`, () => call('PATCH', at('/users', user), { password }));
export const setOwnPassword = (user: string, current: string, password: string) =>
  change('your password is changed', () => call('PATCH', at('/users', user), { current_password: current, password }));
export const removeUser = (user: string) => change(`${user} is removed`, () => call('DELETE', at('/users', user)));
export const addToken = (name: string, role: string, commands = '') =>
  change(`the token ${name} is made`, async () => {
    const made = await call<{ token: string }>('POST', '/tokens', {
      name,
      role,
      ...listed(commandsOf(commands, dictionary.value)),
    });
    newToken.value = { name, token: made.token };
  });
export const removeToken = (name: string) =>
  change(`the token ${name} is void`, () => call('DELETE', at('/tokens', name)));
