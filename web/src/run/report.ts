// SPDX-License-Identifier: Apache-2.0
// A report that the archive counts over a whole run: asked for while a panel shows it, anew once more of the run is there.
import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Question } from '../stream/messages';
import { ask } from './connection';
import { store } from './shown';

interface ReportOfRun<T> {
  /** In a view: the newest of the run that is shown; undefined until it has come. */
  use(): T | undefined;
  problem: Signal<string | undefined>;
}

/** `path` is below /runs/N/. One question at a time, and one that failed is asked again after `again_ms`. */
export function reportOfRun<T>(question: Question, path: string, again_ms: number): ReportOfRun<T> {
  const held = signal<{ run: number; through: number; report: T } | undefined>(undefined);
  const problem = signal<string | undefined>(undefined);
  let underWay = false;
  async function look(): Promise<void> {
    const run = store.value;
    if (!run || underWay || (held.value?.run === run.id && held.value.through === run.completeThrough)) return;
    underWay = true;
    try {
      const through = run.completeThrough; // what comes while it is counted is for the next
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
