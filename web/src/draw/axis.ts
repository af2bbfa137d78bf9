// SPDX-License-Identifier: Apache-2.0
// Axes: round steps, and the conversion from seconds to pixels.

const TIME_STEPS_S = [
  0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 180, 300, 600, 1800, 3600, 7200, 21600, 43200, 86400,
];

/** The smallest step in seconds that gives at most `most` ticks over `span_s`. */
export function timeStep(span_s: number, most: number): number {
  return TIME_STEPS_S.find((step) => span_s / step <= most) ?? 86400;
}

/** The smallest 1, 2 or 5 × a power of ten. */
export function valueStep(span: number, most: number): number {
  const raw = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  for (const factor of [1, 2, 5]) if (raw <= factor * power) return factor * power;
  return 10 * power;
}

const APART_PX = 26; // between the numbers of an axis, where there is room
const LEAST_APART_PX = 14;

/** The ticks of values, by one rule for all plots: round numbers, and two at least where they are legible. */
export function valueTicks(low: number, high: number, high_px: number): number[] {
  for (const apart_px of [APART_PX, 20, LEAST_APART_PX]) {
    const all = ticks(low, high, valueStep(high - low, Math.floor(high_px / apart_px))).filter(
      (each) => each >= low && each <= high,
    );
    if (all.length > 1) return all;
  }
  return ticks(low, high, valueStep(high - low, 1));
}

/**
 * The ticks of an axis that is linear about zero and logarithmic above `linear_below`: zero and powers of ten, those
 * that are apart; round numbers, if fewer than two of them are in sight.
 */
export function decadeTicks(low: number, high: number, high_px: number, linear_below: number): number[] {
  const at = (value: number) => Math.asinh(value / linear_below);
  const px = high_px / (at(high) - at(low));
  const shown = low <= 0 && high >= 0 ? [0] : [];
  const decades = Math.ceil(Math.log10(Math.max(high, -low) / linear_below));
  for (let power = decades; power >= 0; --power)
    for (const sign of [1, -1]) {
      const value = sign * Number((linear_below * 10 ** power).toPrecision(1));
      const isApart = shown.every((other) => Math.abs(at(value) - at(other)) * px >= LEAST_APART_PX);
      if (value >= low && value <= high && isApart) shown.push(value);
    }
  return shown.length > 1 ? shown.sort((one, other) => one - other) : valueTicks(low, high, high_px);
}

export function ticks(from: number, to: number, step: number): number[] {
  const all: number[] = [];
  for (let n = Math.ceil(from / step - 1e-9); n * step <= to + step * 1e-9 && all.length < 200; ++n) all.push(n * step);
  return all;
}

/** "E+3:30", "E−10:00", "E+0:01.5": short labels for axes. */
export function axisTime(e_s: number, step_s: number): string {
  const sign = e_s < 0 ? '−' : '+';
  const tenths = Math.round(Math.abs(e_s) * 10);
  const whole = Math.floor(tenths / 10);
  const seconds = String(whole % 60).padStart(2, '0') + (step_s < 1 ? `.${tenths % 10}` : '');
  const minutes = Math.floor(whole / 60);
  return minutes >= 60
    ? `E${sign}${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, '0')}:${seconds}`
    : `E${sign}${minutes}:${seconds}`;
}

/** The label of an instant of a run whose time of entry is not known: seconds of its clock. */
const clockTime = (sclk: number, step_s: number): string => sclk.toFixed(step_s < 1 ? 1 : 0);

/** How instants are written on an axis, long or short, of a run whose entry is known or not. */
export const timeLabel = (entryKnown: boolean): typeof axisTime => (entryKnown ? axisTime : clockTime);
export const shortLabel = (entryKnown: boolean): typeof axisTime => (entryKnown ? shortTime : clockTime);

/** "+3:30", "−0:10", "E" at entry: labels for a plot, where every letter costs a tick. */
export function shortTime(e_s: number, step_s: number): string {
  return Math.abs(e_s) < step_s / 2 ? 'E' : axisTime(e_s, step_s).slice(1);
}

export const CHARACTER_PX = 6.7; // of the axes' 11 px mono
const BETWEEN_PX = 14;

/** The smallest step whose short labels fit side by side in `wide_px`. */
export function shortStep(from_e_s: number, to_e_s: number, wide_px: number, label = shortTime): number {
  return (
    TIME_STEPS_S.find((step) => {
      const longest = Math.max(label(from_e_s, step).length, label(to_e_s, step).length);
      return (step / (to_e_s - from_e_s)) * wide_px >= longest * CHARACTER_PX + BETWEEN_PX;
    }) ?? 86400
  );
}

/** "6 000", "−0.25": the shortest exact text, independent of locale. */
export function axisNumber(value: number): string {
  const [whole = '', part] = String(Number(Math.abs(value).toPrecision(12))).split('.');
  return `${value < 0 ? '−' : ''}${/^\d+$/.test(whole) ? whole.replace(/\B(?=(\d{3})+$)/g, '\u2009') : whole}${part === undefined ? '' : `.${part}`}`;
}
