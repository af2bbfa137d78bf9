import type { LinkLook } from '../design/status';
import { dayOfYear, duration, fromEntry } from '../run/time';
import { linkTitle } from '../links/model';
import { MODES, isReal, modeOf } from '../mode/model';
import type { RunStore } from '../run/store';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { StreamState } from '../stream/messages';

export interface Clock {
  label: string;
  value: string;
  id: string;
}

/** What is seen on Earth now, and when it happened at Mars: one instant on every clock. */
export function clocksOf(store: RunStore, past: number | undefined): { entry: string; others: Clock[] } {
  const clocks = store.clocks;
  const e_s = past ?? store.seenE;
  const sclk = store.entrySclk + e_s;
  const lightTime = clocks?.lightTimeS ?? store.run.lightTimeS;
  const ert = store.ertOf(sclk);
  const others: Clock[] = [
    { id: 'scet', label: 'at Mars (SCET)', value: dayOfYear(ert - lightTime) },
    { id: 'ert', label: 'on Earth (ERT)', value: dayOfYear(ert) },
    { id: 'sclk', label: 'SCLK', value: Number.isFinite(sclk) ? sclk.toFixed(3) : '—' },
    { id: 'light-time', label: 'light time', value: duration(lightTime) },
  ];
  if (lightTime > 0 && past === undefined && clocks?.ert) {
    others.push({ id: 'mars-now', label: 'the vehicle is at', value: fromEntry(clocks.eS) });
  }
  return { entry: fromEntry(e_s, { hours: true }), others };
}

/** When a command must leave Earth at the latest to come before the first timepoint of the plan. */
export function latestSend(
  store: RunStore, plan: readonly TimepointRow[],
): { at: string; left_s: number; first: string } | undefined {
  let first: TimepointRow | undefined;
  for (const row of plan) {
    if (row.plannedES !== undefined && (first?.plannedES === undefined || row.plannedES < first.plannedES)) first = row;
  }
  if (first?.plannedES === undefined || store.firings.size > 0) return undefined;
  const latest_e_s = first.plannedES - store.run.lightTimeS;
  const now_e_s = store.clocks?.eS ?? store.seenE;
  return { at: fromEntry(latest_e_s), left_s: latest_e_s - now_e_s, first: first.name };
}

export interface LinkLine {
  name: string;
  look: LinkLook;
  detail: string;
}

export function linksOf(store: RunStore, cutoff: number): LinkLine[] {
  return [...store.links].map(([link, changes]) => {
    const until = changes.filter((change) => !(store.sclkSeenAt(change.fact.ert) > cutoff));
    const last = until[until.length - 1]?.fact;
    return {
      name: linkTitle(link),
      look: last === undefined ? 'unknown' : last.up ? 'up' : 'down',
      detail: last?.reason || (last === undefined ? 'not yet' : last.up ? 'receiving' : 'silent'),
    };
  });
}

const FEW = 3;

/** For the header, where there is room for few: beyond that, the orbiters' links are one entry that says how many are up. */
/** What does not arrive, or does not stay. */
export function headerLinks(store: RunStore, cutoff: number): LinkLine[] {
  const fault = store.run.archiveFault;
  return [...(fault ? [{ name: 'NOT STORED', look: 'lost', detail: fault } as const] : []), ...radioLinks(store, cutoff)];
}

function radioLinks(store: RunStore, cutoff: number): LinkLine[] {
  const all = linksOf(store, cutoff);
  if (all.length <= FEW) return all;
  const names = [...store.links.keys()];
  const [own, others] = [[] as LinkLine[], [] as LinkLine[]];
  all.forEach((line, i) => (['uhf_live', 'x_band'].includes(names[i] ?? '') ? own : others).push(line));
  const up = others.filter((line) => line.look === 'up');
  return [...own, {
    name: `${others.length} relay links`, look: up.length > 0 ? 'up' : others.some((line) => line.look === 'down') ? 'down' : 'unknown',
    detail: up.length > 0 ? `up: ${up.map((line) => line.name).join(', ')}` : others.findLast((line) => line.look === 'down')?.detail ?? 'not yet',
  }];
}

const STREAM_WORDS: Record<StreamState, string> = {
  connecting: 'connecting', catching_up: 'catching up', live: 'connected', lost: 'NO CONNECTION',
};

export function streamLine(state: StreamState, attempt: number, gaps: number): LinkLine {
  return {
    name: STREAM_WORDS[state],
    look: state === 'live' ? 'up' : state === 'lost' ? 'lost' : 'unknown',
    detail: state === 'lost' ? `what is shown is old; attempt ${attempt}` : `gaps ${gaps}`,
  };
}

export interface Badge {
  title: string;
  detail: string;
}

/** What cannot be mistaken: which run this is, where it happens, and whether it is happening. */
export function badgeOf(store: RunStore | undefined, past: { from: number; to: number } | undefined, replayed = false): Badge {
  if (!store) return { title: MODES.none.badge, detail: 'start a rehearsal' };
  const run = store.run;
  const mode = modeOf(store, past !== undefined, replayed);
  const name = `${run.scenario} · run ${store.id}`;
  const where = isReal(run) ? 'real venue' : 'rehearsal';
  if (past) return { title: MODES[mode].badge, detail: `${where}, ${name}${replayed ? '' : ` · ${fromEntry(past.from)} … ${fromEntry(past.to)}`}` };
  if (!store.going) return { title: run.state === 'interrupted' ? 'INTERRUPTED RUN' : MODES.ended.badge, detail: `${where}, ${name} · ${outcomeWords(run.outcome, run.state)}` };
  const pace = run.pace === 0 ? 'as fast as it goes' : `${run.pace}×`;
  return { title: MODES[mode].badge, detail: `${name} · ${run.state === 'paused' ? 'paused' : mode === 'live' ? 'now' : pace}` };
}

export function outcomeWords(outcome: string, state: string): string {
  if (state === 'interrupted') return 'the server stopped in mid-run; all that was published is here';
  switch (outcome) {
    case 'touchdown': return 'touchdown';
    case 'impact': return 'hit the ground too fast';
    case 'lost': return 'lost';
    case 'not_commanded': return 'no command came in time';
    case 'timeout': return 'ended by its time limit';
    default: return inProgress(state);
  }
}

function inProgress(state: string): string {
  return state === 'paused' ? 'paused' : state === 'waiting' ? 'waiting to begin' : 'going on';
}
