// SPDX-License-Identifier: Apache-2.0
// What the page must know before it shows anything: the mission's words and the runs. Asked as the document asks for them (index.html preloads
// both), and read here, for the worker and its schema still load then.
import type { DictionaryReply, RunList, RunState } from '../gen/aeolis/v1/run_pb';
import { call } from './api';

/** JSON of the API as the schema's types have it: names in camelCase, and as bigint whole numbers of 64 bits, which JSON has as text under the names `whole`. */
export function typed(json: unknown, whole: ReadonlySet<string>): unknown {
  if (Array.isArray(json)) return json.map((each) => typed(each, whole));
  if (typeof json !== 'object' || json === null) return json;
  const made: Record<string, unknown> = {};
  for (const [name, value] of Object.entries(json)) {
    made[typedName(name)] = typeof value === 'string' ? (whole.has(name) ? BigInt(value) : value) : typed(value, whole);
  }
  return made;
}

const typedNames = new Map<string, string>(); // a dictionary has few names, thousands of times; someone waits for a picture meanwhile

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

export const isGoing = (run: RunState) => ['waiting', 'running', 'paused'].includes(run.state);

/** The newest first. */
export async function askRuns(): Promise<RunState[]> {
  const { runs } = typed(await call('GET', '/runs'), new Set(['run', 'seed', 'last_seq'])) as RunList;
  return runs.sort((a, b) => Number(b.run - a.run));
}
