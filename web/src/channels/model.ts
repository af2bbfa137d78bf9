// SPDX-License-Identifier: Apache-2.0
// The table of channels: value, unit, age, alarm and stale state.
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { STATUS } from '../design/status';
import type { Status } from '../design/status';
import { LAYOUT } from '../layout';
import type { Dictionary } from '../run/dictionary';
import { valueText } from '../run/dictionary';
import { allLimitsText, isWorst, limitsAt, limitsText } from '../run/limits';
import type { RunStore, Sample } from '../run/store';
import { wasStale } from '../run/staleness';
import { duration } from '../run/time';
import { whoseAt } from '../run/whose';

type ChannelLook = Extract<Status, 'good' | 'caution' | 'alarm' | 'stale' | 'unasked' | 'never'>;

interface ChannelRow {
  id: number;
  name: string;
  alias: string;
  text: string;
  /** The part of the vehicle that the value belongs to, after the vehicle has become two. */
  whose: string | undefined;
  value: string;
  unit: string;
  age: string;
  /** What is to be said of the time of the sample; empty: nothing. */
  timed: string;
  look: ChannelLook;
  /** Limits in force now; `allLimits`: those of every context. */
  limits: string;
  allLimits: string;
  recorded: boolean;
}

const ROWS_SHOWN = 300;

/**
 * Channels that match every word of `filter`, up to ROWS_SHOWN, the layout's picks first. `total` counts all matches.
 */
export function channelsShown(
  dictionary: Dictionary,
  filter: string,
): { channels: DictionaryChannel[]; total: number } {
  const words = filter
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== '');
  const matching = dictionary.channels.filter((channel) => {
    const all = `${channel.name} ${channel.alias} ${channel.packet} ${channel.unit}`.toLowerCase();
    return words.every((word) => all.includes(word));
  });
  const rank = new Map(LAYOUT.channels.map((name, index) => [name as string, index]));
  matching.sort((a, b) => (rank.get(a.name) ?? 1000 + a.id) - (rank.get(b.name) ?? 1000 + b.id));
  return { channels: matching.slice(0, ROWS_SHOWN), total: matching.length };
}

/** The row of one channel. `lost`: there is no connection, so the clocks and ages stand still. */
export function channelRow(
  store: RunStore | undefined,
  channel: DictionaryChannel,
  cutoff: number,
  lost = false,
): ChannelRow {
  const sample = store?.latest(channel.id, cutoff);
  const age = sample && store ? ageOf(store, sample, cutoff) : undefined;
  const limits = limitsAt(channel, cutoff)?.limits;
  return {
    id: channel.id,
    name: channel.name,
    alias: channel.alias,
    text: channel.text,
    unit: channel.unit,
    whose: whoseAt(store, channel.name, sample?.sclk ?? -Infinity),
    value: valueText(channel, sample?.value, sample?.text),
    age: age === undefined ? '' : age < 0.05 ? 'now' : duration(age),
    timed: sample?.byReception ? 'its packets hold no time: samples stand at their reception' : '',
    look: lookOf(store, channel, sample, cutoff, lost),
    limits: limits ? limitsText(limits) : 'not known yet',
    allLimits: allLimitsText(channel),
    recorded: sample?.recorded ?? false,
  };
}

function lookOf(
  store: RunStore | undefined,
  channel: DictionaryChannel,
  sample: Sample | undefined,
  cutoff: number,
  lost: boolean,
): ChannelLook {
  if (!sample || !store) return store && !store.askedFor.has(channel.name) ? 'unasked' : 'never';
  const severity = store.alarmAt(channel.id, cutoff)?.severity;
  if (severity !== undefined) return isWorst(severity) ? 'alarm' : 'caution';
  return isStale(store, channel, sample, cutoff, lost) ? 'stale' : 'good';
}

/** By the vehicle's clock, or where that is not known to Earth by reception. */
const ageOf = (store: RunStore, sample: Sample, cutoff: number): number =>
  Math.max(
    0,
    sample.ert_s === undefined ? Math.min(store.seenSclk, cutoff) - sample.sclk : store.ertNow_s - sample.ert_s,
  );

/**
 * As the ground says, packet by packet: of live values as they came, of recorded ones by all that has come. Nothing is
 * of now without a connection, nor after the end of a run.
 */
function isStale(store: RunStore, channel: DictionaryChannel, sample: Sample, cutoff: number, lost: boolean): boolean {
  if (cutoff === Infinity && (lost || !store.going)) return true;
  if (!sample.recorded) return store.isStale(channel.packet, cutoff);
  return wasStale(channel.packet, Math.min(store.seenSclk, cutoff), sample.sclk);
}

/** "◌ 41 s": the age of a channel's last sample if it is stale. All figures use this, as the table does. */
export function staleWords(
  store: RunStore | undefined,
  channel: DictionaryChannel | undefined,
  cutoff: number,
  lost: boolean,
): string | undefined {
  const sample = channel && store?.latest(channel.id, cutoff);
  if (!sample || !store) return undefined;
  const age = ageOf(store, sample, cutoff);
  return isStale(store, channel, sample, cutoff, lost)
    ? `${STATUS.stale.shape} ${age < 60 ? `${age.toFixed(0)} s` : duration(age)}`
    : undefined;
}
