// SPDX-License-Identifier: Apache-2.0
// The lanes of the timeline: the plan, and each way in which a moment became known.
import { LAYOUT } from '../layout';
import { inWords } from '../run/dictionary';
import type { RunStore } from '../run/store';
import type { Dictionary } from '../run/dictionary';
import type { Explanation } from '../gen/aeolis/v1/items_pb';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { NamedLink } from '../stream/names';
import { isAmiss } from '../situation/model';
import { newsOf, shortWords } from '../situation/news';
import { heardOf, lastHeard, speaksOf } from './heard';
import type { Heard } from './heard';

/** The server's; times in seconds from entry. */
export interface Prediction {
  id: number;
  name: string;
  /** For a fired timepoint: as predicted before its anchor was heard of. */
  e_s: number;
  fired: boolean;
  /** By the flights of ground's plan; left out: by the timeline's rule. */
  flights?: number;
  /** The times between which it lies in 99 of 100 landings. */
  within?: { from_e_s: number; to_e_s: number };
  /** Whether word of it is late; left out: after 5 s. */
  overdue?: boolean;
}
/** A timepoint that a command would move. */
export interface Moved {
  id: number;
  name: string;
  from_e_s: number;
  to_e_s: number;
}

export interface Mark {
  e_s: number;
  id: number;
  name: string;
  important: boolean;
  /** Whether it was refused or is unverified, which has another shape. */
  bad: boolean;
}
export interface Outage {
  from: number;
  to: number;
  words: string;
  /** The ground's class of it, and whether it is one that nothing explains. */
  silence: NamedLink['silence'];
  lost: boolean;
}
export interface Lanes {
  plan: Mark[];
  tones: Mark[];
  live: Mark[];
  recorded: Mark[];
  /** Timepoints known by a tone only, for the lane of tones. */
  heardByTone: Mark[];
  /** Features of the flight that the carrier's Doppler shows, and when ground had recognised each. */
  doppler: { e_s: number; told_e_s: number; text: string }[];
  /** What went amiss on board, as the banner told it: since when, in short words, and whether it is danger. */
  amiss: { e_s: number; words: string; danger: boolean }[];
  liveOutages: Outage[];
  toneOutages: Outage[];
  relay: number;
}

const GOOD = new Set(['', 'completed', 'verified', 'no_operation', 'fired', 'pending']);

export function isImportant(name: string): boolean {
  return (LAYOUT.labelled as readonly string[]).includes(name);
}

export function lanesOf(store: RunStore, plan: readonly TimepointRow[], cutoff: number): Lanes {
  const lanes: Lanes = {
    plan: [],
    tones: [],
    live: [],
    recorded: [],
    heardByTone: [],
    doppler: featuresSeen(store, cutoff),
    amiss: amissOnBoard(store, cutoff),
    toneOutages: [],
    liveOutages: [],
    relay: store.run.relayProgress,
  };
  const entry = store.entrySclk;
  for (const row of plan) {
    const heard = heardOf(store, plan, cutoff).get(row.id);
    if (heard?.by === 'tone') lanes.heardByTone.push(markOf(row.id, row.name, heard.triggered_sclk - entry, ''));
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
  for (const { fact } of store.tonesBy(cutoff)) {
    if (fact.tone !== undefined && fact.tone !== before) {
      lanes.tones.push({
        e_s: fact.sclk - entry,
        id: fact.tone,
        name: fact.meaning || fact.name,
        important: false,
        bad: false,
      });
    }
    before = fact.tone ?? before;
  }
  const now = Math.min(store.seenSclk, cutoff) - entry;
  lanes.liveOutages = liveOutages(store, now, cutoff);
  lanes.toneOutages = outages(store, 'x_band', now, cutoff);
  return lanes;
}

/** Without what was lost of the links, which their lanes show, and what the table of commands or the alarms show. */
function amissOnBoard(store: RunStore, cutoff: number): Lanes['amiss'] {
  const isElsewhere = (subject: string) =>
    ['station', 'vehicle'].includes(subject) || store.links.has(subject) || /^(loss of|command|channel) /.test(subject);
  return newsOf(store)
    .filter((news) => isAmiss(news) && !isElsewhere(news.subject) && store.knownBy(news.ert_s, cutoff))
    .flatMap(({ since_s, sentence, rank }) => {
      const e_s = store.sclkSeenAt(since_s) - store.entrySclk;
      return Number.isNaN(e_s) ? [] : [{ e_s, words: shortWords(sentence), danger: rank === 'danger' }];
    });
}

/** The features that the Doppler has shown by `cutoff`, oldest first. */
export function featuresSeen(store: RunStore, cutoff: number): Lanes['doppler'] {
  return store.events
    .filter(
      ({ fact, ert_s }) =>
        fact.name === LAYOUT.seenByDoppler &&
        fact.sclk <= cutoff &&
        (cutoff === Infinity || store.knownBy(ert_s, cutoff)),
    )
    .map(({ fact, ert_s }) => ({
      e_s: fact.sclk - store.entrySclk,
      told_e_s: store.sclkSeenAt(ert_s) - store.entrySclk,
      text: fact.text,
    }));
}

function markOf(id: number, name: string, e_s: number, verdict: string): Mark {
  return { id, name, e_s, important: isImportant(name), bad: !GOOD.has(verdict) };
}

/** The silences of a link with their reasons, as the link reported them. A silence is always drawn. */
export function outages(store: RunStore, link: string, now_e_s: number, cutoff: number): Outage[] {
  const all: Outage[] = [];
  let open: Outage | undefined;
  const begun = (e_s: number, { reason, silence, lost }: NamedLink): Outage => ({
    from: e_s,
    to: now_e_s,
    words: reason || 'silent',
    silence,
    lost,
  });
  for (const { fact, ert_s } of store.links.get(link) ?? []) {
    const sclk = store.sclkSeenAt(ert_s);
    if (!Number.isFinite(sclk) || sclk > cutoff) continue;
    const e_s = sclk - store.entrySclk;
    if (!fact.up && !open) open = begun(e_s, fact);
    else if (!fact.up && open) {
      open.to = e_s;
      all.push(open);
      open = begun(e_s, fact);
    } else if (fact.up && open) {
      open.to = e_s;
      all.push(open);
      open = undefined;
    }
  }
  if (open) all.push({ ...open, to: Math.max(open.from, now_e_s) });
  return all;
}

export const LIVE_LINKS = ['uhf_live', 'x_band_telemetry'] as const;

/**
 * The silences of live telemetry, which X-band brings in cruise and UHF from then on: those that both links share, with
 * the reason of the one that the plan has on.
 */
export function liveOutages(store: RunStore, now_e_s: number, cutoff: number): Outage[] {
  const [uhf, xBand] = LIVE_LINKS.map((link) => outages(store, link, now_e_s, cutoff)) as [Outage[], Outage[]];
  if (!store.links.has(LIVE_LINKS[1])) return uhf;
  return uhf.flatMap((one) =>
    xBand
      .map((other) => ({
        ...(one.silence === 'not_begun' ? other : one),
        from: Math.max(one.from, other.from),
        to: Math.min(one.to, other.to),
      }))
      .filter((both) => both.to > both.from),
  );
}

/** "plasma outage, as predicted" → "plasma outage": the reason without its details. */
export function shortReason(words: string): string {
  return words.split(/[,:;(]/)[0]?.trim() ?? words;
}

/** The same in one word where room is short: "plasma blackout" is "blackout". */
export const shortestReason = (words: string): string => {
  const short = shortReason(words);
  return /^(no|not) /.test(short) ? short : (short.split(' ').at(-1) ?? short);
};

/** The number of known firings, and how many of them are known by a tone only. */
export function firedCount(
  store: RunStore,
  plan: readonly TimepointRow[],
  cutoff: number,
): { all: number; byTone: number } {
  const heard = [...heardOf(store, plan, cutoff).values()];
  return { all: heard.length, byTone: heard.filter((each) => each.by === 'tone').length };
}

const VERDICTS = {
  completed: 'fired',
  verified: 'fired',
  no_operation: 'fired',
  unverified: 'unverified',
  refused: 'refused',
} as const;

/** "passed": nothing reported it, and a later timepoint has fired. */
type PointState =
  | (typeof VERDICTS)[keyof typeof VERDICTS]
  | 'passed'
  | 'waiting for reply'
  | 'next'
  | 'pending'
  | 'undefined';

interface PointDetail {
  row: TimepointRow;
  state: PointState;
  /** For a fired timepoint: how it became known, and flight's verdict. */
  by: Heard['by'] | undefined;
  verdict: string;
  firedLive_e_s: number | undefined;
  firedRecorded_e_s: number | undefined;
  tone_e_s: number | undefined;
  posterior: number | undefined;
  triggered_e_s: number | undefined;
  /** Flight's newest explanation of it: why it fired, or what holds it. */
  why: Explanation | undefined;
}

/** State and evidence of a timepoint. */
export function pointDetail(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  id: number,
  cutoff: number,
): PointDetail | undefined {
  const row = plan.find((candidate) => candidate.id === id);
  if (!row) return undefined;
  const pair = store.firings.get(id);
  const live = pair?.live && pair.live.firedSclk <= cutoff ? pair.live : undefined;
  const recorded = pair?.recorded && pair.recorded.firedSclk <= cutoff ? pair.recorded : undefined;
  const heard = heardOf(store, plan, cutoff);
  const known = heard.get(id);
  const e_s = (sclk: number | undefined) => (sclk === undefined ? undefined : sclk - store.entrySclk);
  return {
    row,
    state: stateOf(store, dictionary, plan, row, heard, cutoff),
    by: known?.by,
    verdict: known?.verdict ?? '',
    firedLive_e_s: e_s(live?.firedSclk),
    firedRecorded_e_s: e_s(recorded?.firedSclk),
    tone_e_s: known?.by === 'tone' ? e_s(known.triggered_sclk) : undefined,
    posterior: known?.posterior,
    triggered_e_s: known?.by === 'tone' ? undefined : e_s(known?.triggered_sclk),
    why: store.explanations.findLast(
      ({ fact }) => fact.sclk <= cutoff && fact.conditions.length > 0 && speaksOf(fact, row),
    )?.fact,
  };
}

function stateOf(
  store: RunStore,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  row: TimepointRow,
  heard: ReadonlyMap<number, Heard>,
  cutoff: number,
): PointState {
  const known = heard.get(row.id);
  if (known) return VERDICTS[known.verdict as keyof typeof VERDICTS] ?? 'fired';
  const [at, last] = [plan.indexOf(row), lastHeard(plan, heard)];
  if (at <= last) return 'passed';
  if (at === last + 1) return awaitsReply(store, dictionary, row, cutoff) ? 'waiting for reply' : 'next';
  return row.anchor !== '' && row.plannedES === undefined && !predecessorAnchored(plan, at, last)
    ? 'undefined'
    : 'pending';
}

/** Whether the anchor of a timepoint is known: a timepoint that counts from it has been triggered. */
function predecessorAnchored(plan: readonly TimepointRow[], at: number, last: number): boolean {
  return plan.slice(0, last + 1).some((row) => row.anchor === plan[at]?.anchor);
}

/** Whether the vehicle reports that its action was triggered and the reply is due. */
function awaitsReply(store: RunStore, dictionary: Dictionary, row: TimepointRow, cutoff: number): boolean {
  const [index, state] = [dictionary.pick(LAYOUT.currentTimepoint), dictionary.pick(LAYOUT.timepointState)];
  const [now, told] = [index && store.latest(index.id, cutoff), state && store.latest(state.id, cutoff)];
  return (
    state !== undefined &&
    now?.value === row.id &&
    told !== undefined &&
    dictionary.label(state, told.value) === 'waiting_reply'
  );
}

/** The timepoint after the last known one, in the order of the timeline. */
export function nextTimepoint(
  store: RunStore,
  plan: readonly TimepointRow[],
  cutoff: number,
): TimepointRow | undefined {
  return plan[lastHeard(plan, heardOf(store, plan, cutoff)) + 1];
}

export const title = inWords;
/** The short title for pictures: "SUFR" for "straighten up and fly right (SUFR)". */
export const shortTitle = (name: string): string => /\((\w+)\)$/.exec(inWords(name))?.[1] ?? inWords(name);
