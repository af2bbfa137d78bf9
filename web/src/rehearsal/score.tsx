// SPDX-License-Identifier: Apache-2.0
// The score of a rehearsal as the server gives it, with what its points rest on: shared by the review and the debrief.
import { fromEntry } from '../run/time';
import { titleOf } from './plan';
import type { Plan } from './plan';

/** The server's answer (schema/aeolis/v1/score.proto). Times in seconds from entry of the signal received then. */
export interface Score {
  facts: readonly { of: string; text: string; e_s?: number }[];
  terms: readonly { name: string; worth: number; points: number; why: string; judged: readonly ScorePoint[] }[];
  sum: number; // of 100
  rule: string;
  faults: readonly ScoreFault[];
  acts: readonly ScoreAct[];
}
/** Something that a good team does, and what was done. */
export interface ScorePoint {
  expected: string;
  evidence: string;
  share: number; // of its part of the term, 0 … 1
  e_s?: number; // from when on it counted
  inject: string; // of the run's plan; empty: none of it
}
/** A fault that was injected. */
export interface ScoreFault {
  text: string;
  inject: string; // of the run's plan; empty: by hand
  e_s: number; // when it was done, by the vehicle's clock
  felt_e_s: number; // from when on its signs could be received
  signs: readonly ScoreSign[];
  seen_e_s?: number; // its first sign
  first_act?: ScoreAct;
  not_judged: readonly string[];
}
export interface ScoreSign {
  name: string;
  on_board_e_s?: number;
  heard_e_s?: number;
}
export interface ScoreAct {
  kind: 'alarm' | 'command' | 'note' | 'procedure' | 'position';
  e_s: number;
  by: string;
  text: string;
}

export const termWords = ({ points, worth }: Score['terms'][number]): string => `${points.toFixed(1)} of ${worth}`;

/** "full", "half", "none", else a percentage that never says 0 or 100. */
export function shareWords(share: number): string {
  if (share >= 1) return 'full';
  if (share <= 0) return 'none';
  return share === 0.5 ? 'half' : `${Math.min(99, Math.max(1, Math.round(share * 100)))} %`;
}

/** The points in order of time; those without a time come last. */
export const inOrder = (points: readonly ScorePoint[]): readonly ScorePoint[] =>
  points.toSorted((one, other) => (one.e_s ?? Number.MAX_VALUE) - (other.e_s ?? Number.MAX_VALUE));

/** What the points of a term rest on. */
export function Points({ of, plan }: { of: readonly ScorePoint[]; plan?: Plan | undefined }) {
  if (of.length === 0) return null;
  return (
    <ul class="score-points">
      {inOrder(of).map((point, i) => (
        <li key={i}>
          <time>{point.e_s === undefined ? '' : fromEntry(point.e_s, { tenths: true })}</time>{' '}
          <b>{shareWords(point.share)}</b>{' '}
          <span>
            {point.expected}: {point.evidence}
            {point.inject && plan && <span class="status-dim"> ({titleOf(plan, point.inject)})</span>}
          </span>
        </li>
      ))}
    </ul>
  );
}
