// SPDX-License-Identifier: Apache-2.0
// Downloads a file that the server makes while it is sent. Progress is reported, and it can be cancelled.
import { Refused, turnedAway, wordsOf } from '../run/api';

const LOOSE_MAX = 16e6; // chosen: octets kept in memory before they go into a blob

/**
 * Downloads the whole file. `told` gets the octets received and the total, if the server gives one. Rejects with the
 * server's words, or as aborted.
 */
export async function download(
  path: string,
  stop: AbortSignal,
  told: (octets: number, of: number | undefined) => void,
): Promise<Blob> {
  const response = await fetch(path, { signal: stop, credentials: 'same-origin', cache: 'no-store' });
  if (!response.ok || !response.body) {
    if (response.status === 401) turnedAway.value += 1;
    throw new Refused(response.status, wordsOf(await response.text()) || `${response.status} ${response.statusText}`);
  }
  const length = Number(response.headers.get('content-length') ?? NaN);
  const of = Number.isFinite(length) && !response.headers.has('content-encoding') ? length : undefined;
  let parts: BlobPart[] = [];
  let octets = 0;
  let loose = 0; // octets of parts held by the page itself; the browser may keep a blob on its disk
  const reader = response.body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    loose += value.byteLength;
    octets += value.byteLength;
    if (loose > LOOSE_MAX) [parts, loose] = [[new Blob(parts)], 0];
    told(octets, of);
  }
  return new Blob(parts, { type: response.headers.get('content-type') ?? '' });
}

/** Saves it in the browser as a file of this name. */
export function save(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000); // chosen: long enough for a disk to store it
}

/** "0.42 MB", "12.4 of 71.0 MB". */
export function sizeWords(octets: number, of: number | undefined): string {
  const mega = (value: number) => (value / 1e6).toFixed(value < 1e6 ? 2 : 1);
  return of === undefined ? `${mega(octets)} MB` : `${mega(octets)} of ${mega(of)} MB`;
}
