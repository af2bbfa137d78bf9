// The stretch of time that timeline, tones and plots show together, in seconds from entry.
import { signal } from '@preact/signals';
import { LAYOUT } from '../layout';
import { pastRange, replay } from './session';
import type { RunStore } from './store';

export type Choice = 'landing' | 'run' | 'minute' | { from: number; to: number };
export const choice = signal<Choice>('landing');

export interface Span {
  from: number;
  to: number;
}

export function spanNow(store: RunStore | undefined): Span {
  if (pastRange.value && !replay.value) return pastRange.value;
  const wanted = choice.value;
  if (typeof wanted === 'object') return wanted;
  const seen = pastRange.value?.to ?? store?.seenE ?? 0;
  const begin = store ? store.run.startSclk - store.entrySclk : LAYOUT.window.from;
  if (wanted === 'run') return { from: Math.min(begin, LAYOUT.window.from), to: Math.max(LAYOUT.window.to, seen + 5) };
  if (wanted === 'minute') return { from: seen - 60, to: seen + 15 };
  // Before the vehicle comes near entry, what matters is the plan that begins with the approach.
  if (seen < LAYOUT.window.from) return { from: Math.max(begin, seen - 240), to: LAYOUT.window.to };
  return { from: LAYOUT.window.from, to: Math.max(LAYOUT.window.to, Math.min(seen + 5, LAYOUT.window.to + 120)) };
}

/** Plots end a little after the newest sample, so that no half of them is empty. */
export function plotSpan(store: RunStore | undefined): Span {
  const span = spanNow(store);
  if ((pastRange.value && !replay.value) || typeof choice.value === 'object' || !store) return span;
  const to = Math.min(span.to, Math.max((pastRange.value?.to ?? store.seenE) + 8, span.from + 60));
  return { from: span.from, to };
}

export function zoom(store: RunStore | undefined, factor: number, around?: number): void {
  if (pastRange.value && !replay.value) return;
  const { from, to } = spanNow(store);
  const middle = around ?? Math.min(to, Math.max(from, store?.seenE ?? (from + to) / 2));
  const width = Math.min(86400 * 3, Math.max(0.5, (to - from) * factor));
  const part = (middle - from) / (to - from);
  choice.value = { from: middle - width * part, to: middle + width * (1 - part) };
}

export function pan(store: RunStore | undefined, part: number): void {
  if (pastRange.value && !replay.value) return;
  const { from, to } = spanNow(store);
  const by = (to - from) * part;
  choice.value = { from: from + by, to: to + by };
}
