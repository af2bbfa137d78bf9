// SPDX-License-Identifier: Apache-2.0
// When packets were stale, by all that came of them live and with the recording, as the server tells it.
import { Refused } from './api';
import { read } from './connection';
import { signalOfRun, store } from './shown';
import type { RunStore } from './store';

interface StalenessAnswer {
  packets: readonly { packet: string; stretches: readonly { from_sclk: number; to_sclk?: number }[] }[];
}
export const recordedStaleness = signalOfRun<StalenessAnswer | undefined>(undefined);

const AGAIN_MS = 5000; // chosen: while a recording comes down, since each answer reads all packets

let answered: { run: RunStore; through: number; at_ms: number } | undefined;

/** Asks once there are recorded values, and again when the run has grown. After a failure the next round asks. */
export async function refreshStaleness(): Promise<void> {
  const run = store.value;
  if (!run || run.recorded.size === 0) return;
  const [through, at_ms] = [run.completeThrough, performance.now()]; // later items are for the next answer
  if (answered?.run === run && (answered.through === through || at_ms - answered.at_ms < AGAIN_MS)) return;
  try {
    const answer = await read<StalenessAnswer>(`/runs/${run.id}/staleness`);
    if (store.value === run) recordedStaleness.value = answer;
  } catch (error) {
    if (!(error instanceof Refused && error.status === 400)) return; // 400: a run of another dictionary
  }
  answered = { run, through, at_ms };
}

/**
 * Whether the newest values of a packet by `sclk`, which are of `sample_sclk`, were no longer of that instant. Until
 * the server has answered this is not known, and they count as stale.
 */
export const wasStale = (packet: string, sclk: number, sample_sclk: number): boolean =>
  !recordedStaleness.value ||
  !!recordedStaleness.value.packets
    .find((each) => each.packet === packet)
    ?.stretches.some(
      ({ from_sclk, to_sclk = Infinity }) => from_sclk < sclk && sclk < to_sclk && sample_sclk < from_sclk,
    );
