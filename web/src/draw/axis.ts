// Axes: steps that people count in, and the way from seconds to pixels.

const TIME_STEPS_S = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600, 7200, 21600, 43200, 86400];

/** The least step in seconds that gives no more than `most` ticks over `span_s`. */
export function timeStep(span_s: number, most: number): number {
  return TIME_STEPS_S.find((step) => span_s / step <= most) ?? 86400;
}

/** 1, 2, 5 × a power of ten. */
export function valueStep(span: number, most: number): number {
  const raw = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  for (const factor of [1, 2, 5]) if (raw <= factor * power) return factor * power;
  return 10 * power;
}

export function ticks(from: number, to: number, step: number): number[] {
  const all: number[] = [];
  for (let n = Math.ceil(from / step - 1e-9); n * step <= to + step * 1e-9 && all.length < 200; ++n) all.push(n * step);
  return all;
}

/** "E+3:30", "E−10:00", "E+0:01.5": short, for axes. */
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
