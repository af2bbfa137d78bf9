// SPDX-License-Identifier: Apache-2.0
import { alsoCalled } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { fromEntry, secondsOfErt } from '../run/time';
import type { NamedLink, NamedTone } from '../stream/names';

interface ToneBar {
  from_e_s: number;
  to_e_s: number;
  tone: number | undefined; // undefined: an erasure
  likelihood: number;
}

const SYMBOL_S = 10; // R31: one tone takes 10 s

export function toneBars(store: RunStore, cutoff: number): ToneBar[] {
  const bars: ToneBar[] = [];
  for (const { fact, ert_s } of store.tonesBy(cutoff)) {
    const span = ert_s - secondsOfErt(fact.ertStartUs);
    const from = fact.sclk - store.entrySclk;
    bars.push({
      from_e_s: from,
      to_e_s: from + (span > 0 ? span : SYMBOL_S),
      tone: fact.tone,
      likelihood: fact.likelihood,
    });
  }
  return bars;
}

/** The ground's last word on X-band, which sends the tones. */
export const toneSilence = (store: RunStore, cutoff: number): NamedLink | undefined =>
  store.links.get('x_band')?.findLast((change) => !(store.sclkSeenAt(change.ert_s) > cutoff))?.fact;

export function latestTone(store: RunStore, cutoff: number): NamedTone | undefined {
  return store.tonesBy(cutoff).at(-1)?.fact;
}

/** The symbol at `sclk`, or the newest by `cutoff` if none is chosen or the chosen one is later. */
export function shownTone(store: RunStore, cutoff: number, chosen_sclk: number | undefined): NamedTone | undefined {
  const chosen =
    chosen_sclk === undefined || chosen_sclk > cutoff
      ? undefined
      : store.tonesBy(cutoff).find(({ fact }) => fact.sclk === chosen_sclk)?.fact;
  return chosen ?? latestTone(store, cutoff);
}

/**
 * SCLK of the symbol before or after the one at `sclk`. Undefined at the newest symbol, which is the default and
 * advances.
 */
export function neighbour(
  store: RunStore,
  cutoff: number,
  sclk: number | undefined,
  direction: 1 | -1,
): number | undefined {
  const all = store.tonesBy(cutoff).map(({ fact }) => fact.sclk);
  const at = sclk === undefined ? all.length - 1 : all.indexOf(sclk);
  const to = Math.max(0, at + direction);
  return to >= all.length - 1 ? undefined : all[to];
}

/**
 * Whether the newest tone is the last one heard and no present report: the ground does not say that X-band is up.
 * Nothing is of now without a connection (`lost`), nor after the end of a run.
 */
export const isLast = (store: RunStore, cutoff: number, lost: boolean): boolean =>
  (cutoff === Infinity && (lost || !store.going)) || toneSilence(store, cutoff)?.up !== true;

/** The title: the present tone, or the last one heard and its time. */
export function toneTitle(tone: NamedTone | undefined, last_e_s?: number): string {
  if (!tone) return 'Tones';
  const meaning =
    tone.tone === undefined
      ? 'not decoded'
      : `${tone.tone} · ${alsoCalled(tone.meaning || tone.name || 'without a meaning')}`;
  return last_e_s === undefined ? `Tone ${meaning}` : `Last tone, ${fromEntry(last_e_s)}: ${meaning}`;
}

function lockInWords(tone: NamedTone): string {
  if (tone.locked) return `■ lock, ${tone.cN0Dbhz.toFixed(1)} dB-Hz`;
  if (tone.lock === 'fluctuating' || tone.lock === 'coasting')
    return `▨ ${tone.lock}, ${tone.cN0Dbhz.toFixed(1)} dB-Hz`;
  return '□ no lock';
}

/** The received best tones with their likelihoods. */
export function bestTones(tone: NamedTone | undefined): string {
  return (tone?.best ?? []).map((each) => `${each.tone}: ${each.likelihood.toFixed(4)}`).join(' · ');
}

interface SpectrumLine {
  tone: number; // this tone and the next one
  level_db: number; // energy over noise
}

/** The receiver's spectrum of tones; empty for a decision without a signal. */
export function toneSpectrum(tone: NamedTone | undefined): SpectrumLine[] {
  return Array.from(tone?.spectrum ?? [], (octet, index) => ({ tone: 2 * index, level_db: octet / 2 - 30 }));
}

/** A posterior probability; what rounds to one is not certain. */
export const posteriorText = (probability: number): string =>
  probability >= 0.9995 ? 'above 0.999' : probability.toFixed(3);

/** `link`: what the ground says last of X-band's tones. */
export function toneEvidence(tone: NamedTone | undefined, link?: NamedLink): string {
  if (!tone && link?.silence === 'not_begun')
    return `tones have not begun${link.reason.slice(link.reason.indexOf(':'))}`;
  if (!tone) return 'one of 256, each for 10 s';
  const parts: string[] = [];
  if (tone.tone !== undefined) parts.push(`likelihood ${posteriorText(tone.likelihood)}`);
  if (tone.runnerUp !== undefined) {
    const next = tone.runnerUpLikelihood;
    parts.push(`next ${tone.runnerUp} ${next < 0.0005 ? 'below 0.001' : `at ${next.toFixed(3)}`}`);
  }
  parts.push(lockInWords(tone));
  if (tone.dopplerHz !== 0) parts.push(`Doppler ${(tone.dopplerHz / 1000).toFixed(1).replace('-', '−')} kHz`);
  if (tone.model === 'statistical') parts.push('drawn by a statistical model');
  return parts.join(' · ');
}
