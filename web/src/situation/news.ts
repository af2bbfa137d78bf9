// SPDX-License-Identifier: Apache-2.0
// What the ground itself told of a run: news, danger and losses that ended, each once, from when it was first said.
import type { RunStore } from '../run/store';
import { secondsOfErt } from '../run/time';
import type { NamedEntry } from '../stream/names';

export interface News {
  seq: number;
  /** When it was first said, and since when it is so (NaN: not known), in seconds since 1970 on Earth. */
  ert_s: number;
  since_s: number;
  rank: NamedEntry['rank'];
  subject: string;
  sentence: string;
  evidence: string;
}

const isLoss = (subject: string) => subject.startsWith('loss of ');
interface Kept {
  seq: number;
  said: Set<string>;
  news: News[];
}
const kept = new WeakMap<RunStore, Kept>();

/** Oldest first. */
export function newsOf(run: RunStore): readonly News[] {
  const of: Kept = kept.get(run) ?? { seq: 0, said: new Set(), news: [] };
  kept.set(run, of);
  const from = run.situations.findLastIndex(({ seq }) => seq <= of.seq) + 1;
  for (const { seq, ert_s, fact } of run.situations.slice(from)) {
    of.seq = seq;
    for (const { rank, subject, sentence, evidence, sinceUs } of fact.entries) {
      if (rank !== 'danger' && rank !== 'news' && !(rank === 'lasting' && isLoss(subject))) continue;
      // What goes on about it (what is predicted meanwhile, how often) makes no new row.
      const what = `${subject} ${sinceUs} ${shortWords(sentence)}`;
      if (of.said.has(what)) continue;
      of.said.add(what);
      const since_s = sinceUs === 0n ? NaN : secondsOfErt(sinceUs);
      of.news.push({ seq, ert_s, since_s, rank, subject, sentence, evidence });
    }
  }
  return of.news;
}

/** The first words of a sentence: "Flying on backup computer B". */
export const firstWords = (sentence: string): string => sentence.split(/ since | from |, |: /)[0] ?? sentence;
/** Where room is short: "on backup computer B". */
export const shortWords = (sentence: string): string => firstWords(sentence).replace(/^Flying on/, 'on');
