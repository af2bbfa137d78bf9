// The report of live against recorded, as the panels of verdicts and of links show it: asked for while one of them is open.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { ProofReport } from '../gen/aeolis/v1/run_pb';
import { ask, store } from '../run/session';

export const report = signal<{ run: number; proof: ProofReport } | undefined>(undefined);
export const reportProblem = signal<string | undefined>(undefined);

const AGAIN_MS = 3000; // ours: counting a whole run is work for the archive
let underWay = false;

async function refresh(): Promise<void> {
  const run = store.value;
  if (!run || underWay) return;
  underWay = true;
  try {
    const proof = await ask<ProofReport>('proof', `/runs/${run.id}/proof`);
    if (store.value === run) report.value = { run: run.id, proof };
    reportProblem.value = undefined;
  } catch (error) {
    reportProblem.value = error instanceof Error ? error.message : String(error);
  } finally {
    underWay = false;
  }
}

/** The newest report of the run that is shown; undefined until it has come. */
export function useReport(): ProofReport | undefined {
  const run = store.value;
  useEffect(() => {
    let judged = -1;
    const look = () => {
      const through = store.value?.completeThrough ?? -1;
      if (through === judged && report.value?.run === store.value?.id) return;
      judged = through;
      void refresh();
    };
    look();
    const timer = setInterval(look, AGAIN_MS);
    return () => clearInterval(timer);
  }, [run]);
  return report.value?.run === run?.id ? report.value?.proof : undefined;
}
