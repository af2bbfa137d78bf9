// The one animation loop of the page: at most 20 draws a second, numbers at 5 a second, and nothing at all while
// nothing has changed. The browser's frame time only spaces the draws; no clock on the screen comes from it.
import { step } from '../replay/model';
import { store, tick } from '../run/session';

const DRAW_EVERY_MS = 50;
const NUMBERS_EVERY_MS = 200;

const drawings = new Set<() => void>();
let lastDraw = 0;
let lastLook = 0;
let drawnVersion = -1;
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
  if (now - lastStep >= NUMBERS_EVERY_MS - 4) {
    const since_s = Math.min(1, (now - lastStep) / 1000);
    lastStep = now;
    step(since_s);
  }
  // What has just come is drawn at the next frame, unless one was drawn a moment ago; whatever else may have changed is looked at as often.
  const changed = (store.peek()?.version ?? 0) !== drawnVersion;
  if (now - (changed ? lastDraw : lastLook) >= DRAW_EVERY_MS - 4) {
    drawnVersion = store.peek()?.version ?? 0;
    if (changed) lastDraw = now;
    lastLook = now;
    for (const draw of drawings) draw();
    // Numbers take as long as drawings: they have a frame of their own, unless there is none.
    if (now - lastNumbers < NUMBERS_EVERY_MS + DRAW_EVERY_MS) return;
  }
  if (now - lastNumbers >= NUMBERS_EVERY_MS - 4) showNumbers(now);
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
