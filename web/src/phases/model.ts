// SPDX-License-Identifier: Apache-2.0
import { LAYOUT } from '../layout';
import { predictedEvent } from '../prediction/model';
import { inWords } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { RunStore } from '../run/store';
import { countdownWords } from '../situation/countdown';
import { heardOf } from '../timeline/heard';
import type { Prediction } from '../timeline/model';

interface PhaseStep {
  title: string;
  state: 'done' | 'now' | 'ahead';
  detail: string; // the vehicle's own word for its state within the phase
  since_e_s: number | undefined;
  predicted_e_s: number | undefined;
  overdue?: boolean | undefined;
  /** For the present phase: the elapsed fraction, by the prediction of the next phase, 0 … 1. */
  part: number | undefined;
}

interface Group {
  title: string;
  of: readonly string[];
  untilEntry?: string | undefined;
  from?: string | undefined;
}

/**
 * The strip of phases. The newest report of the vehicle decides, by packet or, if that is further, by tone. Before the
 * first report all phases are ahead.
 */
export function phaseSteps(
  store: RunStore | undefined,
  dictionary: Dictionary,
  plan: readonly TimepointRow[],
  cutoff: number,
  predictions: readonly Prediction[] = [],
): PhaseStep[] {
  const channel = dictionary.pick(LAYOUT.phase);
  const labels = new Map(channel?.labels.map((label) => [Number(label.value), label.label]));
  const known = new Set(labels.values());
  const groups: readonly Group[] = LAYOUT.phases.some((phase) => phase.of.some((name) => known.has(name)))
    ? LAYOUT.phases
    : [...known].map((label) => ({ title: inWords(label), of: [label] }));
  const groupOf = (label: string | undefined, e_s: number) =>
    groups.findIndex(
      (group) => label !== undefined && (group.of.includes(label) || (group.untilEntry === label && e_s < 0)),
    );
  const entryKnown = store?.entryKnown !== false;
  // As in the timeline and "waiting for"; without a plan, as the nominal flight has it.
  const listed = (group: Group | undefined) => predictions.find((each) => each.name === group?.from);
  const predicted = (group: Group | undefined) =>
    entryKnown ? (listed(group)?.e_s ?? predictedEvent(group?.from)) : undefined;
  const seen_e_s = store ? Math.min(store.seenSclk, cutoff) - store.entrySclk : NaN;
  const now = channel && store?.latest(channel.id, cutoff);
  const label = now && labels.get(now.value);
  const byPacket = groupOf(label, seen_e_s);
  const toned = store && byTone(store, groups, plan, cutoff);
  const isByTone = toned !== undefined && toned.group > byPacket;
  const at = isByTone ? toned.group : byPacket;
  const since = new Map<number, number>();
  if (channel && store) {
    for (const series of [store.recorded.get(channel.id), store.live.get(channel.id)]) {
      for (let i = 0; series && i < series.length; ++i) {
        const sclk = series.sclk[i] as number;
        if (sclk > cutoff) break;
        const group = groupOf(labels.get(series.value[i] as number), sclk - store.entrySclk);
        if (group >= 0 && !(sclk >= (since.get(group) ?? Infinity))) since.set(group, sclk);
      }
    }
  }
  toned?.since.forEach((sclk, group) => {
    if (isByTone && sclk !== undefined && !since.has(group)) since.set(group, sclk);
  });
  return groups.map((group, index) => {
    const start = entryKnown ? since.get(index) : undefined;
    const since_e_s = start === undefined || !store ? undefined : start - store.entrySclk;
    const next_e_s = predicted(groups[index + 1]);
    return {
      title: group.title,
      state: at < 0 || index > at ? 'ahead' : index === at ? 'now' : 'done',
      detail:
        index === at && isByTone
          ? '■ by tone'
          : index === at && label !== undefined && inWords(label) !== group.title.toLowerCase()
            ? inWords(label)
            : '',
      since_e_s,
      predicted_e_s: predicted(group),
      overdue: listed(group)?.overdue,
      part:
        index !== at || since_e_s === undefined || next_e_s === undefined
          ? undefined
          : Math.max(0, Math.min(1, (seen_e_s - since_e_s) / (next_e_s - since_e_s))),
    };
  });
}

/** The last phase that a tone proves to have begun, and the known beginnings of the phases up to it. */
function byTone(
  store: RunStore,
  groups: readonly Group[],
  plan: readonly TimepointRow[],
  cutoff: number,
): { group: number; since: (number | undefined)[] } | undefined {
  const heard = heardOf(store, plan, cutoff);
  const last = plan.findLastIndex((row) => heard.get(row.id)?.by === 'tone');
  if (last < 0) return undefined;
  const begins = groups.map((group) => plan.findIndex((row) => row.name === group.from));
  const since = begins.map((at) =>
    at < 0 || at > last
      ? undefined
      : heard.get(plan.slice(at).find((row) => heard.has(row.id))?.id ?? -1)?.triggered_sclk,
  );
  return {
    group: Math.max(
      0,
      begins.findLastIndex((at) => at >= 0 && at <= last),
    ),
    since,
  };
}

/** "parachute in ≈ 1 m 20 s", as far as it is predicted; "overdue since E+4:15" where the server says so. */
export function nextWords(steps: readonly PhaseStep[], seen_e_s: number): string {
  const next = steps[steps.findIndex((step) => step.state === 'now') + 1];
  if (next?.state !== 'ahead' || next.predicted_e_s === undefined) return '';
  const title = next.title.toLowerCase();
  return countdownWords(title, next.predicted_e_s, seen_e_s, next.overdue);
}
