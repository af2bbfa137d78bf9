// SPDX-License-Identifier: Apache-2.0
// Forks, forecasts and differences of runs, as the server tells of them (schema/aeolis/v1/what_if.proto).
import { fromEntry } from '../run/time';
import type { Fault } from './instructor';

export interface EventDifference {
  name: string;
  occurrence: number;
  e_s?: number;
  other_e_s?: number;
  text?: string;
  other_text?: string;
}
export interface ChannelDifference {
  channel: string;
  from_e_s: number;
  samples: string;
  differing: string;
  only_in_one: string;
  largest?: number;
  largest_e_s?: number;
}
export interface Differences {
  part_e_s?: number;
  events?: EventDifference[];
  timepoints?: EventDifference[];
  channels?: ChannelDifference[];
  channels_equal?: number;
  channels_until_e_s?: number;
  run: { outcome: string };
  other: { outcome: string };
}

interface Values {
  count: number;
  least: number | null;
  median: number | null;
  most: number | null;
  interval_99?: { from: number; to: number } | null;
}
export interface Prospect {
  cases: number;
  within_limits: { part: number; of: number; low_99: number; high_99: number };
  outside_limits?: { case: number; outcome: string; reason: string }[];
  [figure: string]: unknown;
}
export interface Forecast {
  run: string;
  forecast: string;
  state: 'queued' | 'flying' | 'ready' | 'failed' | 'cancelled' | 'abandoned';
  reason?: string;
  at_e_s: number;
  request: { cases?: number; commands?: { command: string }[]; faults?: Fault[]; from?: Basis };
  asked: string;
  asked_by?: string;
  done?: string;
  of?: string;
  without?: string;
  within_without?: string;
  with?: string;
  within_with?: string;
  result?: { without: Prospect; with?: Prospect; from: Basis; apart_e_s: number; heard_e_s?: number | null };
}
/** From what cases are flown: the vehicle as it is, or as ground expects it by what it had heard. */
export type Basis = 'truth' | 'telemetry';
export const BASES: Record<Basis, string> = { truth: 'the truth', telemetry: 'what ground heard' };

/** From what the cases of a result began. */
export const basisWords = ({ from, heard_e_s }: NonNullable<Forecast['result']>): string =>
  from === 'truth'
    ? 'from the truth'
    : heard_e_s === undefined || heard_e_s === null
      ? 'from ground’s solution alone: nothing was heard of where it is'
      : `from what ground heard, last at ${fromEntry(heard_e_s, { tenths: true })}`;

/** The time of an event in one run, and that it is not there. */
export const timeIn = (e_s: number | undefined): string =>
  e_s === undefined ? 'not in it' : fromEntry(e_s, { tenths: true });

/** How much later it is in this run than in the other. */
export function laterBy({ e_s, other_e_s }: EventDifference): string {
  if (e_s === undefined || other_e_s === undefined) return '';
  const by = e_s - other_e_s;
  if (Math.abs(by) < 0.005) return 'other words';
  return `${by < 0 ? '−' : '+'}${Math.abs(by).toFixed(2)} s`;
}

export const eventName = ({ name, occurrence }: EventDifference): string =>
  occurrence > 1 ? `${name} (${occurrence})` : name;

/** What a forecast assumes. */
export function assumed({ request }: Pick<Forecast, 'request'>, faultWords: (fault: Fault) => string): string {
  const parts = [...(request.commands ?? []).map((each) => each.command), ...(request.faults ?? []).map(faultWords)];
  return parts.length === 0 ? 'nothing' : parts.join(', ');
}

/** "31 of 32 (84 … 100 %)": a part of cases is an estimate, and its 99 % confidence interval says how good. */
export function partText({ part, of, low_99, high_99 }: Prospect['within_limits']): string {
  const percent = (value: number) => (100 * value).toFixed(0);
  return `${part} of ${of} (${percent(low_99)} … ${percent(high_99)} %)`;
}

/** The figures of a prospect that are shown, with their unit and digits. */
export const FIGURES = [
  { key: 'miss_m', words: 'miss', unit: 'km', scale: 1e-3, digits: 2 },
  { key: 'vertical_mps', words: 'touchdown, vertical', unit: 'm/s', scale: 1, digits: 2 },
  { key: 'horizontal_mps', words: 'touchdown, horizontal', unit: 'm/s', scale: 1, digits: 2 },
  { key: 'propellant_kg', words: 'propellant left', unit: 'kg', scale: 1, digits: 1 },
  { key: 'peak_deceleration_mps2', words: 'peak deceleration', unit: 'm/s²', scale: 1, digits: 0 },
  { key: 'least_timeline_margin_s', words: 'least timeline margin', unit: 's', scale: 1, digits: 1 },
] as const;

/** "12.3 (8.0 … 40.1)": the median, and the least and largest of these cases. */
export function valuesText(values: unknown, { scale, digits }: { scale: number; digits: number }): string {
  const { count, least, median, most } = (values ?? {}) as Partial<Values>;
  if (!count || typeof median !== 'number' || typeof least !== 'number' || typeof most !== 'number') return '—';
  const text = (value: number) => (value * scale).toFixed(digits);
  return `${text(median)} (${text(least)} … ${text(most)})`;
}

export function stateText(forecast: Forecast): string {
  switch (forecast.state) {
    case 'flying': {
      if (!Number(forecast.of)) return 'flies the run again up to there';
      const side = (within: string | undefined, of: string | undefined) => `${within ?? 0} of ${of ?? 0}`;
      const withText = Number(forecast.with) > 0 ? `, with it ${side(forecast.within_with, forecast.with)}` : '';
      return `${forecast.done ?? 0} of ${forecast.of} flown; within limits ${side(forecast.within_without, forecast.without)}${withText}`;
    }
    case 'queued':
      return 'waits for its turn';
    case 'abandoned':
      return 'the server ended before it was ready';
    case 'failed':
      return `✖ ${forecast.reason ?? ''}`;
    default:
      return forecast.state;
  }
}
