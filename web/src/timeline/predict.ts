// SPDX-License-Identifier: Apache-2.0
// When each timepoint is predicted, from what is known now: the plan, moved by every anchor that was heard of, by UHF, recording
// or tone; and what a command in the form would move.
import { LAYOUT } from '../layout';
import { SOURCES } from '../design/status';
import type { AnchorRow, TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { RunStore } from '../run/store';
import { heardOf } from './heard';

/** Times in seconds from entry. */
export interface Prediction {
  id: number;
  name: string;
  /** Of what has fired: as it was predicted before its anchor was heard of. */
  e_s: number;
  fired: boolean;
}

/** What a command would change; everything else stays. */
export interface Change {
  timepoint?: { id: number; desired_s: number; minimum_s: number | undefined };
  /** So long after another one; without one, from entry. It holds until the anchor is heard of after `since_e_s`, when the vehicle carried it out. */
  anchor?: { name: string; after: string; by_s: number; since_e_s: number };
}

export type Anchors = readonly (readonly [name: string, e_s: number])[];

/**
 * The timeline's own rule (a timepoint fires once its desired offset from anchor or predecessor and its minimum offset from its
 * predecessor have come) over predicted anchors: one that is overdue comes now at the earliest, and moves those after it along.
 * A timepoint whose anchor nobody predicts is left out.
 */
export function predictions(
  store: RunStore,
  plan: readonly TimepointRow[],
  anchors: Anchors,
  cutoff: number,
  changes: readonly Change[] = [],
): Prediction[] {
  const now = Math.min(store.seenSclk, cutoff) - store.entrySclk;
  const heard = triggeredOf(store, plan, cutoff);
  const { before, after } = anchorTimes(plan, anchors, heard, now, changesOfAnchors(changes));
  const all: Prediction[] = [];
  let previous: number | undefined;
  for (const row of plan) {
    const fired = heard.get(row.id);
    const changed =
      fired === undefined ? changes.findLast((each) => each.timepoint?.id === row.id)?.timepoint : undefined;
    const [desired, minimum] = changed
      ? [changed.desired_s, changed.minimum_s]
      : [row.desiredOffsetS, row.minimumOffsetS];
    const base = row.anchor === '' ? previous : (fired === undefined ? after : before).get(row.anchor);
    let at = base === undefined || desired === undefined ? undefined : base + desired;
    if (at !== undefined && previous !== undefined && minimum !== undefined) at = Math.max(at, previous + minimum);
    if (at !== undefined && Number.isFinite(at))
      all.push({ id: row.id, name: row.name, e_s: at, fired: fired !== undefined });
    previous = fired ?? at ?? previous;
  }
  return all;
}

/** When each anchor is, as it is known or predicted now, in seconds from entry. */
export function anchorsNow(
  store: RunStore,
  plan: readonly TimepointRow[],
  anchors: Anchors,
  cutoff: number,
  changes: readonly Change[] = [],
): Map<string, number> {
  const now = Math.min(store.seenSclk, cutoff) - store.entrySclk;
  return anchorTimes(plan, anchors, triggeredOf(store, plan, cutoff), now, changesOfAnchors(changes)).after;
}

/** The anchors that something on board has found, each by the first timepoint of it that was heard of: a timepoint can be later than its anchor says, never earlier. */
export function anchorsFound(
  store: RunStore,
  plan: readonly TimepointRow[],
  cutoff: number,
): Map<string, { e_s: number; name: string; how: string }> {
  const found = new Map<string, { e_s: number; name: string; how: string }>();
  const heard = heardOf(store, plan, cutoff);
  for (const row of plan) {
    const told = heard.get(row.id);
    if (!told || row.anchor === '' || row.desiredOffsetS === undefined) continue;
    const e_s = told.triggered_sclk - store.entrySclk - row.desiredOffsetS;
    if (e_s >= (found.get(row.anchor)?.e_s ?? Infinity)) continue;
    found.set(row.anchor, { e_s, name: row.name, how: SOURCES[told.by].word });
  }
  return found;
}

/** When what was heard of was triggered, in seconds from entry. */
function triggeredOf(store: RunStore, plan: readonly TimepointRow[], cutoff: number): Map<number, number> {
  return new Map([...heardOf(store, plan, cutoff)].map(([id, each]) => [id, each.triggered_sclk - store.entrySclk]));
}

const changesOfAnchors = (changes: readonly Change[]) =>
  new Map(changes.flatMap(({ anchor }) => (anchor ? [[anchor.name, anchor] as const] : [])));

/** `before`: as each was predicted until it was heard of; `after`: as it is known or predicted now. */
function anchorTimes(
  plan: readonly TimepointRow[],
  anchors: Anchors,
  heard: ReadonlyMap<number, number>,
  now: number,
  changes: ReadonlyMap<string, NonNullable<Change['anchor']>>,
): { before: Map<string, number>; after: Map<string, number> } {
  const [before, after] = [new Map<string, number>(), new Map<string, number>()];
  // A timepoint can be later than its anchor says, never earlier: the earliest tells the anchor best.
  const told = new Map<string, number>();
  const toldAt = new Map<string, number>();
  for (const row of plan) {
    const at = heard.get(row.id);
    if (at === undefined || row.anchor === '' || row.desiredOffsetS === undefined) continue;
    told.set(row.anchor, Math.min(told.get(row.anchor) ?? Infinity, at - row.desiredOffsetS));
    toldAt.set(row.anchor, Math.min(toldAt.get(row.anchor) ?? Infinity, at));
  }
  // The anchors that the plan itself knows stand at their planned time.
  for (const row of plan) {
    if (row.plannedES !== undefined && row.desiredOffsetS !== undefined && row.anchor !== '')
      before.set(row.anchor, row.plannedES - row.desiredOffsetS);
  }
  const changed = (name: string): number | undefined => {
    const change = changes.get(name);
    if (!change || change.since_e_s < (toldAt.get(name) ?? -Infinity)) return undefined;
    const from = change.after === '' ? 0 : (after.get(change.after) ?? before.get(change.after));
    return from === undefined ? undefined : from + change.by_s;
  };
  anchors.forEach(([name, e_s], i) => {
    const [last, last_e_s] = anchors[i - 1] ?? ['', 0];
    if (!before.has(name)) before.set(name, (after.get(last) ?? 0) + e_s - last_e_s);
    after.set(name, changed(name) ?? told.get(name) ?? Math.max(before.get(name) as number, i === 0 ? -Infinity : now));
  });
  for (const [name, e_s] of before) if (!after.has(name)) after.set(name, changed(name) ?? told.get(name) ?? e_s);
  return { before, after };
}

/** What a command with these arguments changes, as far as they are known; undefined where it moves nothing. Before it is carried out, nothing is heard after it. */
export function changeOf(
  command: string,
  values: ReadonlyMap<string, number>,
  store: RunStore,
  anchors: readonly AnchorRow[],
  since_e_s = Infinity,
): Change | undefined {
  const moves = LAYOUT.moves.find((each) => each.command === command);
  if (!moves) return undefined;
  if ('anchor' in moves) {
    const sclk = values.get(moves.sclk);
    return sclk === undefined
      ? undefined
      : { anchor: { name: moves.anchor, after: '', by_s: sclk - store.entrySclk, since_e_s } };
  }
  if ('anchorNumber' in moves) {
    const [row, offset_s] = [
      anchors.find((each) => each.id === values.get(moves.anchorNumber)),
      values.get(moves.offset),
    ];
    const parent = anchors.find((each) => each.name === row?.parent);
    if (!row || !parent || offset_s === undefined) return undefined;
    const ofClock = parent.parent === ''; // the root is time zero of the spacecraft's clock
    return {
      anchor: {
        name: row.name,
        after: ofClock ? '' : parent.name,
        by_s: ofClock ? offset_s - store.entrySclk : offset_s,
        since_e_s,
      },
    };
  }
  const [id, desired_s] = [values.get(moves.timepoint), values.get(moves.desired)];
  return id === undefined || desired_s === undefined
    ? undefined
    : { timepoint: { id, desired_s, minimum_s: values.get(moves.minimum) } };
}

/** What the vehicle has carried out of such commands. */
export function changesMade(store: RunStore, anchors: readonly AnchorRow[], cutoff: number): Change[] {
  return [...store.commands.values()].flatMap((row) => {
    const executed = row.stages.get('executed')?.at(-1);
    const sclk = executed && store.sclkSeenAt(executed.at);
    if (executed?.status !== 'ok' || sclk === undefined || sclk > cutoff) return [];
    const values = row.arguments
      .split(' ')
      .map((part) => part.split('='))
      .filter((pair) => pair.length === 2);
    return (
      changeOf(
        row.name,
        new Map(values.map(([name, value]) => [name as string, Number(value)])),
        store,
        anchors,
        sclk - store.entrySclk,
      ) ?? []
    );
  });
}

export interface Moved {
  id: number;
  name: string;
  from_e_s: number;
  to_e_s: number;
}

const LEAST_S = 1 / 64; // a cycle on board

/** Each timepoint that has not fired and comes at another time, in the order of the timeline. */
export function movedBy(before: readonly Prediction[], after: readonly Prediction[]): Moved[] {
  const old = new Map(before.map((each) => [each.id, each]));
  return after.flatMap((each) => {
    const from = old.get(each.id);
    return !from || each.fired || Math.abs(each.e_s - from.e_s) < LEAST_S
      ? []
      : [{ id: each.id, name: each.name, from_e_s: from.e_s, to_e_s: each.e_s }];
  });
}
