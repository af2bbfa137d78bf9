// SPDX-License-Identifier: Apache-2.0
// The alarm limits in force, as the server tells them. Those of a channel whose limits have no contexts always hold.
import type { AlarmLimit, DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { Refused } from './api';
import { read } from './connection';
import { asHeard, signalOfRun, store } from './shown';

const WORST: ReadonlySet<string> = new Set(['distress', 'critical', 'severe']);

/** Whether a severity has the colour of alarms; lower ones have that of caution. */
export const isWorst = (severity: string): boolean => WORST.has(severity);

type Limit = Pick<AlarmLimit, 'severity' | 'below' | 'above'>;
/** In the API's words: no beginning is the beginning of the run, and no end means that they still hold. */
export interface LimitStretch {
  from_sclk?: number;
  to_sclk?: number;
  context: string;
  limits: readonly Limit[];
}
export interface LimitsAnswer {
  channels: readonly { id: number; stretches: readonly LimitStretch[] }[];
  decided_by: readonly number[];
}
/** `live`: by live samples alone. */
export const limitsAnswer = signalOfRun<{ live: boolean; answer: LimitsAnswer } | undefined>(undefined);

let underWay = false;
let answered = '';

/** Asks for the limits of the run shown if they may have changed: after a new value of a channel that decides. */
export async function refreshLimits(): Promise<void> {
  const run = store.value;
  if (!run || underWay) return;
  const live = asHeard.peek();
  const values = limitsAnswer.peek()?.answer.decided_by.map((id) => run.latest(id)?.value) ?? [undefined];
  const question = [run.id, live, Math.floor(run.run.relayProgress * 20), ...values].join();
  if (question === answered) return;
  underWay = true;
  try {
    const answer = await read<LimitsAnswer>(`/runs/${run.id}/limits${live ? '?recorded=false' : ''}`);
    answered = question;
    if (store.value === run) limitsAnswer.value = { live, answer };
  } catch (error) {
    if (error instanceof Refused && error.status === 400) answered = question; // a run of another dictionary
  } finally {
    underWay = false; // after another failure the next round asks again
  }
}

/** By time; undefined while not known. */
function stretchesOf({ id, limits }: DictionaryChannel): readonly LimitStretch[] | undefined {
  const known = limitsAnswer.value;
  if (limits.every(({ context }) => context === '')) return [{ context: '', limits }];
  return known?.live === asHeard.value ? known.answer.channels.find((each) => each.id === id)?.stretches : undefined;
}

/** The limits at an instant, Infinity for now; undefined while not known. */
export const limitsAt = (channel: DictionaryChannel, sclk: number): LimitStretch | undefined =>
  stretchesOf(channel)?.findLast(({ from_sclk = -Infinity }) => from_sclk <= sclk);

/** The limits over [from, to], as stretches that end there. */
export function limitsOver(
  channel: DictionaryChannel,
  from: number,
  to: number,
): (LimitStretch & Required<Pick<LimitStretch, 'from_sclk' | 'to_sclk'>>)[] {
  return (stretchesOf(channel) ?? [])
    .map((each) => ({
      ...each,
      from_sclk: Math.max(from, each.from_sclk ?? -Infinity),
      to_sclk: Math.min(to, each.to_sclk ?? Infinity),
    }))
    .filter(({ from_sclk, to_sclk, limits }) => from_sclk < to_sclk && limits.length > 0);
}

/** "watch > 7; critical < −3 or > 2", in the order of the dictionary. */
export function limitsText(limits: readonly Limit[]): string {
  return limits.map((limit) => `${limit.severity} ${boundsText(limit)}`).join('; ');
}

function boundsText({ below, above }: Limit): string {
  const parts = [below === undefined ? '' : `< ${below}`, above === undefined ? '' : `> ${above}`];
  return parts.filter(Boolean).join(' or ');
}

/** All limits of a channel, each context with its name. */
export function allLimitsText(channel: DictionaryChannel): string {
  const contexts = [...new Set(channel.limits.map((limit) => limit.context))];
  return contexts
    .map((context) => {
      const words = limitsText(channel.limits.filter((limit) => limit.context === context));
      return contexts.length === 1 && context === ''
        ? words
        : `${context === '' ? 'else' : `in ${context.replaceAll('_', ' ')}`}: ${words}`;
    })
    .join('\n');
}
