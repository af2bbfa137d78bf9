// SPDX-License-Identifier: Apache-2.0
// What is true and matters now. The server decides it (`situation`, an item of the stream); the console adds the lost
// connection, which only it can know, and what its reader has put aside.
import { signal } from '@preact/signals';
import type { Status } from '../design/status';
import { stream } from '../run/connection';
import { cursor } from '../run/cursor';
import { cutoff, pastRange, shownRun, signalOfRun } from '../run/shown';
import { secondsOfErt } from '../run/time';
import type { RunStore } from '../run/store';
import { choice, spanNow } from '../run/window';
import type { NamedEntry } from '../stream/names';
import { countdownWords } from './countdown';
import { shortWords } from './news';

export type Rank = NamedEntry['rank'] | 'lost';
/** An entry as it is drawn. Times in seconds from entry; NaN: not known. */
export interface Line {
  key: string;
  rank: Rank;
  subject: string;
  sentence: string;
  evidence: string;
  since_e_s: number;
  countdown: string;
  /** Whether the sentence ends with the name of what is awaited, which the countdown then leaves out. */
  namesAwaited: boolean;
  /** Whether the reader can put it aside. */
  mayGo: boolean;
  aside: boolean;
}
export interface Situation {
  /** What matters most; undefined before the first word. */
  first: Line | undefined;
  /** The others, those put aside last. */
  more: Line[];
  /** States that last, in two or three words. */
  lasting: { subject: string; words: string; sentence: string }[];
}

export const LOOKS: Record<Rank, Status> = {
  lost: 'failed',
  danger: 'alarm',
  news: 'caution',
  silence: 'quiet',
  waiting: 'next',
  calm: 'good',
  lasting: 'caution',
};
/**
 * A touchdown and its recording are good news; a link that is silent is silent, however calm that leaves people.
 * What is an alarm in the header is one here: a link or the station lost, the backup in charge.
 */
export function lookOf({ rank, subject, sentence }: Pick<Line, 'rank' | 'subject' | 'sentence'>): Status {
  if (rank === 'news' && (subject === 'landed' || subject === 'recording')) return 'holds';
  if (rank === 'news' && isAmiss({ rank, subject }) && !subject.startsWith('command ')) return 'alarm';
  return rank === 'calm' && / silent\b/.test(sentence) ? 'quiet' : LOOKS[rank];
}

/** Keys of the news that the reader has put aside. Nothing is lost: they stay in the list. */
export const aside = signalOfRun<ReadonlySet<string>>(new Set());
export const listShown = signal(false);

/** News of what goes as it should. */
const AS_IT_SHOULD = ['landed', 'commanding', 'recording'];
/** Whether an entry tells of danger, or of what did not go as it should and is news still. */
export const isAmiss = ({ rank, subject }: Pick<NamedEntry, 'rank' | 'subject'>): boolean =>
  rank === 'danger' || (rank === 'news' && !AS_IT_SHOULD.includes(subject));

/** What the server said at `until` (SCLK), the most important first. */
export const entriesAt = (run: RunStore | undefined, until: number): readonly NamedEntry[] =>
  run?.situations.findLast(({ ert_s }) => run.knownBy(ert_s, until))?.fact.entries ?? [];

/** The situation of the run at `until` (SCLK), Infinity: now. */
export function situationOf(
  run: RunStore | undefined,
  until: number,
  lost: { attempt: number } | undefined,
  put: ReadonlySet<string> = new Set(),
): Situation {
  const told = entriesAt(run, until);
  const stands = lost !== undefined || !run?.going;
  const now_e_s = run && (until !== Infinity || !stands) ? Math.min(run.seenSclk, until) - run.entrySclk : NaN;
  const e_s = (us: bigint | undefined) =>
    run && us !== undefined && us !== 0n ? run.sclkSeenAt(secondsOfErt(us)) - run.entrySclk : NaN;
  // What also stands beside the badge can be put aside.
  const stays = new Set(told.filter(({ rank }) => rank === 'lasting').map(({ subject }) => subject));
  const lines = told
    .filter(({ rank }) => rank !== 'lasting')
    .map((entry): Line => {
      const countdown = countdownWords(entry.awaited, e_s(entry.atUs), now_e_s, entry.overdue);
      const namesAwaited = countdown !== '' && entry.sentence.endsWith(entry.awaited);
      const key = `${entry.rank} ${entry.subject} ${entry.evidenceSeq} ${entry.sentence}`;
      return {
        key,
        rank: entry.rank,
        subject: entry.subject,
        sentence: entry.sentence,
        evidence: entry.evidence,
        since_e_s: e_s(entry.sinceUs),
        countdown: namesAwaited ? countdown.slice(entry.awaited.length + 1) : countdown,
        namesAwaited,
        mayGo: entry.rank === 'news' || (entry.rank === 'danger' && stays.has(entry.subject)),
        aside: false,
      };
    })
    .map((line) => ({ ...line, aside: line.mayGo && put.has(line.key) }));
  const all: Line[] = [
    ...(lost
      ? [
          {
            key: 'lost',
            rank: 'lost' as const,
            subject: 'connection',
            sentence: `NO CONNECTION: ${until === Infinity ? 'everything here is old' : 'nothing new comes'}. Trying again, attempt ${lost.attempt}.`,
            evidence: '',
            since_e_s: NaN,
            countdown: '',
            namesAwaited: false,
            mayGo: false,
            aside: false,
          },
        ]
      : []),
    ...lines.filter((line) => !line.aside),
  ];
  return {
    first: all[0],
    more: [...all.slice(1), ...lines.filter((line) => line.aside)],
    lasting: told
      .filter(({ rank }) => rank === 'lasting')
      .map(({ subject, sentence }) => ({
        subject,
        words: shortWords(sentence),
        sentence,
      })),
  };
}

/** That of the page, for use in a view. */
export const situationNow = (run: RunStore | undefined): Situation =>
  situationOf(
    run,
    cutoff.value,
    stream.value.state === 'lost' ? { attempt: stream.value.attempt } : undefined,
    aside.value,
  );

export function putAside(line = situationNow(shownRun()).first): void {
  if (line?.mayGo) aside.value = new Set([...aside.value, line.key]);
}

export function toggleList(): void {
  listShown.value = !listShown.value;
}
export function closeList(): boolean {
  const open = listShown.value;
  listShown.value = false;
  return open;
}

/** Points the cursor of plots, tones and timeline at an instant, and shows it there. */
export function pointAt(e_s: number): void {
  const { from, to } = spanNow(shownRun());
  const around_s = 60; // chosen: an instant among its neighbours
  if (!pastRange.value && (e_s < from || e_s > to)) choice.value = { from: e_s - around_s, to: e_s + around_s };
  cursor.value = e_s;
}
