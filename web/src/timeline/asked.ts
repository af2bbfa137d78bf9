// SPDX-License-Identifier: Apache-2.0
// The timeline query for the run shown: its state as known at the instant shown, the prediction from it, and the effect
// of the command in the form. Only the server predicts; the page states the instant of each answer.
import { computed } from '@preact/signals';
import { chosen, fields } from '../commands/line';
import type { TimepointList } from '../gen/aeolis/v1/run_pb';
import { asHeard, cutoff, signalOfRun } from '../run/shown';
import type { RunStore } from '../run/store';

/** A query of the route as a text, so that equal queries have equal texts. */
export interface TimelineQuestion {
  text: string;
  /** SCLK; Infinity: now. */
  at: number;
  recorded: boolean;
  /** The command of the form as query text; '' without one. */
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

/** `at_ms`: its arrival by the page's clock. */
export interface TimelineAnswer {
  asked: TimelineQuestion;
  list: TimepointList;
  at_ms: number;
}
export const timelineAnswer = signalOfRun<TimelineAnswer | undefined>(undefined);

/** The newest answer, unless it belongs to another view of the run or knows later data than the instant shown. */
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

const EVERY_MS = 1000; // chosen: during a run the times of overdue timepoints advance
const AFTER_FAILURE_MS = 2000;

/** Decides when to ask again: for another run, another query, news of the timeline, and regularly during a run. */
export class TimelinePace {
  private last: { of: RunStore; text: string; version: number; at_ms: number; failed: boolean } | undefined;

  isDue(of: RunStore, text: string, now_ms: number): boolean {
    const { last } = this;
    if (last?.of !== of || last.text !== text) return true;
    if (last.failed) return now_ms - last.at_ms >= AFTER_FAILURE_MS;
    return last.version !== of.timelineVersion || (of.going && now_ms - last.at_ms >= EVERY_MS);
  }
  /** `version`: that of the run when the query was sent. */
  asked(of: RunStore, text: string, version: number, at_ms: number, failed: boolean): void {
    this.last = { of, text, version, at_ms, failed };
  }
}
