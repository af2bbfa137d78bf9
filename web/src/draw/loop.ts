// SPDX-License-Identifier: Apache-2.0
// The one animation loop of the page: some 20 draws a second, numbers at 5 a second, and nothing at all while
// nothing has changed. The browser's frame time only spaces the draws; no clock on the screen comes from it.
import { step } from '../replay/model';
import { Pace } from '../run/pace';
import { rowsTick, store, tick } from '../run/shown';

const DRAW_EVERY_MS = 50;
const FRAME_EARLY_MS = 4; // frames do not come to the millisecond
const NUMBERS_EVERY_MS = 200;
const FRAME_BUDGET_MS = 10; // ours: what is not drawn by then is at the next frame, and a key is answered in between

/** Looks at what there is to draw and how large, and gives how to draw it; nothing where what is shown is current. */
type Look = () => (() => void) | undefined;

const drawings = new Set<Look>();
const draws = new Pace(45, 25); // samples come 20 times a second: a pace no faster than theirs never makes up for one that was late
let lastLook = -Infinity;
let drawnSamples = 0; // a run of which no sample has come is nothing to make the first one wait for
let lastNumbers = 0;
let lastStep = 0;
let shownVersion = -1;
let shownStore: unknown;
let rowsDue = false;
let undrawn: { look: Look; draw: () => void }[] = []; // of the draw that is under way

/** Called at the next frame and then at each draw. Returns how to stop. */
export function onDraw(look: Look): () => void {
  drawings.add(look);
  lastLook = -Infinity;
  return () => drawings.delete(look);
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
  // Numbers take as long as drawings, and the rows of a long table as long again: each has a frame of its own, unless there is none.
  const since_ms = now - lastNumbers;
  if (rowsDue && (!drew || since_ms > DRAW_EVERY_MS)) {
    rowsDue = false;
    rowsTick.value += 1;
  } else if (since_ms >= NUMBERS_EVERY_MS + (drew ? DRAW_EVERY_MS : -FRAME_EARLY_MS)) {
    showNumbers(now);
  }
}

/** A sample that has just come is drawn at the next frame, unless one was drawn a moment ago; whatever else may have changed is looked at as often. */
function lookForNew(now: number): void {
  const samples = store.peek()?.samplesDrawn ?? 0;
  const fresh = samples !== drawnSamples;
  if (fresh ? draws.wait(now + FRAME_EARLY_MS) > 0 : now - lastLook < DRAW_EVERY_MS - FRAME_EARLY_MS) return;
  drawnSamples = samples;
  lastLook = now;
  if (fresh) draws.took(now);
  // All look before the first draws: the page is laid out once, and not again for each that put something into it.
  undrawn = [...drawings].flatMap((look) => {
    const draw = look();
    return draw ? [{ look, draw }] : [];
  });
}

function drawSome(): void {
  const until = performance.now() + FRAME_BUDGET_MS;
  do {
    const next = undrawn.shift();
    if (next && drawings.has(next.look)) next.draw(); // what is no longer shown is not drawn
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
  requestAnimationFrame(frame);
}
