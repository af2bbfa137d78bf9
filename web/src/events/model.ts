// SPDX-License-Identifier: Apache-2.0
// Events and their explanations, newest first.
import { SOURCES, STATUS } from '../design/status';
import { LAYOUT } from '../layout';
import { alsoCalled } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { isAmiss, lookOf } from '../situation/model';
import { firstWords, newsOf } from '../situation/news';

interface EventLine {
  key: string;
  seq: number;
  e_s: number;
  level: string;
  name: string;
  /** What the banner calls it. */
  named: string;
  text: string;
  why: string[];
  /** An alarm, as the banner and the header have it. */
  alarm: boolean;
  live: boolean;
  recorded: boolean;
  explanation: boolean;
  /** The ground itself tells it. */
  ground: boolean;
}

export const LEVELS = [
  'DIAGNOSTIC',
  'ACTIVITY_LO',
  'ACTIVITY_HI',
  'COMMAND',
  'WARNING_LO',
  'WARNING_HI',
  'FATAL',
] as const;
/** Shapes of the levels. They are distinct from the shapes for how something is known and for "good". */
const SHAPES: Record<string, string> = {
  FATAL: '✖',
  WARNING_HI: '▲',
  WARNING_LO: '△',
  COMMAND: '▸',
  ACTIVITY_HI: '»',
  ACTIVITY_LO: '›',
  DIAGNOSTIC: '–',
  why: '∵',
};
export const levelShape = (level: string) => SHAPES[level] ?? STATUS.unknown.shape;
export const levelWords = (level: string) => level.replace('_HI', ', high').replace('_LO', ', low').toLowerCase();

interface EventFilter {
  from: (typeof LEVELS)[number];
  search: string;
  range: { from: number; to: number } | undefined;
}

/** Verdicts that repeat while nothing happens; the waiting panel shows the newest of them. */
const MINOR = new Set(['held', 'chosen', 'dropped']);

const SAME_MOMENT_S = 1 / 16; // chosen: an explanation and its event leave within a few cycles

// Chosen: the banner says since when in the event's own time, rounded by the correlation of clocks.
const SAME_NEWS_S = 1;

/**
 * The newest `most` of the matching lines. An explanation is shown with its event of the same moment, else on a line of
 * its own.
 */
export function eventLines(
  store: RunStore,
  filter: EventFilter,
  most: number,
): { lines: EventLine[]; found: number; alarms: number; warnings: number } {
  const least = LEVELS.indexOf(filter.from);
  const words = filter.search
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== '');
  const inRange = (sclk: number) => {
    const e_s = sclk - store.entrySclk;
    return !filter.range || (e_s >= filter.range.from && e_s <= filter.range.to);
  };
  const matches = (line: EventLine) => {
    const all = `${line.name} ${line.named} ${line.text} ${line.why.join(' ')}`.toLowerCase();
    return words.every((word) => all.includes(word));
  };
  const lines: EventLine[] = [];
  let [alarms, warnings] = [0, 0];
  const news = newsOf(store);
  for (const row of store.events) {
    if (!inRange(row.fact.sclk)) continue;
    const level = LEVELS.indexOf(row.fact.level);
    const banner = news.find(
      (each) =>
        each.evidence === `event ${row.fact.name}` &&
        Math.abs(store.sclkSeenAt(each.since_s) - row.fact.sclk) <= SAME_NEWS_S,
    );
    const alarm = banner !== undefined && lookOf(banner) === 'alarm';
    if (alarm) ++alarms;
    else if (level >= LEVELS.indexOf('WARNING_LO')) ++warnings;
    if (level >= 0 && level < least) continue;
    lines.push({
      key: `e${row.seq}`,
      seq: row.seq,
      e_s: row.fact.sclk - store.entrySclk,
      level: row.fact.level,
      name: row.fact.name,
      named: banner ? firstWords(banner.sentence) : '',
      text: alsoCalled(row.fact.text || row.fact.name),
      why: [],
      alarm,
      live: row.live,
      recorded: row.recorded,
      explanation: false,
      ground: row.fact.name === LAYOUT.seenByDoppler,
    });
  }
  // What the ground found by itself; what it repeats of an event stands in its row already.
  for (const { seq, ert_s, rank, subject, sentence, evidence } of news) {
    const sclk = store.sclkSeenAt(ert_s);
    if (evidence.startsWith('event ') || !inRange(sclk)) continue;
    const alarm = lookOf({ rank, subject, sentence }) === 'alarm';
    const level = alarm ? 'WARNING_HI' : isAmiss({ rank, subject }) ? 'WARNING_LO' : 'ACTIVITY_HI';
    if (alarm) ++alarms;
    else if (level === 'WARNING_LO') ++warnings;
    if (LEVELS.indexOf(level) < least) continue;
    lines.push({
      key: `s${seq} ${sentence}`,
      seq,
      e_s: sclk - store.entrySclk,
      level,
      name: '',
      named: '',
      text: sentence,
      why: [],
      alarm,
      live: true,
      recorded: false,
      explanation: false,
      ground: true,
    });
  }
  for (const row of store.explanations) {
    if (!inRange(row.fact.sclk)) continue;
    const e_s = row.fact.sclk - store.entrySclk;
    const decision = row.fact.decision.toLowerCase();
    const minor = MINOR.has(row.fact.verdict);
    const owner =
      minor || decision === ''
        ? undefined
        : lines.findLast(
            (line) =>
              !line.explanation &&
              Math.abs(line.e_s - e_s) <= SAME_MOMENT_S &&
              line.name.toLowerCase().startsWith(decision),
          );
    if (owner) owner.why.push(row.fact.text);
    else if (least === 0 || !minor) {
      lines.push({
        key: `x${row.seq}`,
        seq: row.seq,
        e_s,
        level: 'why',
        name: row.fact.decision,
        named: '',
        text: row.fact.text,
        why: [],
        alarm: false,
        live: row.live,
        recorded: row.recorded,
        explanation: true,
        ground: false,
      });
    }
  }
  lines.sort((a, b) => b.e_s - a.e_s || b.seq - a.seq);
  const found = lines.filter(matches);
  return { lines: found.slice(0, most), found: found.length, alarms, warnings };
}

export function sourceWords(line: Pick<EventLine, 'live' | 'recorded' | 'ground'>): {
  shape: string;
  words: string;
} {
  if (line.ground) return { shape: '≈', words: 'made on ground' };
  const { uhf, recording } = SOURCES;
  if (line.live && line.recorded)
    return { shape: uhf.shape + recording.shape, words: 'seen live and found in the recording' };
  if (line.recorded) return { shape: recording.shape, words: 'known from the recording only' };
  return { shape: uhf.shape, words: 'seen live; the recording is not here yet' };
}
