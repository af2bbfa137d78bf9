// SPDX-License-Identifier: Apache-2.0
// Asks what the worker does not: routes of plain JSON with small answers, and everything that changes something over HTTP.
// Nothing is ever sent twice: what failed is said to whoever asked, and asking again is theirs.
import { signal } from '@preact/signals';

/**
 * The server's own words for why not, with the status that it gave; 0: no answer came, or none that can be read, so whether it was taken is not known.
 * `answer`: all that it said, where that is JSON.
 */
export class Refused extends Error {
  constructor(
    readonly status: number,
    words: string,
    readonly answer?: unknown,
  ) {
    super(words);
  }
}

/** Whether it may have been done all the same: without an answer, and where the server, or what stands before it, failed in the middle. */
export const isOpen = (error: unknown): boolean =>
  !(error instanceof Refused) || error.status === 0 || error.status >= 500;

/** Counts answers that say: log in. */
export const turnedAway = signal(0);

const ANSWER_WITHIN_MS = 60_000; // ours: longer than any of these questions may take; whoever waits is told then

let reads = new AbortController();

/** Once the connection is lost: over one that died without a word no answer comes, and whoever asks again each few seconds would wait for it. */
export function giveUpReads(): void {
  reads.abort();
  reads = new AbortController();
}

/** `within_ms`: Infinity for what takes as long as it takes. */
export async function call<T>(
  method: 'GET' | 'POST' | 'PATCH' | 'DELETE',
  path: string,
  body?: object,
  within_ms = ANSWER_WITHIN_MS,
): Promise<T> {
  const lost = (what: string) => new Refused(0, method === 'GET' ? what : `${what}: whether it was taken is not known`);
  let response: Response;
  let text: string;
  try {
    response = await fetch(`/api/v1${path}`, {
      method,
      credentials: 'same-origin',
      cache: 'no-store',
      ...(body && { headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) }),
      ...(Number.isFinite(within_ms) && {
        signal: AbortSignal.any([AbortSignal.timeout(within_ms), ...(method === 'GET' ? [reads.signal] : [])]),
      }),
    });
    text = await response.text(); // an answer may break off after its head
  } catch (error) {
    throw lost((error as Error).name === 'TimeoutError' ? `no answer came in ${within_ms / 1000} s` : 'no answer came');
  }
  if (response.ok) {
    try {
      return (text === '' ? undefined : JSON.parse(text)) as T;
    } catch {
      throw lost('the answer cannot be read');
    }
  }
  if (response.status === 401 && path !== '/session') turnedAway.value += 1;
  throw new Refused(response.status, wordsOf(text) || `${response.status} ${response.statusText}`, readJson(text));
}

function readJson(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}

export function wordsOf(text: string): string {
  return (readJson(text) as { error?: string } | null | undefined)?.error ?? text.slice(0, 300); // what is no answer of our API says what it says
}

export const wordsFor = (error: unknown): string => (error instanceof Error ? error.message : String(error));
