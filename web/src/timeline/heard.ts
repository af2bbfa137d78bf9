// SPDX-License-Identifier: Apache-2.0
// The knowledge of each timepoint from all sources. Prediction, waiting, phases, guide, counts and details all use this
// one function. Where UHF is silent, tones report.
import type { Explanation } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { RunStore } from '../run/store';
import type { NamedFiring } from '../stream/names';

/** Times in SCLK. */
export interface Heard {
  by: 'uhf' | 'recording' | 'tone';
  /** For a tone: its beginning, since it is requested when the timepoint is triggered. */
  triggered_sclk: number;
  fired_sclk: number;
  /** Of the tone, where it is known by one. */
  posterior?: number;
  /** Flight's verdict; '' for a tone, which reports only the triggering. */
  verdict: NamedFiring['verdict'] | '';
}

let last:
  | {
      store: RunStore;
      version: number;
      plan: readonly TimepointRow[];
      cutoff: number;
      heard: ReadonlyMap<number, Heard>;
    }
  | undefined;

/**
 * The known timepoints by number: from UHF and recording, else from a tone that only one timepoint requests. The result
 * is kept, since six views ask at each tick.
 */
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
  const first = new Map<string, { sclk: number; likelihood: number }>();
  for (const { fact } of store.tonesBy(cutoff))
    if (fact.tone !== undefined && !first.has(fact.name)) first.set(fact.name, fact);
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
    if (began && !heard.has(row.id))
      heard.set(row.id, {
        by: 'tone',
        triggered_sclk: began.sclk,
        fired_sclk: began.sclk,
        posterior: began.likelihood,
        verdict: '',
      });
  }
  return heard;
}

/**
 * Index in the plan of the last known timepoint, -1 before the first. The timeline goes in order, so all before it have
 * passed.
 */
export function lastHeard(plan: readonly TimepointRow[], heard: ReadonlyMap<number, Heard>): number {
  return plan.findLastIndex((row) => heard.has(row.id));
}

/**
 * Whether an explanation is about this timepoint alone. Flight names a decision by the timepoint, by the anchor whose
 * finding triggers it, or as "timepoint" with its name, in words, in the text.
 */
export function speaksOf({ decision, text }: Explanation, row: TimepointRow): boolean {
  if (decision === 'timepoint')
    return text.toLowerCase().startsWith(`timepoint ${row.name.replaceAll('_', ' ')} `.toLowerCase());
  return decision === row.name || (decision !== '' && decision === row.anchor && row.desiredOffsetS === 0);
}
