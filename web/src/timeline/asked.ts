// SPDX-License-Identifier: Apache-2.0
// What is asked of the server about the timeline of the run that is shown: as it was known at the instant that is looked at, predicted from
// that, and with what the command in the form would move. The server alone predicts; the page says of which instant an answer is.
import { computed } from '@preact/signals';
import { chosen, fields } from '../commands/line';
import type { TimepointList } from '../gen/aeolis/v1/run_pb';
import { asHeard, cutoff, signalOfRun } from '../run/shown';
import type { RunStore } from '../run/store';

/** In words of the route, so that two of the same text ask the same. */
export interface TimelineQuestion {
  text: string;
  /** SCLK; Infinity: now. */
  at: number;
  recorded: boolean;
  /** Of the form; '' without one. */
  command: string;
}

const command = computed(() => {
  const known = fields.value.filter((field) => field.value !== undefined && field.problem === undefined);
  if (!chosen.value) return '';
  const values = known.map((field) => `${field.argument.name}=${field.value}`);
  return new URLSearchParams({ command: chosen.value.name, arguments: values.join(',') }).toString();
});

export const timelineQuestion = computed<TimelineQuestion>(() => {
  const [at, recorded] = [cutoff.value, !asHeard.value];
  const parts = [at === Infinity ? '' : `at=${at}`, recorded ? '' : 'recorded=false', command.value].filter(
    (part) => part !== '',
  );
  return { text: parts.length === 0 ? '' : `?${parts.join('&')}`, at, recorded, command: command.value };
});

/** `at_ms`: when it came, by the page's clock. */
export interface TimelineAnswer {
  asked: TimelineQuestion;
  list: TimepointList;
  at_ms: number;
}
export const timelineAnswer = signalOfRun<TimelineAnswer | undefined>(undefined);

/** The newest answer, unless it is of another view of the run, or knows what came after the instant that is looked at. */
export const timelineKnown = computed(() => {
  const answer = timelineAnswer.value;
  const now = timelineQuestion.value;
  if (!answer || answer.asked.recorded !== now.recorded) return undefined;
  return now.at === Infinity
    ? answer.asked.at === Infinity
      ? answer
      : undefined
    : answer.asked.at <= now.at
      ? answer
      : undefined;
});

const EVERY_MS = 1000; // ours: while the run goes on, what is overdue moves
const AFTER_FAILURE_MS = 2000;

/** When to ask again: another run, another question, news of the timeline, and now and then while the run goes on. */
export class TimelinePace {
  private last: { of: RunStore; text: string; version: number; at_ms: number; failed: boolean } | undefined;

  isDue(of: RunStore, text: string, now_ms: number): boolean {
    const { last } = this;
    if (last?.of !== of || last.text !== text) return true;
    if (last.failed) return now_ms - last.at_ms >= AFTER_FAILURE_MS;
    return last.version !== of.timelineVersion || (of.going && now_ms - last.at_ms >= EVERY_MS);
  }
  /** `version`: of the run as the question was asked. */
  asked(of: RunStore, text: string, version: number, at_ms: number, failed: boolean): void {
    this.last = { of, text, version, at_ms, failed };
  }
}
