// The one animation loop of the page: some 20 draws a second, numbers at 5 a second, and nothing at all while
// nothing has changed. The browser's frame time only spaces the draws; no clock on the screen comes from it.
import { step } from '../replay/model';
import { Pace } from '../run/pace';
import { store, tick } from '../run/session';

const DRAW_EVERY_MS = 50;
const FRAME_EARLY_MS = 4; // frames do not come to the millisecond
const NUMBERS_EVERY_MS = 200;

const drawings = new Set<() => void>();
const draws = new Pace(45, 25); // samples come 20 times a second: a pace no faster than theirs never makes up for one that was late
let lastLook = 0;
let drawnSamples = -1;
let lastNumbers = 0;
let lastStep = 0;
let shownVersion = -1;
let shownStore: unknown;

/** Called at each draw; `draw` itself decides whether it is still current. Returns how to stop. */
export function onDraw(draw: () => void): () => void {
  drawings.add(draw);
  return () => drawings.delete(draw);
}

function frame(now: number): void {
  requestAnimationFrame(frame);
  if (now - lastStep >= NUMBERS_EVERY_MS - FRAME_EARLY_MS) {
    const since_s = Math.min(1, (now - lastStep) / 1000);
    lastStep = now;
    step(since_s);
  }
  // A sample that has just come is drawn at the next frame, unless one was drawn a moment ago; whatever else may have changed is looked at as often.
  const samples = store.peek()?.samplesDrawn ?? 0;
  const fresh = samples !== drawnSamples;
  if (fresh ? draws.wait(now + FRAME_EARLY_MS) === 0 : now - lastLook >= DRAW_EVERY_MS - FRAME_EARLY_MS) {
    drawnSamples = samples;
    lastLook = now;
    if (fresh) draws.took(now);
    for (const draw of drawings) draw();
    // Numbers take as long as drawings: they have a frame of their own, unless there is none.
    if (now - lastNumbers < NUMBERS_EVERY_MS + DRAW_EVERY_MS) return;
  }
  if (now - lastNumbers >= NUMBERS_EVERY_MS - FRAME_EARLY_MS) showNumbers(now);
}

function showNumbers(now: number): void {
  const version = store.value?.version ?? 0;
  if (version === shownVersion && store.value === shownStore) return;
  shownVersion = version;
  shownStore = store.value;
  lastNumbers = now;
  tick.value += 1;
}

export function startLoop(): void {
  requestAnimationFrame(frame);
}
