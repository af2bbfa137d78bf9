// SPDX-License-Identifier: Apache-2.0
// Spectra of X-band's samples over time, from packets that the station makes, and their picture.
import type { PacketRow } from '../gen/aeolis/v1/run_pb';
import type { RunStore } from '../run/store';
import { SPECTRUM } from './layout';

/** The spectrum of a second. Frequencies are less the predicted carrier. */
export interface Spectrum {
  e_s: number;
  first_hz: number;
  step_hz: number;
  /** Over the median of all, in half decibels from −30 dB. */
  levels: Uint8Array;
}

const LEAST_DB = 1; // chosen: what noise alone exceeds is faint
const MOST_DB = 12; // chosen: a carrier of 22 dB-Hz has 7 dB in a frequency of 32 Hz

/** What a packet says; undefined where it is not a spectrum as it is known here. */
export function spectrumOf(row: PacketRow, entrySclk: number): Spectrum | undefined {
  const octets = Uint8Array.from(row.hex.match(/../g) ?? [], (each) => Number.parseInt(each, 16));
  const number = (name: string) => {
    const at = (row.fields.find((each) => each.name === name)?.positionBits ?? Number.NaN) / 8;
    return at + 4 <= octets.length ? { end: at + 4, value: new DataView(octets.buffer).getFloat32(at) } : undefined;
  };
  const [first, step] = [number(SPECTRUM.first), number(SPECTRUM.step)];
  if (!row.unit || row.problem !== '' || !first || !step || !(step.value > 0)) return undefined;
  const levels = octets.subarray(step.end, step.end + SPECTRUM.frequencies);
  if (levels.length < SPECTRUM.frequencies) return undefined;
  return { e_s: row.unit.sclk - entrySclk, first_hz: first.value, step_hz: step.value, levels };
}

/** What to say where there is no spectrum yet; undefined: there may be one. */
export function noSpectrum(run: RunStore): string | undefined {
  return run.run.toneModel === 'statistical'
    ? 'no spectrum: no samples are received in this run, its tones are drawn from a statistical model'
    : undefined;
}

/** Opacity of a level, 0 to 255. */
export const opacity = (octet: number): number =>
  Math.round(255 * Math.min(1, Math.max(0, (octet / 2 - 30 - LEAST_DB) / (MOST_DB - LEAST_DB))));

/**
 * The opacities of a picture of `columns` × `lines`, the highest frequency first. The loudest of what shares a pixel
 * shows; a second without a spectrum stays empty.
 */
export function waterfall(
  spectra: readonly Spectrum[],
  time: { from: number; to: number },
  hz: { low: number; high: number },
  columns: number,
  lines: number,
): Uint8ClampedArray {
  const pixels = new Uint8ClampedArray(columns * lines);
  const column = (e_s: number) => ((e_s - time.from) / (time.to - time.from)) * columns;
  for (const { e_s, first_hz, step_hz, levels } of spectra) {
    const left = Math.max(0, Math.floor(column(e_s - 0.5)));
    const right = Math.min(columns, Math.max(left + 1, Math.floor(column(e_s + 0.5))));
    if (right <= left || column(e_s + 0.5) < 0) continue;
    for (let line = 0; line < lines; ++line) {
      const top = hz.high - (line / lines) * (hz.high - hz.low);
      const bottom = hz.high - ((line + 1) / lines) * (hz.high - hz.low);
      const from = Math.round((bottom - first_hz) / step_hz);
      const to = Math.max(from + 1, Math.round((top - first_hz) / step_hz));
      let most = 0;
      for (let i = Math.max(0, from); i < to && i < levels.length; ++i) most = Math.max(most, levels[i] as number);
      const shade = opacity(most);
      for (let x = left; x < right; ++x)
        pixels[line * columns + x] = Math.max(pixels[line * columns + x] as number, shade);
    }
  }
  return pixels;
}
