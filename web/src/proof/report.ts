// SPDX-License-Identifier: Apache-2.0
// The report of live against recorded, as the panels of verdicts and of links show it.
import type { ProofReport } from '../gen/aeolis/v1/run_pb';
import { reportOfRun } from '../run/report';

const AGAIN_MS = 3000; // ours: counting a whole run is work for the archive

export const proofOfRun = reportOfRun<ProofReport>('proof', 'proof', AGAIN_MS);
