// SPDX-License-Identifier: Apache-2.0
// Limits by the ground's rule: those of the context in force, else those without a context. A context is a state of
// EDL.
import { LAYOUT } from '../layout';
import type { AlarmLimit, DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import type { Dictionary } from './dictionary';
import type { RunStore } from './store';

const WORST: ReadonlySet<string> = new Set(['distress', 'critical', 'severe']);

/** Whether a severity has the colour of alarms; lower ones have that of caution. */
export const isWorst = (severity: string): boolean => WORST.has(severity);

/** The name of the state of EDL at `sclk`; undefined while unknown. */
export function contextAt(run: RunStore | undefined, words: Dictionary | undefined, sclk: number): string | undefined {
  const phase = words?.pick(LAYOUT.phase);
  const value = phase && run?.latest(phase.id, sclk)?.value;
  return value === undefined ? undefined : words?.label(phase as DictionaryChannel, value);
}

export function limitsIn(channel: DictionaryChannel, context: string | undefined): AlarmLimit[] {
  const own = channel.limits.filter((limit) => limit.context !== '' && limit.context === context);
  return own.length > 0 ? own : channel.limits.filter((limit) => limit.context === '');
}

export interface Stretch {
  from_sclk: number;
  to_sclk: number;
  context: string | undefined;
  limits: AlarmLimit[];
}

/** The limits in force over [from, to], as stretches. */
export function limitsOver(
  run: RunStore,
  words: Dictionary,
  channel: DictionaryChannel,
  from_sclk: number,
  to_sclk: number,
): Stretch[] {
  if (channel.limits.length === 0 || !(from_sclk < to_sclk)) return [];
  const all: Stretch[] = [];
  for (const at of channel.limits.some((limit) => limit.context !== '')
    ? changesOfContext(run, words, from_sclk, to_sclk)
    : [from_sclk]) {
    const context = contextAt(run, words, at);
    const limits = limitsIn(channel, context);
    const last = all.at(-1);
    if (last && last.limits[0] === limits[0]) continue; // another state with the same limits
    if (last) last.to_sclk = at;
    all.push({ from_sclk: at, to_sclk, context, limits });
  }
  return all.filter((stretch) => stretch.limits.length > 0);
}

/** `from`, and each later SCLK at which the state of EDL changed. */
function changesOfContext(run: RunStore, words: Dictionary, from_sclk: number, to_sclk: number): number[] {
  const phase = words.pick(LAYOUT.phase);
  const changes = new Set([from_sclk]);
  for (const series of phase ? [run.live.get(phase.id), run.recorded.get(phase.id)] : []) {
    if (!series) continue;
    for (
      let i = Math.max(1, series.firstAfter(from_sclk));
      i < series.length && (series.sclk[i] as number) < to_sclk;
      ++i
    ) {
      if (series.value[i] !== series.value[i - 1]) changes.add(series.sclk[i] as number);
    }
  }
  return [...changes].sort((one, other) => one - other);
}

/** "watch > 7; critical < −3 or > 2", in the order of the dictionary. */
export function limitsText(limits: readonly AlarmLimit[]): string {
  return limits.map((limit) => `${limit.severity} ${boundsText(limit)}`).join('; ');
}

function boundsText(limit: AlarmLimit): string {
  const parts: string[] = [];
  if (limit.below !== undefined) parts.push(`< ${limit.below}`);
  if (limit.above !== undefined) parts.push(`> ${limit.above}`);
  return parts.join(' or ');
}

/** All limits of a channel, each context with its name. */
export function allLimitsText(channel: DictionaryChannel): string {
  const contexts = [...new Set(channel.limits.map((limit) => limit.context))];
  return contexts
    .map((context) => {
      const words = limitsText(channel.limits.filter((limit) => limit.context === context));
      return contexts.length === 1 && context === ''
        ? words
        : `${context === '' ? 'else' : `in ${context.replaceAll('_', ' ')}`}: ${words}`;
    })
    .join('\n');
}
