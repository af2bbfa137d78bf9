// A verdict as every panel shows it.
import { STATUS } from '../design/status';
import { VERDICT_LOOK } from './model';
import type { Verdict } from './model';

export function Mark({ verdict }: { verdict: string }) {
  const look = VERDICT_LOOK[verdict as Verdict];
  const status = look ? STATUS[look.status] : STATUS.unknown;
  return <span class={`status-${status.token}`} title={look?.means}>{status.shape} {look?.words ?? verdict.replaceAll('_', ' ')}</span>;
}
