// SPDX-License-Identifier: Apache-2.0
// A verdict, drawn the same in every panel.
import { STATUS, VERDICTS } from '../design/status';
import type { Verdict } from '../design/status';

export function Mark({ verdict }: { verdict: string }) {
  const look = verdict in VERDICTS ? VERDICTS[verdict as Verdict] : undefined;
  const status = look ? STATUS[look.status] : STATUS.unknown;
  return (
    <span class={`status-${status.token}`} title={look?.means}>
      {status.shape} {look?.words ?? verdict.replaceAll('_', ' ')}
    </span>
  );
}
