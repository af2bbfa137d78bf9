// Asks what the worker does not: routes of plain JSON with small answers, and everything that changes something over HTTP.
// Nothing is ever sent twice: what failed is said to whoever asked, and asking again is theirs.
import { signal } from '@preact/signals';

/** The server's own words for why not, with the status that it gave; 0: no answer came, so whether it was taken is not known. */
export class Refused extends Error {
  constructor(readonly status: number, words: string) {
    super(words);
  }
}

/** Counts answers that say: log in. */
export const turnedAway = signal(0);

export async function call<T>(method: 'GET' | 'POST' | 'PATCH' | 'DELETE', path: string, body?: object): Promise<T> {
  let response: Response;
  try {
    response = await fetch(`/api/v1${path}`, {
      method, credentials: 'same-origin', cache: 'no-store',
      ...(body && { headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) }),
    });
  } catch {
    throw new Refused(0, method === 'GET' ? 'no answer' : 'no answer came: whether it was taken is not known');
  }
  const text = await response.text();
  if (response.ok) return (text === '' ? undefined : JSON.parse(text)) as T;
  if (response.status === 401 && path !== '/session') turnedAway.value += 1;
  throw new Refused(response.status, wordsOf(text) || `${response.status} ${response.statusText}`);
}

export function wordsOf(text: string): string {
  try {
    return (JSON.parse(text) as { error?: string }).error ?? text.slice(0, 300);
  } catch {
    return text.slice(0, 300); // not an answer of our API; its text says what it says
  }
}

export const wordsFor = (error: unknown): string => (error instanceof Error ? error.message : String(error));
