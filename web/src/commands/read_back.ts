// SPDX-License-Identifier: Apache-2.0
// What the vehicle holds beside what was sent.
import type { Dictionary } from '../run/dictionary';
import type { CommandRow, RunStore } from '../run/store';

interface ReadBackLine {
  name: string;
  sent: string;
  held: number | undefined; // NaN: undefined on board
  equal: boolean | undefined;
}

/**
 * Compares the sent arguments with the vehicle's report of them, one by one. Needs one packet whose channels have the
 * names of all arguments; otherwise undefined. `sclk`: time of the report, which counts only after the command's
 * arrival.
 */
export function readBackOf(
  row: CommandRow,
  dictionary: Dictionary,
  store: RunStore,
  cutoff = Infinity,
): { lines: ReadBackLine[]; sclk: number | undefined } | undefined {
  const sent = row.arguments.split(' ').flatMap((part) => {
    const at = part.indexOf('=');
    return at > 0 ? [{ name: part.slice(0, at), value: part.slice(at + 1) }] : [];
  });
  const channels = sent.map((argument) => dictionary.pick([argument.name]));
  const packet = channels[0]?.packet;
  if (!packet || channels.some((channel) => channel?.packet !== packet)) return undefined;
  const radiated = row.stages.get('radiated')?.at(-1)?.ert_s;
  // its arrival on board
  const since = radiated === undefined ? Infinity : store.sclkSeenAt(radiated) + 2 * store.run.lightTimeS;
  const samples = channels.map((channel) => channel && store.latest(channel.id, cutoff));
  const sclk = samples[0]?.sclk;
  const known = sclk !== undefined && sclk > since;
  return {
    sclk: known ? sclk : undefined,
    lines: sent.map(({ name, value }, i) => {
      const held = known ? samples[i]?.value : undefined;
      return { name, sent: value, held, equal: held === undefined ? undefined : held === Number(value) };
    }),
  };
}
