// SPDX-License-Identifier: Apache-2.0
import { linkLook } from '../design/status';
import type { LinkLook } from '../design/status';
import { dayOfYear, duration, fromEntry, secondsOfErt } from '../run/time';
import { linkTitle } from '../links/model';
import { shortReason } from '../timeline/model';
import { MODES, isReal, modeOf } from '../mode/model';
import type { RunStore } from '../run/store';
import type { StreamState } from '../stream/messages';
import type { NamedLink } from '../stream/names';

interface Clock {
  label: string;
  value: string;
  id: string;
}

/** The instant whose signal reaches Earth now, on every clock: Mars, Earth and spacecraft. */
export function clocksOf(store: RunStore, past: number | undefined): { entry: string; others: Clock[] } {
  const clocks = store.clocks;
  const e_s = past ?? store.seenE;
  const sclk = store.entrySclk + e_s;
  const lightTime = clocks?.lightTimeS ?? store.run.lightTimeS;
  const ert = store.ertOf(sclk);
  const others: Clock[] = [
    { id: 'scet', label: 'at Mars (SCET)', value: store.entryKnown ? dayOfYear(ert - lightTime) : '—' },
    { id: 'ert', label: 'on Earth (ERT)', value: dayOfYear(ert) },
    { id: 'sclk', label: 'SCLK', value: Number.isFinite(sclk) && sclk !== 0 ? sclk.toFixed(3) : '—' },
    {
      id: 'light-time',
      label: 'light time',
      value: lightTime > 0 ? duration(lightTime) : isReal(store.run) ? '—' : 'not rehearsed',
    },
  ];
  if (lightTime > 0 && past === undefined && clocks?.ertUs !== undefined) {
    others.push({ id: 'mars-now', label: 'the vehicle is at', value: fromEntry(clocks.eS) });
  }
  return { entry: fromEntry(store.entryKnown ? e_s : NaN), others };
}

/**
 * The latest time at which a command can leave Earth and still precede a planned timepoint, by the clock from entry.
 * `next` is undefined if no such timepoint is left.
 */
interface LatestSend {
  next: { name: string; at: string; left_s: number } | undefined;
}

/** The ground's value; undefined if the run has no clocks. */
export function latestSend(store: RunStore): LatestSend | undefined {
  const { clocks } = store;
  if (clocks?.ertUs === undefined || !store.entryKnown) return undefined;
  const latest_s = secondsOfErt(clocks.latestUsefulUs);
  return {
    next:
      clocks.usefulBefore === ''
        ? undefined
        : {
            name: clocks.usefulBefore,
            at: fromEntry(latest_s - store.ertOf(store.entrySclk)),
            left_s: latest_s - secondsOfErt(clocks.ertUs),
          },
  };
}

export interface LinkLine {
  name: string;
  look: LinkLook;
  /** Its state and why, whole; `short`: as far as the header has room. */
  detail: string;
  short: string;
  silence?: NamedLink['silence'];
}

const STATES = { up: 'received', down: 'silent', lost: 'lost', unknown: 'not known' } as const;
/** "silent: plasma blackout: predicted from …" */
function lineOf(name: string, look: LinkLook, reason: string): LinkLine {
  const state = STATES[look];
  const why = look === 'up' && reason === 'nominal' ? '' : reason;
  return { name, look, detail: why ? `${state}: ${why}` : state, short: why ? `${state}: ${shortReason(why)}` : state };
}

/** A link that the plan has off: it stands in the header once it is due, and X-band's telemetry until tones follow it. */
const isOff = (link: string, { look, silence }: LinkLine): boolean =>
  ['down', 'unknown'].includes(look) &&
  (silence === 'not_begun' || (link === 'x_band_telemetry' && silence === 'switched_off'));

/**
 * Without a connection the present state of a link is unknown; a past view still knows it. Its last silence stays, so
 * that no link that was off appears just then.
 */
export function linksOf(store: RunStore, cutoff: number, lost = false): LinkLine[] {
  return [...store.links].map(([link, changes]) => {
    const until = changes.filter((change) => !(store.sclkSeenAt(change.ert_s) > cutoff));
    const last = until[until.length - 1]?.fact;
    if (lost && cutoff === Infinity && store.going) {
      const unknown = lineOf(linkTitle(link), 'unknown', 'no connection');
      return { ...unknown, short: STATES.unknown, silence: last?.silence }; // why stands beside it, once
    }
    return last
      ? { ...lineOf(linkTitle(link), linkLook(last), last.reason), silence: last.silence }
      : lineOf(linkTitle(link), 'unknown', 'not heard of yet');
  });
}

const FEW = 3;

/**
 * The links for the header: those that do not arrive or are not stable. Beyond a few, the orbiters' links become one
 * entry with the number that are up.
 */
export function headerLinks(store: RunStore, cutoff: number, lost = false): LinkLine[] {
  const { archiveFault, follows, originLost, unpublished } = store.run;
  const own = (name: string, look: LinkLook, detail: string, short = detail): LinkLine[] =>
    detail ? [{ name, look, detail, short }] : [];
  return [
    ...own('NOT STORED', 'lost', archiveFault),
    ...own('FOLLOWER', originLost ? 'lost' : 'up', follows, originLost ? 'origin lost' : 'follows'),
    ...own('NOT PUBLISHED', 'lost', unpublished),
    ...radioLinks(store, cutoff, lost),
  ];
}

const OWN = ['uhf_live', 'x_band_telemetry', 'x_band'];

function radioLinks(store: RunStore, cutoff: number, lost: boolean): LinkLine[] {
  const names = [...store.links.keys()];
  const on = linksOf(store, cutoff, lost).map((line, i) => ({ link: names[i] ?? '', line }));
  // In a past view a link that nobody had heard of yet is not there, as it was not then.
  const unheard = ({ look, silence }: LinkLine) => cutoff !== Infinity && look === 'unknown' && silence === undefined;
  const shown = on.filter(({ link, line }) => !isOff(link, line) && !unheard(line));
  const all = shown.map(({ line }) => line);
  if (all.length <= FEW) return all;
  const [own, others] = [[] as LinkLine[], [] as LinkLine[]];
  for (const { link, line } of shown) (OWN.includes(link) ? own : others).push(line);
  const [missed, up, down] = (['lost', 'up', 'down'] as const).map((look) =>
    others.filter((line) => line.look === look),
  ) as [LinkLine[], LinkLine[], LinkLine[]];
  const name = `${others.length} relay links`;
  const whole = (look: LinkLook, detail: string): LinkLine[] => [...own, { name, look, detail, short: detail }];
  if (missed.length > 0) return whole('lost', missed.map((line) => `${line.name} ${line.detail}`).join('; '));
  if (up.length > 0) return whole('up', `received: ${up.map((line) => line.name).join(', ')}`);
  const last = down.at(-1) ?? others.at(-1);
  return last ? [...own, { ...last, name }] : own;
}

const STREAM_WORDS: Record<StreamState, string> = {
  connecting: 'connecting',
  catching_up: 'catching up',
  live: 'connected',
  lost: 'NO CONNECTION',
};

/** That what is shown is old, and which attempt this is, the banner says. */
export function streamLine(state: StreamState, gaps: number): LinkLine {
  return {
    name: STREAM_WORDS[state],
    short: '',
    look: state === 'live' ? 'up' : state === 'lost' ? 'lost' : 'unknown',
    detail: gaps > 0 ? `gaps ${gaps}` : '',
  };
}

interface Badge {
  title: string;
  detail: string;
}

/** Which run this is, where it happens, and whether it is live. */
export function badgeOf(
  store: RunStore | undefined,
  past: { from: number; to: number } | undefined,
  replayed = false,
): Badge {
  if (!store) return { title: MODES.none.badge, detail: 'start a rehearsal' };
  const run = store.run;
  const mode = modeOf(store, past !== undefined, replayed);
  const name = `${run.scenario} · run ${store.id}`;
  const where = isReal(run) ? 'real venue' : 'rehearsal';
  if (past)
    return {
      title: MODES[mode].badge,
      detail: `${where}, ${name}${replayed ? '' : ` · ${fromEntry(past.from)} … ${fromEntry(past.to)}`}`,
    };
  if (!store.going)
    return {
      title: run.state === 'interrupted' ? 'INTERRUPTED RUN' : MODES.ended.badge,
      detail: `${where}, ${name} · ${outcomeWords(run.outcome, run.state)}`,
    };
  const pace = run.pace === 0 ? 'as fast as it goes' : `${run.pace}×`;
  return {
    title: MODES[mode].badge,
    detail: `${name} · ${run.state === 'paused' ? 'paused' : mode === 'live' ? 'now' : pace}`,
  };
}

export function outcomeWords(outcome: string, state: string): string {
  if (state === 'interrupted') return 'the server stopped in mid-run; all that was published is here';
  switch (outcome) {
    case 'touchdown':
      return 'touchdown';
    case 'impact':
      return 'hit the ground too fast';
    case 'lost':
      return 'lost';
    case 'not_commanded':
      return 'the cruise stage was not commanded to separate';
    case 'timeout':
      return 'ended by its time limit';
    default:
      return inProgress(state);
  }
}

function inProgress(state: string): string {
  return state === 'paused' ? 'paused' : 'going on';
}
