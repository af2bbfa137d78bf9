// The table of channels: value, unit, age, alarm and stale state.
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import type { Status } from '../design/status';
import { LAYOUT } from '../layout';
import type { Dictionary } from '../run/dictionary';
import { valueText } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { duration } from '../run/time';

export type ChannelLook = Extract<Status, 'good' | 'caution' | 'alarm' | 'stale' | 'never'>;

export interface ChannelRow {
  id: number;
  name: string;
  alias: string;
  text: string;
  value: string;
  unit: string;
  age: string;
  look: ChannelLook;
  limits: string;
  recorded: boolean;
}

const ALARMS = new Set(['critical', 'severe', 'distress']);
const STALE_PERIODS = 3; // ours: three missed samples
const STALE_LEAST_S = 3;
export const ROWS_SHOWN = 300;

/** Rows that match every word of `filter`, the picks of the layout first. `total` counts all that match. */
export function channelRows(
  store: RunStore | undefined, dictionary: Dictionary, filter: string, cutoff: number,
): { rows: ChannelRow[]; total: number } {
  const words = filter.toLowerCase().split(/\s+/).filter((word) => word !== '');
  const matching = dictionary.channels.filter((channel) => {
    const all = `${channel.name} ${channel.alias} ${channel.packet} ${channel.unit}`.toLowerCase();
    return words.every((word) => all.includes(word));
  });
  const rank = new Map(LAYOUT.channels.map((name, index) => [name as string, index]));
  matching.sort((a, b) => (rank.get(a.name) ?? 1000 + a.id) - (rank.get(b.name) ?? 1000 + b.id));
  return { rows: matching.slice(0, ROWS_SHOWN).map((channel) => rowOf(store, channel, cutoff)), total: matching.length };
}

function rowOf(store: RunStore | undefined, channel: DictionaryChannel, cutoff: number): ChannelRow {
  const sample = store?.latest(channel.id, cutoff);
  const age = sample && store ? Math.max(0, Math.min(store.seenSclk, cutoff) - sample.sclk) : undefined;
  return {
    id: channel.id, name: channel.name, alias: channel.alias, text: channel.text, unit: channel.unit,
    value: valueText(channel, sample?.value), age: age === undefined ? '' : age < 0.05 ? 'now' : duration(age),
    look: lookOf(store, channel, sample?.value, age, cutoff), limits: limitsText(channel),
    recorded: sample?.recorded ?? false,
  };
}

function lookOf(
  store: RunStore | undefined, channel: DictionaryChannel, value: number | undefined, age: number | undefined, cutoff: number,
): ChannelLook {
  if (value === undefined || age === undefined) return 'never';
  // In a past view the alarms of now do not apply: the limits are asked again.
  const severity = cutoff === Infinity ? store?.alarms.get(channel.id)?.severity : outside(channel, value);
  if (severity !== undefined) return ALARMS.has(severity) ? 'alarm' : 'caution';
  const period = channel.expectedRateHz > 0 ? 1 / channel.expectedRateHz : 1;
  if (store?.going && age > Math.max(STALE_LEAST_S, STALE_PERIODS * period)) return 'stale';
  return 'good';
}

function outside(channel: DictionaryChannel, value: number): string | undefined {
  return channel.limits.findLast((limit) =>
    (limit.below !== undefined && value < limit.below) || (limit.above !== undefined && value > limit.above))?.severity;
}

export function limitsText(channel: DictionaryChannel): string {
  return channel.limits.map((limit) => {
    const parts: string[] = [];
    if (limit.below !== undefined) parts.push(`< ${limit.below}`);
    if (limit.above !== undefined) parts.push(`> ${limit.above}`);
    return `${limit.severity} ${parts.join(' or ')}`;
  }).join('; ');
}
