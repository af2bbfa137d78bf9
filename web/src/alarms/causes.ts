// SPDX-License-Identifier: Apache-2.0
// Alarms that belong together are one line: the cause with its consequences where the ground says what the cause is,
// else only what they have in common. No cause is guessed.
import { isWorst } from '../run/limits';
import { fromEntry } from '../run/time';
import type { AlarmState } from './model';

export interface Group {
  key: string;
  /** What they have in common, in words; undefined: an alarm by itself. */
  words: string | undefined;
  /** The alarm that the ground names as the cause; it is the first of `alarms`. */
  cause: AlarmState | undefined;
  alarms: AlarmState[];
}

const SAME_MOMENT_S = 2; // chosen: samples of one packet are judged together, at most two intervals apart

const stands = (alarm: AlarmState) => alarm.severity !== 'none' && alarm.severity !== '';
const named = (count: number, what: string) => `${count} ${what}${count === 1 ? '' : 's'}`;

/** The alarms of a list as lines, each where its first alarm was. Shelved ones and those that are over stay by themselves. */
export function grouped(
  all: readonly AlarmState[],
  packetOf: (channel: string) => string | undefined,
  entry_sclk: number,
): Group[] {
  const open = all.filter((alarm) => stands(alarm) && alarm.state !== 'shelved');
  const groups = new Map<AlarmState, Group>();
  const group = (key: string, words: string, alarms: AlarmState[], cause?: AlarmState) => {
    const free = alarms.filter((alarm) => !groups.has(alarm));
    if (free.length < 2) return;
    const made = { key, words, cause, alarms: free };
    for (const alarm of free) groups.set(alarm, made);
  };
  const stale = open.filter(({ kind }) => kind === 'staleness');
  for (const reason of new Set(stale.map((alarm) => alarm.reason ?? ''))) {
    const packets = stale.filter((alarm) => (alarm.reason ?? '') === reason);
    const cause = open.find((alarm) => alarm.kind === 'link' && alarm.name === packets[0]?.cause);
    const count = named(packets.length, 'packet');
    if (cause) group(`link ${cause.name}`, `${cause.name} is lost; ${count} stale for it`, [cause, ...packets], cause);
    else group(`stale ${reason}`, `${count} stale: ${reason || 'no reason is known'}`, packets);
  }
  const limits = open.filter(({ kind, sclk }) => kind === 'limit' && sclk !== undefined);
  for (const first of [...limits].sort((one, other) => (one.sclk as number) - (other.sclk as number))) {
    const packet = packetOf(first.name);
    if (packet === undefined || groups.has(first)) continue;
    const since = first.sclk as number;
    const together = limits.filter(
      (alarm) => packetOf(alarm.name) === packet && Math.abs((alarm.sclk as number) - since) <= SAME_MOMENT_S,
    );
    const words = `${named(together.length, 'channel')} of ${packet} since ${fromEntry(since - entry_sclk)}`;
    group(`${packet} ${since}`, words, together);
  }
  const seen = new Set<Group>();
  return all.flatMap((alarm) => {
    const its = groups.get(alarm) ?? { key: alarm.name, words: undefined, cause: undefined, alarms: [alarm] };
    if (seen.has(its)) return [];
    seen.add(its);
    return [its];
  });
}

/** The alarm by which a group is marked: the first of the worst kind. */
export const worstOf = ({ alarms }: Group): AlarmState =>
  alarms.find((alarm) => isWorst(alarm.severity)) ?? (alarms[0] as AlarmState);
