// SPDX-License-Identifier: Apache-2.0
// Each link: its reported state and silences, its traffic, and the damaged part of it.
import type { LinkCounters, ProofReport, SequenceCounters } from '../gen/aeolis/v1/run_pb';
import { linkLook } from '../design/status';
import type { LinkLook } from '../design/status';
import { linkTotals } from '../packets/model';
import type { RunStore } from '../run/store';
import { outages } from '../timeline/model';
import type { Outage } from '../timeline/model';

/** "uhf_live" → "UHF", "uhf_mro" → "UHF MRO", "relay" → "Relay". Its state is a word beside it. */
export function linkTitle(link: string): string {
  if (link === 'uhf_live') return 'UHF';
  if (link === 'x_band') return 'X-band';
  if (link === 'x_band_telemetry') return 'X-band telemetry';
  const [kind = '', ...rest] = link.split('_');
  const title = kind === 'uhf' ? 'UHF' : kind === 'relay' ? 'Relay' : kind;
  return [title, ...rest.map((part) => part.toUpperCase())].join(' ').trim();
}

export interface LinkView {
  link: string;
  state: LinkLook;
  reason: string;
  since_e_s: number | undefined;
  silences: Outage[];
  packets: number;
  octets: number;
  seenBefore: number;
  counters: LinkCounters | undefined;
  judged: { live: number; identical: number; recorded: number; neverLive: number } | undefined;
}

/** `lost`: there is no connection, so the present state of a link is not known. */
export function linkViews(store: RunStore, proof: ProofReport | undefined, cutoff: number, lost = false): LinkView[] {
  const totals = new Map(linkTotals(store).map((each) => [each.link, each]));
  const names = new Set([
    ...store.links.keys(),
    ...totals.keys(),
    ...(proof?.counters.map((each) => each.link) ?? []),
    ...(proof?.links.map((each) => each.name) ?? []),
  ]);
  const now = Math.min(store.seenSclk, cutoff) - store.entrySclk;
  names.delete('station'); // no link: what ground measures itself
  return [...names].sort(byImportance).map((link) => {
    const silent = lost && cutoff === Infinity && store.going;
    const known = (store.links.get(link) ?? []).findLast((change) => !(store.sclkSeenAt(change.ert_s) > cutoff));
    const last = known?.fact;
    const total = totals.get(link);
    const judged = proof?.links.find((row) => row.name === link);
    return {
      link,
      state: last === undefined || silent ? 'unknown' : linkLook(last),
      reason: silent ? 'no connection' : (last?.reason ?? ''),
      since_e_s: known && store.sclkSeenAt(known.ert_s) - store.entrySclk,
      silences: outages(store, link, now, cutoff),
      packets: total?.packets ?? 0,
      octets: total?.octets ?? 0,
      seenBefore: total?.duplicates ?? 0,
      counters: proof?.counters.find((each) => each.link === link),
      judged: judged && {
        live: Number(judged.realtime),
        identical: Number(judged.identical),
        recorded: Number(judged.recorded),
        neverLive: Number(judged.neverSeenLive),
      },
    };
  });
}

const ORDER = ['uhf_live', 'x_band_telemetry', 'uhf', 'x', 'relay'];
function byImportance(a: string, b: string): number {
  const rank = (name: string) => ORDER.findIndex((each) => name === each || name.startsWith(`${each}_`));
  return rank(a) - rank(b) || a.localeCompare(b);
}

/** Fraction of the expected frames that arrived, 0 … 1; undefined if none was expected. */
export function framesKept(counters: LinkCounters): number | undefined {
  const due = Number(counters.frames) + Number(counters.missingFrames);
  return due === 0 ? undefined : Number(counters.frames) / due;
}

/** The sequences of all links: those first whose counts are not in order, then as they come. */
export function sequenceRows(views: LinkView[]): { link: string; counted: SequenceCounters }[] {
  const rows = views.flatMap(({ link, counters }) => (counters?.sequences ?? []).map((counted) => ({ link, counted })));
  const calm = ({ counted }: { counted: SequenceCounters }) =>
    counted.missing + counted.repeated + counted.late + counted.restarts === 0n ? 1 : 0;
  return rows.sort((a, b) => calm(a) - calm(b));
}
