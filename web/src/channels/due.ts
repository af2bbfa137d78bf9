// SPDX-License-Identifier: Apache-2.0
// Decides which rows of the table are updated at which tick. Rows in sight follow every tick. Laying out hundreds of
// rows takes several times as long as everything else in a tick, so rows out of sight take turns; they catch up once
// changes stop.
import { computed, effect, signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { rowsTick } from '../run/shown';

export const BLOCK = 8; // chosen: rows that are updated and laid out together
const TURNS = 8; // chosen: ticks in which all rows out of sight are updated once
const REST_MS = 1000; // chosen: after this long without a tick, changes have stopped

/** The range of rows in sight; all rows until it is known. */
export const sight = signal({ from: 0, to: Infinity });

const rest = signal(0);
effect((): (() => void) => {
  void rowsTick.value;
  const later = setTimeout(() => ++rest.value, REST_MS);
  return () => clearTimeout(later);
});

const blocks: ReadonlySignal<number>[] = [];

/** Subscribes the row at `place` to the ticks at which it is due. */
export function whenDue(place: number): void {
  const block = Math.floor(place / BLOCK);
  blocks[block] ??= computed(() => {
    const { from, to } = sight.value;
    const inSight = block * BLOCK < to && (block + 1) * BLOCK > from;
    return inSight ? rowsTick.value : -Math.floor((rowsTick.value + block) / TURNS);
  });
  void blocks[block].value;
  void rest.value;
}

/** Tracks the rows in sight of a table that scrolls in `box`. Returns a function that stops the tracking. */
export function watchSight(box: HTMLElement, rows: HTMLTableElement): () => void {
  const measure = () => {
    const head_px = rows.tHead?.offsetHeight ?? 0;
    const row_px = (rows.offsetHeight - head_px) / (rows.rows.length - 1);
    if (!(row_px > 0)) return;
    const above = rows.offsetTop + head_px - box.scrollTop;
    sight.value = { from: Math.floor(-above / row_px), to: Math.ceil((box.clientHeight - above) / row_px) };
  };
  const sizes = new ResizeObserver(measure);
  sizes.observe(box);
  sizes.observe(rows);
  box.addEventListener('scroll', measure, { passive: true });
  return () => {
    sizes.disconnect();
    box.removeEventListener('scroll', measure);
    sight.value = { from: 0, to: Infinity };
  };
}
