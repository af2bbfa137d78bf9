// SPDX-License-Identifier: Apache-2.0
// The page's only animation loop: about 20 draws a second, numbers 5 times a second, and nothing while nothing has
// changed. The browser's frame time only spaces the draws; no clock on the screen comes from it.
import { step } from '../replay/model';
import { Pace } from '../run/pace';
import { rowsTick, store, tick } from '../run/shown';

const DRAW_EVERY_MS = 50;
const FRAME_EARLY_MS = 4; // frames are not exact to the millisecond
const NUMBERS_EVERY_MS = 200;
const FRAME_BUDGET_MS = 10; // chosen: remaining drawings wait for the next frame, so that a key is answered in between

/**
 * Compares the wanted drawing with the drawn one. Returns a function that draws, or undefined if the drawing is
 * current.
 */
type Look = () => (() => void) | undefined;

const drawings = new Set<Look>();
// samples arrive 20 times a second; a pace no faster than that would never catch up after a late one
const draws = new Pace(45, 25);
let lastLook = -Infinity;
let drawnSamples = 0; // 0 for a run without samples, so that the first one is drawn at once
let lastNumbers = 0;
let lastStep = 0;
let shownVersion = -1;
let shownStore: unknown;
let rowsDue = false;
let isAnswering = false; // a key was pressed since the last frame
let undrawn: { look: Look; draw: () => void }[] = []; // remaining drawings of the current draw

/** Registers a drawing for the next frame and each later draw. Returns a function that removes it. */
export function onDraw(look: Look): () => void {
  drawings.add(look);
  lastLook = -Infinity;
  return () => drawings.delete(look);
}

/** Draws everything that is not current at once, for paper, which waits for no frame. */
export function drawAll(): void {
  for (const look of drawings) look()?.();
}

function frame(now: number): void {
  requestAnimationFrame(frame);
  if (now - lastStep >= NUMBERS_EVERY_MS - FRAME_EARLY_MS) {
    const since_s = Math.min(1, (now - lastStep) / 1000);
    lastStep = now;
    step(since_s);
  }
  if (undrawn.length === 0) lookForNew(now);
  const drew = undrawn.length > 0;
  drawSome();
  // Numbers take as long as drawings, and rows of a long table as long again, so each has a frame of its own if there
  // is one.
  const since_ms = now - lastNumbers;
  const answers = isAnswering;
  isAnswering = false;
  // The picture that answers a key comes first: numbers wait for the next frame, but not for ever while one is held.
  if (answers && since_ms < 2 * NUMBERS_EVERY_MS) return;
  if (rowsDue && (!drew || since_ms > DRAW_EVERY_MS)) {
    rowsDue = false;
    rowsTick.value += 1;
  } else if (since_ms >= NUMBERS_EVERY_MS + (drew ? DRAW_EVERY_MS : -FRAME_EARLY_MS)) {
    showNumbers(now);
  }
}

/**
 * Collects drawings that are due. A new sample is drawn at the next frame unless one was drawn a moment ago; other
 * changes are checked at the same rate.
 */
function lookForNew(now: number): void {
  const samples = store.peek()?.samplesDrawn ?? 0;
  const fresh = samples !== drawnSamples;
  if (fresh ? draws.wait(now + FRAME_EARLY_MS) > 0 : now - lastLook < DRAW_EVERY_MS - FRAME_EARLY_MS) return;
  drawnSamples = samples;
  lastLook = now;
  if (fresh) draws.took(now);
  // All drawings measure before the first one draws, so that the page is laid out once.
  undrawn = [...drawings].flatMap((look) => {
    const draw = look();
    return draw ? [{ look, draw }] : [];
  });
}

function drawSome(): void {
  const until = performance.now() + FRAME_BUDGET_MS;
  do {
    const next = undrawn.shift();
    if (next && drawings.has(next.look)) next.draw(); // a drawing that is no longer shown is skipped
  } while (undrawn.length > 0 && performance.now() < until);
}

function showNumbers(now: number): void {
  const version = store.value?.version ?? 0;
  if (version === shownVersion && store.value === shownStore) return;
  shownVersion = version;
  shownStore = store.value;
  lastNumbers = now;
  tick.value += 1;
  rowsDue = true;
}

export function startLoop(): void {
  addEventListener('keydown', () => (isAnswering = true), true);
  requestAnimationFrame(frame);
}
