// SPDX-License-Identifier: Apache-2.0
// Times in the notation of controllers. All of them come from the stream; the browser's clock is never read.

const DAY_S = 86400;
const EPOCH_S = Date.UTC(2000, 0, 1, 12) / 1000; // epoch of the stream's times

/**
 * Converts a time of the stream to seconds since 1970: microseconds since 2000-01-01T12:00:00 UTC, in JSON a text of
 * digits; NaN for none.
 */
export const secondsOfErt = (ert_us: bigint | string | undefined): number => EPOCH_S + Number(ert_us) / 1e6;

/** Converts "2012-219T05:10:47.400" (year, day of year; UTC) to seconds since 1970; NaN for other texts. */
export function secondsOfDayOfYear(text: string): number {
  const parts = /^(\d{4})-(\d{3})T(\d{2}):(\d{2}):(\d{2}(?:\.\d+)?)Z?$/.exec(text);
  if (!parts) return NaN;
  const [, year, day, hours, minutes, seconds] = parts.map(Number) as [number, number, number, number, number, number];
  return Date.UTC(year, 0, 1) / 1000 + (day - 1) * DAY_S + hours * 3600 + minutes * 60 + seconds;
}

/** The reverse, to a tenth of a second or the given digits; truncated, not rounded, like a clock. */
export function dayOfYear(seconds: number, digits = 1): string {
  if (!Number.isFinite(seconds)) return '—';
  const unit = 10 ** digits;
  const count = Math.floor(seconds * unit + unit * 4e-7);
  const date = new Date(Math.floor(count / unit) * 1000);
  const year = date.getUTCFullYear();
  const day = Math.floor((date.getTime() - Date.UTC(year, 0, 1)) / 1000 / DAY_S) + 1;
  return `${year}-${pad(day, 3)}T${date.toISOString().slice(11, 19)}.${pad(count % unit, digits)}`;
}

/** "E+4:58", "E−19:02", "E+1:02:03"; with tenths "E+4:28.3". Truncated like a clock; with tenths rounded. */
export function fromEntry(e_s: number, options: { tenths?: boolean } = {}): string {
  if (!Number.isFinite(e_s)) return 'E —';
  const unit = options.tenths ? 10 : 1;
  const count = options.tenths ? Math.round(e_s * 10) : Math.floor(e_s + 1e-6);
  const sign = count < 0 ? '−' : '+';
  const all = Math.abs(count);
  const whole = Math.floor(all / unit);
  const [hours, minutes, seconds] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, pad(whole % 60, 2)];
  const text = hours > 0 ? `${hours}:${pad(minutes, 2)}:${seconds}` : `${minutes}:${seconds}`;
  return `E${sign}${text}${options.tenths ? `.${all % 10}` : ''}`;
}

/** "13 m 48.1 s", "0 s": a duration. */
export function duration(seconds: number): string {
  if (!Number.isFinite(seconds)) return '—';
  const all = Math.abs(seconds);
  const sign = seconds < 0 ? '−' : '';
  if (all === 0) return '0 s';
  if (all < 60) return `${sign}${all.toFixed(1)} s`;
  if (all < 3600) return `${sign}${Math.floor(all / 60)} m ${pad(Math.floor(all % 60), 2)} s`;
  return `${sign}${Math.floor(all / 3600)} h ${pad(Math.floor(all / 60) % 60, 2)} m`;
}

/** Reads "E+3:20", "-120", "200.5", "4:28" as seconds from entry; undefined for other texts. */
export function readFromEntry(text: string): number | undefined {
  const parts = /^\s*e?\s*([+\-−]?)\s*(?:(?:(\d+):)?(\d+):)?(\d+(?:\.\d+)?)\s*s?\s*$/i.exec(text);
  if (!parts) return undefined;
  const value = Number(parts[2] ?? 0) * 3600 + Number(parts[3] ?? 0) * 60 + Number(parts[4]);
  return parts[1] === '-' || parts[1] === '−' ? -value : value;
}

function pad(value: number, digits: number): string {
  return String(value).padStart(digits, '0');
}
