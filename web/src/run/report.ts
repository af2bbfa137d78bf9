// SPDX-License-Identifier: Apache-2.0
// A report that the archive computes over a whole run, requested while a panel shows it and again when the run has
// grown.
import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Question } from '../stream/messages';
import { ask } from './connection';
import { store } from './shown';

interface ReportOfRun<T> {
  /** For use in a view: the newest report of the run shown; undefined until it has arrived. */
  use(): T | undefined;
  problem: Signal<string | undefined>;
}

/** Creates a report from `path` below /runs/N/. One request at a time; a failed one is repeated after `again_ms`. */
export function reportOfRun<T>(question: Question, path: string, again_ms: number): ReportOfRun<T> {
  const held = signal<{ run: number; through: number; report: T } | undefined>(undefined);
  const problem = signal<string | undefined>(undefined);
  let underWay = false;
  async function look(): Promise<void> {
    const run = store.value;
    if (!run || underWay || (held.value?.run === run.id && held.value.through === run.completeThrough)) return;
    underWay = true;
    try {
      const through = run.completeThrough; // later items are for the next report
      const report = await ask<T>(question, `/runs/${run.id}/${path}`);
      if (store.value === run) held.value = { run: run.id, through, report };
      problem.value = undefined;
    } catch (error) {
      problem.value = error instanceof Error ? error.message : String(error);
    } finally {
      underWay = false;
    }
    if (store.value !== run) await look();
  }
  return {
    problem,
    use() {
      const run = store.value;
      useEffect(() => {
        void look();
        const timer = setInterval(() => void look(), again_ms);
        return () => clearInterval(timer);
      }, [run]);
      return held.value?.run === run?.id ? held.value?.report : undefined;
    },
  };
}
