// SPDX-License-Identifier: Apache-2.0
// What is known of each timepoint, whichever way it came. The one answer for prediction, waiting, phases, guide, counts and details: where
// UHF is silent, tones tell.
import type { Explanation } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { RunStore } from '../run/store';

/** Times in SCLK. */
export interface Heard {
  by: 'uhf' | 'recording' | 'tone';
  /** By tone: when the tone began, for it is asked for as the timepoint is triggered. */
  triggered_sclk: number;
  fired_sclk: number;
  /** As flight told it; '' by tone, which says only that it was triggered. */
  verdict: string;
}

export const BELIEVED = 0.5; // ours: a tone that is likelier than all others together

let last:
  | {
      store: RunStore;
      version: number;
      plan: readonly TimepointRow[];
      cutoff: number;
      heard: ReadonlyMap<number, Heard>;
    }
  | undefined;

/** By number of the timepoint: UHF and recording say it, else a tone that only one timepoint asks for. Six views ask at each tick, and are answered once. */
export function heardOf(store: RunStore, plan: readonly TimepointRow[], cutoff: number): ReadonlyMap<number, Heard> {
  const { version } = store;
  if (last?.store !== store || last.version !== version || last.plan !== plan || last.cutoff !== cutoff) {
    last = { store, version, plan, cutoff, heard: hear(store, plan, cutoff) };
  }
  return last.heard;
}

function hear(store: RunStore, plan: readonly TimepointRow[], cutoff: number): Map<number, Heard> {
  const heard = new Map<number, Heard>();
  const asked = new Map<string, number>();
  for (const row of plan) asked.set(row.tone, (asked.get(row.tone) ?? 0) + 1);
  const first = new Map<string, number>();
  for (const { fact } of store.tonesBy(cutoff))
    if (fact.tone !== undefined && fact.likelihood >= BELIEVED && !first.has(fact.name))
      first.set(fact.name, fact.sclk);
  for (const row of plan) {
    const pair = store.firings.get(row.id);
    for (const [by, firing] of [
      ['uhf', pair?.live],
      ['recording', pair?.recorded],
    ] as const) {
      if (!firing || firing.firedSclk > cutoff || heard.has(row.id)) continue;
      heard.set(row.id, {
        by,
        triggered_sclk: firing.triggeredSclk,
        fired_sclk: firing.firedSclk,
        verdict: firing.verdict,
      });
    }
    const began = row.tone !== '' && asked.get(row.tone) === 1 ? first.get(row.tone) : undefined;
    if (began !== undefined && !heard.has(row.id))
      heard.set(row.id, { by: 'tone', triggered_sclk: began, fired_sclk: began, verdict: '' });
  }
  return heard;
}

/** Place in the plan of the last one that was heard of, -1 before the first. The timeline goes in order: all before it are past. */
export function lastHeard(plan: readonly TimepointRow[], heard: ReadonlyMap<number, Heard>): number {
  return plan.findLastIndex((row) => heard.has(row.id));
}

/**
 * Whether an explanation is of this timepoint and of no other: flight names a decision by the timepoint, by the anchor whose finding
 * triggers it, or as "timepoint" with its name in the text.
 */
export function speaksOf({ decision, text }: Explanation, row: TimepointRow): boolean {
  if (decision === 'timepoint') return text.split(' ')[1] === row.name;
  return decision === row.name || (decision !== '' && decision === row.anchor && row.desiredOffsetS === 0);
}
