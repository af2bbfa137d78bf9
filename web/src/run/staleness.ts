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

let answered: { run: RunStore; progress: number } | undefined;

/** Asks again when the recording of the run shown has grown. After a failure the next round asks. */
export async function refreshStaleness(): Promise<void> {
  const run = store.value;
  const progress = Math.ceil((run?.run.relayProgress ?? 0) * 20);
  if (!run || progress === 0 || (answered?.run === run && answered.progress === progress)) return;
  try {
    const answer = await read<StalenessAnswer>(`/runs/${run.id}/staleness`);
    if (store.value === run) recordedStaleness.value = answer;
  } catch (error) {
    if (!(error instanceof Refused && error.status === 400)) return; // 400: a run of another dictionary
  }
  answered = { run, progress };
}

/**
 * Whether the newest values of a packet by `sclk`, which are of `sample_sclk`, were no longer of that instant. Of no
 * instant is known that they were until the server has answered.
 */
export const wasStale = (packet: string, sclk: number, sample_sclk: number): boolean =>
  !recordedStaleness.value ||
  !!recordedStaleness.value.packets
    .find((each) => each.packet === packet)
    ?.stretches.some(
      ({ from_sclk, to_sclk = Infinity }) => from_sclk < sclk && sclk < to_sclk && sample_sclk < from_sclk,
    );
