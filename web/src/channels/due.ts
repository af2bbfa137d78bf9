// SPDX-License-Identifier: Apache-2.0
// Which rows of the table are shown anew when. What is in sight follows each tick. Laying out hundreds of rows takes several times as long as
// everything else that a tick changes, so what is out of sight takes turns, and is as new as the rest once nothing changes any more.
import { computed, effect, signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { rowsTick } from '../run/shown';

const BLOCK = 8; // ours: rows that are in sight or out of it together
const TURNS = 8; // ours: ticks for all that is out of sight
const REST_MS = 1000; // ours: after so long without a tick nothing changes any more

/** The rows in sight, by their places; before it is known, all. */
export const sight = signal({ from: 0, to: Infinity });

const rest = signal(0);
effect((): (() => void) => {
  void rowsTick.value;
  const later = setTimeout(() => ++rest.value, REST_MS);
  return () => clearTimeout(later);
});

const blocks: ReadonlySignal<number>[] = [];

/** Read by the row at this place: it is then shown anew whenever it is due. */
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

/** Of a table that scrolls in `box`. Gives how to stop. */
export function watchSight(box: HTMLElement, rows: HTMLTableSectionElement): () => void {
  const measure = () => {
    const row_px = rows.offsetHeight / rows.rows.length;
    if (!(row_px > 0)) return;
    const above = rows.offsetTop - box.scrollTop;
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
