import { LAYOUT } from '../layout';
import { inWords } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { RunStore } from '../run/store';

export interface PhaseStep {
  title: string;
  state: 'done' | 'now' | 'ahead';
  detail: string; // the vehicle's own word for where it is in the phase
  since_e_s: number | undefined;
}

/** The strip of phases. What the vehicle said last decides; before it said anything, all are ahead. */
export function phaseSteps(store: RunStore | undefined, dictionary: Dictionary, cutoff: number): PhaseStep[] {
  const channel = dictionary.pick(LAYOUT.phase);
  const labels = new Map(channel?.labels.map((label) => [Number(label.value), label.label]));
  const known = new Set(labels.values());
  const groups: readonly { title: string; of: readonly string[] }[] = LAYOUT.phases.some((phase) => phase.of.some((name) => known.has(name)))
    ? LAYOUT.phases
    : [...known].map((label) => ({ title: inWords(label), of: [label] }));
  const now = channel && store?.latest(channel.id, cutoff);
  const label = now && labels.get(now.value);
  const at = label === undefined ? -1 : groups.findIndex((group) => group.of.includes(label));
  const since = new Map<number, number>();
  if (channel && store) {
    for (const series of [store.recorded.get(channel.id), store.live.get(channel.id)]) {
      for (let i = 0; series && i < series.length; ++i) {
        const sclk = series.sclk[i] as number;
        if (sclk > cutoff) break;
        const group = groups.findIndex((candidate) => candidate.of.includes(labels.get(series.value[i] as number) ?? ''));
        if (group >= 0 && !(sclk >= (since.get(group) ?? Infinity))) since.set(group, sclk);
      }
    }
  }
  return groups.map((group, index) => {
    const start = since.get(index);
    return {
      title: group.title,
      state: at < 0 || index > at ? 'ahead' : index === at ? 'now' : 'done',
      detail: index === at && label !== undefined && inWords(label) !== group.title.toLowerCase() ? inWords(label) : '',
      since_e_s: start === undefined || !store ? undefined : start - store.entrySclk,
    };
  });
}
