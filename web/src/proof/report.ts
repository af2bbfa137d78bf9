// SPDX-License-Identifier: Apache-2.0
// The report of live data against the recording, shared by the panels of verdicts and links.
import type { ProofReport } from '../gen/aeolis/v1/run_pb';
import { reportOfRun } from '../run/report';

const AGAIN_MS = 3000; // chosen: counting a whole run is work for the archive

export const proofOfRun = reportOfRun<ProofReport>('proof', 'proof', AGAIN_MS);
