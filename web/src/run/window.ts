// SPDX-License-Identifier: Apache-2.0
// The stretch of time that timeline, tones and plots share, in seconds from entry.
import { signal } from '@preact/signals';
import { LAYOUT } from '../layout';
import { pastRange, replay } from './shown';
import type { RunStore } from './store';

export type Choice = 'landing' | 'run' | 'minute' | { from: number; to: number };
export const choice = signal<Choice>('landing');

interface Span {
  from: number;
  to: number;
}

/** The zoomed stretch within a fixed range. */
const inRange = signal<{ of: Span; span: Span } | undefined>(undefined);
const fixedRange = (): Span | undefined => (replay.value ? undefined : pastRange.value);

/** The zoomed or panned stretch; undefined if the display follows the run or shows a whole range. */
export function zoomedTo(): Span | undefined {
  const range = fixedRange();
  if (range) return inRange.value?.of === range ? inRange.value.span : undefined;
  return typeof choice.value === 'object' ? choice.value : undefined;
}

/** Shows a stretch; within a fixed range it stays inside. */
export function look(from: number, to: number): void {
  const range = fixedRange();
  if (!range) {
    choice.value = { from, to };
    return;
  }
  if (from >= range.from && to <= range.to) {
    inRange.value = { of: range, span: { from, to } };
    return;
  }
  const width = Math.min(to - from, range.to - range.from);
  const begin = Math.min(Math.max(from, range.from), range.to - width);
  inRange.value = { of: range, span: { from: begin, to: begin + width } };
}

export function spanNow(store: RunStore | undefined): Span {
  const fixed = zoomedTo() ?? fixedRange();
  if (fixed) return fixed;
  const wanted = choice.value;
  const seen = pastRange.value?.to ?? store?.seenE ?? 0;
  // The signal seen on Earth at the beginning of a run is one light time old.
  const begin = store ? store.run.startSclk - store.entrySclk - store.run.lightTimeS : LAYOUT.window.from;
  if (wanted === 'run') return { from: Math.min(begin, LAYOUT.window.from), to: Math.max(LAYOUT.window.to, seen + 5) };
  if (wanted === 'minute' || store?.entryKnown === false) return { from: seen - 60, to: seen + 15 };
  // Far from entry, the plan from the approach on is what matters.
  if (seen < LAYOUT.window.from) return { from: Math.max(begin, seen - 240), to: LAYOUT.window.to };
  return { from: LAYOUT.window.from, to: Math.max(LAYOUT.window.to, Math.min(seen + 5, LAYOUT.window.to + 120)) };
}

/**
 * The stretch of plots and tones ends shortly after the newest sample, so that they are not half empty; with a prediction
 * drawn ahead it is that of the timeline.
 */
export function plotSpan(store: RunStore | undefined, isAhead = false): Span {
  const span = spanNow(store);
  if (isAhead || zoomedTo() || fixedRange() || !store) return span;
  const to = Math.min(span.to, Math.max((pastRange.value?.to ?? store.seenE) + 8, span.from + 60));
  return { from: span.from, to };
}

/**
 * The stretch of a plot of one channel. Packets of a followed mission may have clocks of their own: where the channel's
 * newest sample lies outside the common stretch, the plot ends at that sample.
 */
export function plotSpanOf(store: RunStore | undefined, channel: number, isAhead = false): Span {
  const span = plotSpan(store, isAhead);
  if (!store || store.entryKnown || zoomedTo() || fixedRange()) return span;
  const newest = store.latest(channel)?.sclk;
  if (newest === undefined || (newest - store.entrySclk >= span.from && newest - store.entrySclk <= span.to))
    return span;
  const to = newest - store.entrySclk + 8;
  return { from: to - (span.to - span.from), to };
}

export function zoom(store: RunStore | undefined, factor: number, around?: number): void {
  const { from, to } = spanNow(store);
  const middle =
    around ?? (fixedRange() ? (from + to) / 2 : Math.min(to, Math.max(from, store?.seenE ?? (from + to) / 2)));
  const width = Math.min(86400 * 3, Math.max(0.5, (to - from) * factor));
  const part = (middle - from) / (to - from);
  look(middle - width * part, middle + width * (1 - part));
}

export function pan(store: RunStore | undefined, part: number): void {
  const { from, to } = spanNow(store);
  const by = (to - from) * part;
  look(from + by, to + by);
}
