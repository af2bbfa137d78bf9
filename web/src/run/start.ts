// SPDX-License-Identifier: Apache-2.0
// The data that the page needs before it shows anything: dictionary and runs. The document requests them (index.html
// preloads both). They are parsed here, because the worker and its schema are still loading.
import type { DictionaryReply } from '../gen/aeolis/v1/run_pb';
import type { NamedRun } from '../stream/names';
import { call } from './api';

/**
 * Converts the API's JSON to the schema's types: camelCase names, and bigint for 64-bit integers, which are texts in
 * JSON under the names `whole`.
 */
export function typed(json: unknown, whole: ReadonlySet<string>): unknown {
  if (Array.isArray(json)) return json.map((each) => typed(each, whole));
  if (typeof json !== 'object' || json === null) return json;
  const made: Record<string, unknown> = {};
  for (const [name, value] of Object.entries(json)) {
    made[typedName(name)] = typeof value === 'string' ? (whole.has(name) ? BigInt(value) : value) : typed(value, whole);
  }
  return made;
}

// a dictionary repeats a few names thousands of times, and this runs before the first picture
const typedNames = new Map<string, string>();

function typedName(name: string): string {
  let found = typedNames.get(name);
  if (found === undefined) {
    found = name.replace(/_(\w)/g, (_, letter: string) => letter.toUpperCase());
    typedNames.set(name, found);
  }
  return found;
}

export const askDictionary = async (): Promise<DictionaryReply> =>
  typed(await call('GET', '/dictionary'), new Set(['value'])) as DictionaryReply;

export const isGoing = (run: NamedRun) => run.state === 'running' || run.state === 'paused';

const WHOLE_OF_RUNS = ['run', 'seed', 'last_seq', 'scet_us', 'ert_us', 'latest_useful_us'];

/** Asks for the runs, newest first. */
export async function askRuns(): Promise<NamedRun[]> {
  const { runs } = typed(await call('GET', '/runs'), new Set(WHOLE_OF_RUNS)) as { runs: NamedRun[] };
  return runs.sort((a, b) => Number(b.run - a.run));
}
