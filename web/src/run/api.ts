// SPDX-License-Identifier: Apache-2.0
// HTTP requests that bypass the worker: routes of plain JSON with small answers, and all changes. Nothing is sent
// twice: a failure is reported to the caller, who may ask again.
import { signal } from '@preact/signals';

/**
 * A request without success, with the server's own words and its status. Status 0: no legible answer, so it is not
 * known whether the request was accepted. `answer`: the whole answer, if it is JSON.
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

/**
 * Whether the request may have been carried out all the same: without an answer, or when the server or a proxy failed.
 */
export const isOpen = (error: unknown): boolean =>
  !(error instanceof Refused) || error.status === 0 || error.status >= 500;

/** Counts the answers that demand a log-in. */
export const turnedAway = signal(0);

const ANSWER_WITHIN_MS = 60_000; // chosen: longer than any of these requests may take; the caller is told then

let reads = new AbortController();

/**
 * Aborts reads when the connection is lost. A connection that died silently brings no answer, and a caller that asks
 * every few seconds would wait for it.
 */
export function giveUpReads(): void {
  reads.abort();
  reads = new AbortController();
}

/** Sends a request. `within_ms` of Infinity waits without a limit. */
export async function call<T>(
  method: 'GET' | 'POST' | 'PUT' | 'PATCH' | 'DELETE',
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
  // an answer that is not from our API is quoted as it is
  return (readJson(text) as { error?: string } | null | undefined)?.error ?? text.slice(0, 300);
}

export const wordsFor = (error: unknown): string => (error instanceof Error ? error.message : String(error));
