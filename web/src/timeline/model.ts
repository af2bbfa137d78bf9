// The lanes of the timeline: what was planned, and how each moment became known.
import { LAYOUT } from '../layout';
import { inWords } from '../run/dictionary';
import type { RunStore } from '../run/store';
import type { TimepointFiring } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';

export interface Mark {
  e_s: number;
  id: number;
  name: string;
  important: boolean;
  /** timed out, failed: shown with another shape */
  bad: boolean;
}
export interface Outage {
  from: number;
  to: number;
  words: string;
}
export interface Lanes {
  plan: Mark[];
  tones: Mark[];
  live: Mark[];
  recorded: Mark[];
  liveOutages: Outage[];
  toneOutages: Outage[];
  relay: number;
}

const GOOD = new Set(['', 'completed', 'replied', 'no_operation', 'fired', 'pending']);

export function isImportant(name: string): boolean {
  return (LAYOUT.labelled as readonly string[]).includes(name);
}

export function lanesOf(store: RunStore, plan: readonly TimepointRow[], cutoff: number): Lanes {
  const lanes: Lanes = {
    plan: [], tones: [], live: [], recorded: [], toneOutages: [], liveOutages: [], relay: store.run.relayProgress,
  };
  const entry = store.entrySclk;
  for (const row of plan) {
    if (row.plannedES !== undefined) lanes.plan.push(markOf(row.id, row.name, row.plannedES, ''));
  }
  for (const [id, pair] of store.firings) {
    if (pair.live && pair.live.firedSclk <= cutoff) {
      lanes.live.push(markOf(id, pair.name, pair.live.firedSclk - entry, pair.live.verdict));
    }
    if (pair.recorded && pair.recorded.firedSclk <= cutoff) {
      lanes.recorded.push(markOf(id, pair.name, pair.recorded.firedSclk - entry, pair.recorded.verdict));
    }
  }
  let before: number | undefined;
  for (const { fact } of store.tones) {
    if (fact.sclk > cutoff) break;
    if (fact.tone !== undefined && fact.tone !== before) {
      lanes.tones.push({
        e_s: fact.sclk - entry, id: fact.tone, name: fact.meaning || fact.name, important: false, bad: false,
      });
    }
    before = fact.tone ?? before;
  }
  const now = Math.min(store.seenSclk, cutoff) - entry;
  lanes.liveOutages = outages(store, 'uhf_live', now, cutoff);
  lanes.toneOutages = outages(store, 'x_band', now, cutoff);
  return lanes;
}

function markOf(id: number, name: string, e_s: number, verdict: string): Mark {
  return { id, name, e_s, important: isImportant(name), bad: !GOOD.has(verdict) };
}

/** When a link was silent, and why, as the link itself said. Silence is never drawn as nothing. */
export function outages(store: RunStore, link: string, now_e_s: number, cutoff: number): Outage[] {
  const all: Outage[] = [];
  let open: Outage | undefined;
  for (const { fact } of store.links.get(link) ?? []) {
    const sclk = store.sclkSeenAt(fact.ert);
    if (!Number.isFinite(sclk) || sclk > cutoff) continue;
    const e_s = sclk - store.entrySclk;
    if (!fact.up && !open) open = { from: e_s, to: now_e_s, words: fact.reason || 'silent' };
    else if (!fact.up && open) {
      open.to = e_s;
      all.push(open);
      open = { from: e_s, to: now_e_s, words: fact.reason || 'silent' };
    } else if (fact.up && open) {
      open.to = e_s;
      all.push(open);
      open = undefined;
    }
  }
  if (open) all.push({ ...open, to: Math.max(open.from, now_e_s) });
  return all;
}

/** "plasma outage, as predicted" → "plasma outage": what there is room for. */
export function shortReason(words: string): string {
  return words.split(/[,:;(]/)[0]?.trim() ?? words;
}

export function firedCount(store: RunStore, cutoff: number): number {
  return [...store.firings.values()].filter(({ live, recorded }) => ((live ?? recorded)?.firedSclk ?? Infinity) <= cutoff && (live ?? recorded)).length;
}

export type PointState = 'fired' | 'timed out' | 'waiting for reply' | 'next' | 'pending' | 'undefined';

export interface PointDetail {
  row: TimepointRow;
  state: PointState;
  firedLive_e_s: number | undefined;
  firedRecorded_e_s: number | undefined;
  triggered_e_s: number | undefined;
  why: string | undefined;
}

/** Why a timepoint fired or has not. */
export function pointDetail(store: RunStore, plan: readonly TimepointRow[], id: number, cutoff: number): PointDetail | undefined {
  const row = plan.find((candidate) => candidate.id === id);
  if (!row) return undefined;
  const pair = store.firings.get(id);
  const live = pair?.live && pair.live.firedSclk <= cutoff ? pair.live : undefined;
  const recorded = pair?.recorded && pair.recorded.firedSclk <= cutoff ? pair.recorded : undefined;
  const known = live ?? recorded;
  const next = nextTimepoint(store, plan, cutoff);
  const anchored = row.anchor !== '' && row.plannedES === undefined;
  const why = store.explanations.findLast(
    ({ fact }) => fact.sclk <= cutoff && known !== undefined && Math.abs(fact.sclk - known.triggeredSclk) <= 1 / 32 &&
      fact.conditions.length > 0);
  return {
    row,
    state: known ? (GOOD.has(known.verdict) ? 'fired' : 'timed out') : next?.id === id ? 'next' : anchored ? 'undefined' : 'pending',
    firedLive_e_s: live && live.firedSclk - store.entrySclk,
    firedRecorded_e_s: recorded && recorded.firedSclk - store.entrySclk,
    triggered_e_s: known && known.triggeredSclk - store.entrySclk,
    why: why?.fact.text,
  };
}

/** The first timepoint, in the order of the timeline, after the last one known to have fired. */
export function nextTimepoint(store: RunStore, plan: readonly TimepointRow[], cutoff: number): TimepointRow | undefined {
  const firedBy = (firing: TimepointFiring | undefined) => firing !== undefined && firing.firedSclk <= cutoff;
  const last = plan.findLastIndex((row) => {
    const pair = store.firings.get(row.id);
    return firedBy(pair?.live) || firedBy(pair?.recorded);
  });
  return plan[last + 1];
}

export const title = inWords;
