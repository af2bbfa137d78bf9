// SPDX-License-Identifier: Apache-2.0
// The X-band carrier as ground's receiver has it: channels that the station makes, and the features of the flight that
// its Doppler shows.
import { staleWords } from '../channels/model';
import { inWords } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { Series } from '../run/series';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { CARRIER } from './layout';

const seriesOf = (run: RunStore, words: Dictionary, names: readonly string[]): Series | undefined => {
  const channel = words.pick(names);
  return channel && run.live.get(channel.id);
};

/** Whether the dictionary has a carrier at all. */
export const isKnown = (words: Dictionary | undefined): boolean => words?.pick(CARRIER.residual) !== undefined;

const signed = (value: number, digits: number) => `${value < 0 ? '−' : '+'}${Math.abs(value).toFixed(digits)}`;

/** What the receiver says of the carrier at `cutoff`: nothing of the present once the ground says that it is stale. */
export function carrierWords(run: RunStore, words: Dictionary, cutoff: number, lost: boolean): string {
  const [lock, residual, sigma, rate, level] = [
    CARRIER.lock,
    CARRIER.residual,
    CARRIER.sigma,
    CARRIER.rate,
    CARRIER.level,
  ].map((names) => seriesOf(run, words, names)?.at(cutoff));
  if (!lock) return 'no carrier was followed yet';
  const channel = words.pick(CARRIER.lock);
  const state = (channel && words.label(channel, lock.value)) ?? String(lock.value);
  const at = fromEntry(lock.sclk - run.entrySclk);
  if (state === CARRIER.lost) return `lost since ${at}`;
  const old = staleWords(run, channel, cutoff, lost) !== undefined;
  const said = old ? `last at ${at}: ${inWords(state)}` : inWords(state);
  if (!residual || residual.sclk !== lock.sclk || Number.isNaN(residual.value)) return `${said}, not found at ${at}`;
  const parts = [
    `${signed(residual.value, 2)} Hz from the predict${sigma ? ` (deviation ${sigma.value.toFixed(2)} Hz)` : ''}`,
    rate && `${signed(rate.value, 1)} Hz/s`,
    level && `C/N0 ${level.value.toFixed(1)} dB-Hz`,
  ];
  return [said, ...parts.filter((part) => part)].join(' · ');
}

/** The residuals of a stretch as lines: each goes through estimates without a gap. The page holds them thinned. */
export function residualLines(
  run: RunStore,
  words: Dictionary,
  from_e_s: number,
  to_e_s: number,
  cutoff: number,
): { e_s: number; hz: number }[][] {
  const series = seriesOf(run, words, CARRIER.residual);
  const lines: { e_s: number; hz: number }[][] = [];
  if (!series) return lines;
  const gap_s = Math.max(1, 3 * run.spacing(words.pick(CARRIER.residual)?.id ?? 0));
  let last = -Infinity;
  for (let i = Math.max(0, series.firstAfter(from_e_s + run.entrySclk) - 1); i < series.length; ++i) {
    const [sclk, hz] = [series.sclk[i] as number, series.value[i] as number];
    if (sclk > Math.min(cutoff, to_e_s + run.entrySclk)) break;
    if (Number.isNaN(hz)) {
      last = -Infinity; // not found: no line goes through what is not known
      continue;
    }
    if (sclk - last > gap_s) lines.push([]);
    last = sclk;
    lines.at(-1)?.push({ e_s: sclk - run.entrySclk, hz });
  }
  return lines;
}
