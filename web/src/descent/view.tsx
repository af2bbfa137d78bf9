// SPDX-License-Identifier: Apache-2.0
// The descent in one picture: altitude against speed.
import type { ComponentChildren } from 'preact';
import { Canvas } from '../draw/canvas';
import type { Surface } from '../draw/canvas';
import { LAYOUT } from '../layout';
import { openedLater } from '../design/opened_later';
import { Panel } from '../design/panel';
import { TYPE } from '../design/type';
import { staleWords } from '../channels/model';
import { isLost } from '../run/connection';
import { cutoff, dictionary, runNow, shownRun, tick, timepoints, withRecording } from '../run/shown';
import type { RunStore } from '../run/store';
import { landedSclk } from '../run/whose';
import { resultShown, touchedDown } from '../touchdown/shown';
import { isImportant, liveOutages, shortTitle } from '../timeline/model';
import { predicted } from '../timeline/now';
import { phaseSteps } from '../phases/model';
import { GAP_S } from '../plots/model';
import { isPredicted, predictedAt, predictedEvent, predictedSeries, predictedVersion } from '../prediction/model';
import { LEAST_M, LEAST_MPS, fraction, isClear, pairs, pathOf, wayOf } from './model';
import type { Box, PathPoint } from './model';
import './style.css';

const LEFT = 66;
const RIGHT = 22;
const BOTTOM = 40;
const PREDICTED_DASH = [2, 4];
const TOP_M = 200000;
const FASTEST_MPS = 8000;

/** The picture ends at touchdown; the later flight of the descent stage is not part of the landing. */
const lastInstant = (run: RunStore | undefined, end: number) => Math.min(end, landedSclk(run));

/** The predicted path of the run shown; empty until the prediction is there, and where there is none. */
let kept: { key: string; path: PathPoint[] } = { key: '', path: [] };
function predictedNow(): PathPoint[] {
  const run = shownRun();
  const [altitude, speed] = [LAYOUT.altitude, LAYOUT.speed].map((names) =>
    predictedSeries(dictionary.value?.pick(names)),
  );
  const key = `${run?.id} ${predictedVersion.value} ${isPredicted()}`;
  if (key !== kept.key) {
    const path = run ? pathOf(altitude, speed, run.entrySclk, predictedEvent(LAYOUT.landed) ?? Infinity) : [];
    kept = { key, path };
  }
  return kept.path;
}

/** Where the vehicle is expected to be at the instant shown. */
function expectedNow(run: RunStore): { altitude: number; speed: number } | undefined {
  const sclk = Math.min(run.seenSclk, cutoff.value);
  const [altitude, speed] = [LAYOUT.altitude, LAYOUT.speed].map((names) => {
    const channel = dictionary.value?.pick(names);
    return channel && predictedAt(channel, predictedSeries(channel), sclk, GAP_S);
  });
  const over = sclk - run.entrySclk > (predictedEvent(LAYOUT.landed) ?? Infinity);
  return altitude === undefined || speed === undefined || over ? undefined : { altitude, speed };
}

const isFree = (box: Box, taken: readonly Box[]) =>
  !taken.some((b) => box[0] < b[2] && box[2] > b[0] && box[1] < b[3] && box[3] > b[1]);

interface Scales {
  x: (mps: number) => number;
  y: (m: number) => number;
  decade_px: [number, number]; // pixels per decade of speed and of altitude
}

function scalesOf(width: number, height: number): Scales {
  const [wide, high] = [width - LEFT - RIGHT, height - BOTTOM - 12];
  return {
    x: (mps) => LEFT + fraction(mps, LEAST_MPS, FASTEST_MPS) * wide,
    y: (m) => height - BOTTOM - fraction(m, LEAST_M, TOP_M) * high,
    decade_px: [wide / Math.log10(FASTEST_MPS / LEAST_MPS), high / Math.log10(TOP_M / LEAST_M)],
  };
}

function drawAxes({ context: c, width, height, colours }: Surface, { x, y }: Scales): void {
  const bottom = height - BOTTOM;
  c.font = `${TYPE.mark}px ${colours.mono}`;
  c.textBaseline = 'middle';
  c.lineWidth = 1;
  c.strokeStyle = colours.line;
  c.fillStyle = colours.dim;
  c.textAlign = 'right';
  for (const m of [10, 100, 1000, 10000, 100000]) {
    line(c, LEFT, Math.round(y(m)) + 0.5, width - RIGHT, Math.round(y(m)) + 0.5);
    // where decades are narrow, every second one has its name
    if (y(10) - y(100) > TYPE.mark + 3 || Math.log10(m) % 2 === 1)
      c.fillText(m >= 1000 ? `${m / 1000} km` : `${m} m`, LEFT - AXIS_GAP_PX, y(m));
  }
  c.textAlign = 'center';
  for (const mps of [1, 10, 100, 1000]) {
    line(c, Math.round(x(mps)) + 0.5, 12, Math.round(x(mps)) + 0.5, bottom);
    if (x(100) - x(10) > 52 || Math.log10(mps) % 2 === 0)
      c.fillText(mps >= 1000 ? `${mps / 1000} km/s` : `${mps} m/s`, x(mps), bottom + AXIS_NAME_PX);
  }
  c.font = `${TYPE.table}px ${colours.sans}`;
  c.textAlign = 'right';
  c.fillText('faster →', width - RIGHT, bottom + 31);
  c.textAlign = 'left';
  c.fillText('← slower', LEFT, bottom + 31);
}

// the names of the axes: so far below the picture, and beside it
const AXIS_NAME_PX = 13;
const AXIS_GAP_PX = 8;
const PREDICTED_PX = 7; // chosen: seen from across the room, and no width of anything predicted

/** Draws the predicted path first, under everything else. */
function drawPredicted({ context: c, width, height, colours }: Surface, { x, y }: Scales): void {
  const path = predictedNow();
  const last = path.at(-1);
  if (!last) return;
  c.save();
  c.beginPath();
  c.rect(LEFT, 0, width - LEFT - RIGHT, height - BOTTOM);
  c.clip();
  c.beginPath();
  for (const point of path) c.lineTo(x(point.speed_mps), y(point.altitude_m));
  c.strokeStyle = colours.ghost;
  c.lineJoin = 'round';
  c.lineWidth = PREDICTED_PX;
  c.stroke();
  c.strokeStyle = colours.dim;
  c.lineWidth = 1;
  c.setLineDash(PREDICTED_DASH);
  c.stroke();
  c.restore();
  // The expected end.
  c.lineWidth = 2;
  c.strokeStyle = colours.dim;
  // not so large that it touches the names of the axis
  const [below, left] = [
    height - BOTTOM + AXIS_NAME_PX - TYPE.mark / 2 - y(last.altitude_m),
    x(last.speed_mps) - LEFT + AXIS_GAP_PX,
  ];
  const outer = Math.min(16, below - 2, left - 2);
  for (const radius of [(outer * 9) / 16, outer]) {
    c.beginPath();
    c.arc(x(last.speed_mps), y(last.altitude_m), radius, 0, 7);
    c.stroke();
  }
  c.lineWidth = 1;
}

/** The owner of the figures, once they are no longer the whole vehicle's. */
const whoseWords = (run: RunStore | undefined) =>
  lastInstant(run, cutoff.value) < cutoff.value ? `${LAYOUT.afterLanding.whose}, the rover hangs below it` : undefined;

/** The age of stale figures. At touchdown they keep the values of that instant. */
function staleNow(run: RunStore | undefined): string | undefined {
  if (whoseWords(run) !== undefined) return undefined;
  const of = (names: readonly string[]) => staleWords(run, dictionary.value?.pick(names), cutoff.value, isLost.value);
  return of(LAYOUT.altitude) ?? of(LAYOUT.speed);
}

/** The boxes of the figures in the lower corner and of the line below them (owner or age), as in style.css. */
function figures({ context: c, width, height, colours }: Surface): Box[] {
  const figure_px = Math.min(110, Math.max(24, Math.min(height * 0.13, width * 0.09))) * 1.1;
  const whose = whoseWords(shownRun());
  c.font = `${TYPE.table}px ${colours.sans}`;
  const line_px = (whose ?? staleNow(shownRun())) === undefined ? 0 : 15;
  const bottom_px = matchMedia('(max-width: 1500px)').matches ? 46 : 62;
  const all: Box[] = [[width - RIGHT - figure_px * 3.6, height - bottom_px - line_px - 2 * figure_px, width, height]];
  return whose === undefined
    ? all
    : [...all, [width - 36 - c.measureText(whose).width, height - bottom_px - line_px, width, height - bottom_px]];
}

/**
 * Names each phase beside the predicted path where there is room: below it, else to its left, never under the figures.
 * Returns the boxes of all words.
 */
function drawPhases(surface: Surface, { x, y }: Scales): Box[] {
  const { context: c, width, height, colours } = surface;
  const taken = figures(surface);
  const words = dictionary.value;
  const path = predictedNow();
  if (!words || path.length === 0) return taken;
  const steps = phaseSteps(shownRun(), words, timepoints.value, cutoff.value, predicted.value);
  const way = wayOf(path.map((point) => [x(point.speed_mps), y(point.altitude_m)] as const));
  c.textBaseline = 'middle';
  const order = steps
    .map((step, index) => ({ step, index }))
    .sort((a, b) => Number(b.step.state === 'now') - Number(a.step.state === 'now'));
  for (const { step, index } of order) {
    const from = step.predicted_e_s;
    const to = steps[index + 1]?.predicted_e_s;
    if (from === undefined || to === undefined) continue;
    const at = path.reduce((best, point) =>
      Math.abs(point.e_s - (from + to) / 2) < Math.abs(best.e_s - (from + to) / 2) ? point : best,
    );
    c.font = `${step.state === 'now' ? 800 : 600} ${Math.round(Math.min(26, width / 26, height / 13))}px ${colours.sans}`;
    c.fillStyle = step.state === 'now' ? colours.text : colours.dim;
    c.globalAlpha = step.state === 'now' ? 1 : 0.75;
    c.textAlign = 'left';
    const wide = c.measureText(step.title).width;
    const [px, py] = [x(at.speed_mps), y(at.altitude_m)];
    const places: [number, number][] =
      index === 1
        ? [[width - RIGHT - 6 - wide, py + 46]]
        : [
            [Math.min(width - wide - RIGHT, px + 34), py + 24],
            [px - wide - 44, py + 8],
            [px + 34, py + 4],
            [px + 34, py + 40],
            [px - wide / 2, py - 34],
            [px + 34, py - 34],
          ];
    const boxAt = ([left, top]: [number, number]): Box => [left, top - 12, left + wide, top + 12];
    const free = places.filter(
      (at) => at[0] > LEFT && at[1] + 12 < height - BOTTOM && at[1] > 24 && isFree(boxAt(at), taken),
    );
    const place = free.find((at) => isClear(boxAt(at), way)) ?? free[0];
    if (place) {
      taken.push([place[0], place[1] - 12, place[0] + wide, place[1] + 12]);
      c.fillText(step.title, ...place);
    }
    c.globalAlpha = 1;
  }
  return taken;
}

function draw(surface: Surface): void {
  const { context: c, width, height, colours } = surface;
  const run = shownRun();
  const altitude = dictionary.value?.pick(LAYOUT.altitude);
  const speed = dictionary.value?.pick(LAYOUT.speed);
  if (!altitude || !speed) {
    if (!dictionary.value) return;
    c.font = `${TYPE.table}px ${colours.sans}`;
    c.textAlign = 'center';
    c.fillStyle = colours.dim;
    c.fillText('No channel here is known as height or speed.', width / 2, height / 2);
    return;
  }
  const scales = scalesOf(width, height);
  const { x, y } = scales;
  drawPredicted(surface, scales);
  drawAxes(surface, scales);
  const taken = drawPhases(surface, scales);
  if (!run) return;

  const until = lastInstant(run, cutoff.value);
  const recorded = pairs(run.recorded.get(altitude.id), run.recorded.get(speed.id), until, 3000);
  const live = pairs(run.live.get(altitude.id), run.live.get(speed.id), until, 3000);
  const points = [...recorded, ...live]
    .sort((one, other) => one.sclk - other.sclk)
    .filter((point) => point.altitude <= TOP_M);
  const silences = liveOutages(run, Infinity, cutoff.value);
  let before: (typeof points)[number] | undefined;
  let colour = '';
  c.lineWidth = 2;
  c.lineJoin = 'round';
  c.beginPath();
  for (const point of points) {
    const e_s = point.sclk - run.entrySclk;
    const next = silences.some((silence) => e_s > silence.from && e_s < silence.to) ? colours.recording : colours.uhf;
    if (next !== colour) {
      c.stroke();
      c.strokeStyle = colour = next;
      c.beginPath();
      if (before) c.moveTo(x(before.speed), y(before.altitude));
    }
    if (!before || point.sclk - before.sclk > GAP_S) {
      if (before)
        gap(c, [x(before.speed), y(before.altitude)], [x(point.speed), y(point.altitude)], colours.caution, colour);
      c.moveTo(x(point.speed), y(point.altitude));
    } else c.lineTo(x(point.speed), y(point.altitude));
    before = point;
  }
  c.stroke();
  moments(c, points, x, y, width, height - BOTTOM, taken, colours);
  drawExpected(surface, scales, run);
  const now = points[points.length - 1];
  if (!now) {
    c.fillStyle = colours.dim;
    c.font = `${TYPE.table}px ${colours.sans}`;
    c.textAlign = 'left';
    const told = [altitude, speed].every(({ id }) => run.latest(id, until) !== undefined);
    const words = told ? `above ${TOP_M / 1000} km: above this picture` : 'no height and speed yet';
    const [left, top, wide] = [LEFT + 14, 30, c.measureText(words).width];
    c.save();
    c.fillStyle = colours.panel; // over the grid
    c.fillRect(left - 4, top - 10, wide + 8, 20);
    c.restore();
    c.fillText(words, left, top);
    return;
  }
  const stale = staleNow(run) !== undefined; // hollow, at the last known place
  c.fillStyle = stale ? colours.panel : colours.text;
  c.strokeStyle = stale ? colours.dim : colours.page;
  c.lineWidth = 3;
  c.beginPath();
  c.arc(x(now.speed), y(now.altitude), 9, 0, 7);
  c.stroke();
  c.fill();
  c.strokeStyle = stale ? colours.dim : colours.text;
  c.lineWidth = 2;
  c.beginPath();
  c.arc(x(now.speed), y(now.altitude), 16, 0, 7);
  c.stroke();
}

/** A small hollow ring where the vehicle is expected now: through blackout, Earth set and while only tones are heard. */
function drawExpected({ context: c, colours }: Surface, { x, y }: Scales, run: RunStore): void {
  const at = expectedNow(run);
  if (!at || at.altitude > TOP_M) return;
  c.save();
  c.strokeStyle = colours.text;
  c.lineWidth = 1.5;
  c.setLineDash([3, 2]);
  c.beginPath();
  c.arc(x(at.speed), y(at.altitude), 7, 0, 7);
  c.stroke();
  c.restore();
}

/** Draws a gap without reception: dashed, not a trace. */
function gap(
  c: CanvasRenderingContext2D,
  from: [number, number],
  to: [number, number],
  colour: string,
  back: string,
): void {
  c.stroke();
  c.save();
  c.strokeStyle = colour;
  c.lineWidth = 1;
  c.setLineDash([3, 5]);
  line(c, ...from, ...to);
  c.restore();
  c.strokeStyle = back;
  c.beginPath();
}

function line(c: CanvasRenderingContext2D, x1: number, y1: number, x2: number, y2: number): void {
  c.beginPath();
  c.moveTo(x1, y1);
  c.lineTo(x2, y2);
  c.stroke();
}

/** Positions for the words of a moment beside it, best first. */
const WORDS_AT = [
  [-14, -14, 'right'],
  [-18, -30, 'right'],
  [-22, -46, 'right'],
  [-18, 4, 'right'],
  [-26, -62, 'right'],
  [16, 14, 'left'],
  [16, 34, 'left'],
  [-30, -78, 'right'],
  [-34, -94, 'right'],
  [-26, 22, 'right'],
  [-30, 40, 'right'],
  [-34, 58, 'right'],
  [16, 54, 'left'],
] as const;

/** Order of naming: timepoints that begin a phase first, the newest of these first. */
function rank(firing: { name: string } | undefined): number {
  const phase = LAYOUT.phases.findIndex(({ from }) => from !== undefined && from === firing?.name);
  return phase < 0 ? 0 : -phase;
}

function moments(
  c: CanvasRenderingContext2D,
  points: { sclk: number; speed: number; altitude: number }[],
  x: (v: number) => number,
  y: (h: number) => number,
  width: number,
  bottom: number,
  taken: readonly Box[],
  colours: Surface['colours'],
): void {
  const run = shownRun();
  if (!run || points.length === 0) return;
  c.font = `${TYPE.body}px ${colours.sans}`;
  const boxes = [...taken];
  const way = wayOf(points.map((point) => [x(point.speed), y(point.altitude)] as const));
  const now = points[points.length - 1];
  if (now) boxes.push([x(now.speed) - 18, y(now.altitude) - 18, x(now.speed) + 18, y(now.altitude) + 18]); // the dot
  const fired = [...run.firings.values()]
    .map((pair) => pair.live ?? pair.recorded)
    .filter((firing) => firing !== undefined && isImportant(firing.name) && firing.firedSclk <= cutoff.value)
    .sort((one, other) => rank(one) - rank(other));
  for (const firing of fired) {
    if (!firing) continue;
    let nearest: (typeof points)[number] | undefined;
    for (const point of points) {
      if (!nearest || Math.abs(point.sclk - firing.firedSclk) < Math.abs(nearest.sclk - firing.firedSclk))
        nearest = point;
    }
    if (!nearest || Math.abs(nearest.sclk - firing.firedSclk) > 3) continue;
    const px = x(nearest.speed);
    const py = y(nearest.altitude);
    c.fillStyle = colours.uhf;
    c.beginPath();
    c.arc(px, py, 3.5, 0, 7);
    c.fill();
    const words = shortTitle(firing.name);
    const wide = c.measureText(words).width;
    const places = WORDS_AT.flatMap(([dx, dy, align]) => {
      const left = align === 'left' ? px + dx : px + dx - wide;
      const box: Box = [left, py + dy - 8, left + wide, py + dy + 8];
      const fits = box[0] >= LEFT && box[2] <= width - 8 && box[3] <= bottom && box[1] >= 4 && isFree(box, boxes);
      return fits ? [{ dx, dy, align, box }] : [];
    });
    const place = places.find(({ box }) => isClear(box, way));
    if (!place) continue;
    boxes.push(place.box);
    if (Math.abs(place.dy) > 15) {
      c.strokeStyle = colours.dim;
      c.lineWidth = 1;
      line(c, px, py, px + place.dx - 2, py + place.dy);
    }
    c.fillStyle = colours.text;
    c.textAlign = place.align;
    c.fillText(words, px + place.dx, py + place.dy);
  }
}

const Result = openedLater(async () => (await import('../touchdown/view')).Touchdown);

/** The descent, and from touchdown on its result in the same place. */
export function Descent() {
  const landed = touchedDown();
  const choose = landed && (
    <button type="button" onClick={() => (resultShown.value = !resultShown.value)} data-testid="descent-result">
      {resultShown.value ? 'the descent' : 'the result'}
    </button>
  );
  return landed && resultShown.value ? (
    <Panel name="descent" title="Touchdown" extra={choose}>
      <Result />
    </Panel>
  ) : (
    <Picture choose={choose} />
  );
}

function Picture({ choose }: { choose: ComponentChildren }) {
  const run = runNow();
  const until = lastInstant(run, cutoff.value);
  const words = dictionary.value;
  const altitude = words?.pick(LAYOUT.altitude);
  const speed = words?.pick(LAYOUT.speed);
  const h = altitude && run?.latest(altitude.id, until)?.value;
  const v = speed && run?.latest(speed.id, until)?.value;
  const inKm = (h ?? 0) >= 10000;
  const whose = whoseWords(run);
  const stale = staleNow(run);
  return (
    <Panel
      name="descent"
      title={
        <>
          Descent<span class="how">, how high and how fast</span>
        </>
      }
      extra={
        <>
          {whose !== undefined && <span>at touchdown</span>}
          {choose}
        </>
      }
    >
      <div class="descent-box">
        <Canvas
          label="Altitude against speed, with the predicted path"
          draw={draw}
          testId="descent-canvas"
          keyOf={() =>
            `${shownRun()?.id} ${withRecording.value} ${tick.value} ${timepoints.value.length} ${cutoff.value} ${isLost.value} ${predictedVersion.value} ${isPredicted()}`
          }
        />
        {h !== undefined && (
          <dl class={`descent-now ${stale ? 'stale' : ''}`} title={`${altitude?.text ?? ''}; ${speed?.text ?? ''}`}>
            <div data-menu={`channel ${altitude?.name}`}>
              <dt>high</dt>
              <dd>
                <output data-testid="altitude">
                  {h === undefined || Number.isNaN(h) ? '—' : inKm ? (h / 1000).toFixed(1) : h.toFixed(0)}
                </output>{' '}
                {inKm ? 'km' : 'm'}
              </dd>
            </div>
            <div data-menu={`channel ${speed?.name}`}>
              <dt>fast</dt>
              <dd>
                <output data-testid="speed">
                  {v === undefined || Number.isNaN(v) ? '—' : v < 10 ? v.toFixed(2) : v.toFixed(0)}
                </output>{' '}
                m/s
              </dd>
            </div>
            {whose !== undefined && (
              <div class="descent-whose" data-testid="descent-whose">
                <dt>whose</dt>
                <dd>{whose}</dd>
              </div>
            )}
            {stale && (
              <div class="descent-whose descent-age" data-testid="descent-stale">
                <dt>how old</dt>
                <dd>{stale} old</dd>
              </div>
            )}
          </dl>
        )}
      </div>
    </Panel>
  );
}
