// The descent in one picture that anyone understands: how high, how fast.
import { Canvas } from '../draw/canvas';
import type { Surface } from '../draw/canvas';
import { ticks, valueStep } from '../draw/axis';
import { LAYOUT } from '../layout';
import { Panel } from '../panel';
import { cutoff, dictionary, runNow, store, tick, timepoints } from '../run/session';
import type { RunStore } from '../run/store';
import { inWords } from '../run/dictionary';
import { isImportant, outages } from '../timeline/model';
import { heightFraction, pairs } from './model';
import './style.css';

const LEFT = 62;
const TOP_M = 200000;
const GAP_S = 6; // ours: longer without a sample is a gap

/** The picture ends at touchdown: what the descent stage does after it is not the landing. */
function lastInstant(run: RunStore | undefined, end: number): number {
  for (const pair of run?.firings.values() ?? []) {
    const fired = (pair.live ?? pair.recorded)?.firedSclk;
    if (pair.name === LAYOUT.landed && fired !== undefined) return Math.min(end, fired);
  }
  return end;
}

function draw({ context: c, width, height, colours }: Surface): void {
  const run = store.value;
  const altitude = dictionary.value?.pick(LAYOUT.altitude);
  const speed = dictionary.value?.pick(LAYOUT.speed);
  if (!altitude || !speed) return;
  const bottom = height - 26;
  const until = lastInstant(run, cutoff.value);
  const recorded = pairs(run?.recorded.get(altitude.id), run?.recorded.get(speed.id), until, 3000);
  const live = pairs(run?.live.get(altitude.id), run?.live.get(speed.id), until, 3000);
  const fastest = Math.max(6200, ...[...recorded, ...live].map((point) => point.speed));
  const x = (mps: number) => LEFT + Math.sqrt(mps / fastest) * (width - LEFT - 24);
  const y = (m: number) => bottom - heightFraction(m, TOP_M) * (bottom - 12);

  c.font = `12px ${colours.mono}`;
  c.textBaseline = 'middle';
  c.lineWidth = 1;
  for (const m of [1, 10, 100, 1000, 10000, 100000]) {
    c.strokeStyle = colours.line;
    c.beginPath();
    c.moveTo(LEFT, Math.round(y(m)) + 0.5);
    c.lineTo(width - 10, Math.round(y(m)) + 0.5);
    c.stroke();
    c.fillStyle = colours.dim;
    c.textAlign = 'right';
    c.fillText(m >= 1000 ? `${m / 1000} km` : `${m} m`, LEFT - 8, y(m));
  }
  c.textAlign = 'center';
  for (const mps of [1, 10, 50, 100, 400, 1000, 2000, 4000, ...ticks(6000, fastest, valueStep(fastest, 3))]) {
    if (mps > fastest) continue;
    c.strokeStyle = colours.line;
    c.beginPath();
    c.moveTo(Math.round(x(mps)) + 0.5, 12);
    c.lineTo(Math.round(x(mps)) + 0.5, bottom);
    c.stroke();
    if (mps === 50 || mps === 10) continue;
    c.fillText(mps >= 1000 ? `${mps / 1000} km/s` : `${mps}`, x(mps), height - 11);
  }
  c.textAlign = 'left';
  c.fillText('m/s', width - 36, height - 11 - 16);
  if (!run) return;

  const points = [...recorded, ...live].sort((one, other) => one.sclk - other.sclk);
  const silences = outages(run, 'uhf_live', Infinity, cutoff.value);
  let before: (typeof points)[number] | undefined;
  let colour = '';
  c.lineWidth = 1;
  c.beginPath();
  for (const point of points) {
    const e_s = point.sclk - run.entrySclk;
    const next = silences.some((silence) => e_s > silence.from && e_s < silence.to) ? colours.green : colours.trace;
    if (next !== colour) {
      c.stroke();
      c.strokeStyle = colour = next;
      c.beginPath();
      if (before) c.moveTo(x(before.speed), y(before.altitude));
    }
    if (!before || point.sclk - before.sclk > GAP_S) c.moveTo(x(point.speed), y(point.altitude));
    else c.lineTo(x(point.speed), y(point.altitude));
    before = point;
  }
  c.stroke();
  moments(c, points, x, y, width, bottom, colours);
  if (points.length === 0) {
    c.fillStyle = colours.dim;
    c.textAlign = 'center';
    c.fillText(`no ${altitude.name} has come yet`, (LEFT + width) / 2, height / 2);
  }
  const now = points[points.length - 1];
  if (now) {
    c.fillStyle = colours.text;
    c.beginPath();
    c.arc(x(now.speed), y(now.altitude), 6, 0, 7);
    c.fill();
    c.strokeStyle = colours.text;
    c.beginPath();
    c.arc(x(now.speed), y(now.altitude), 11, 0, 7);
    c.stroke();
  }
}

function moments(
  c: CanvasRenderingContext2D, points: { sclk: number; speed: number; altitude: number }[], x: (v: number) => number,
  y: (h: number) => number, width: number, bottom: number, colours: Surface['colours'],
): void {
  const run = store.value;
  if (!run || points.length === 0) return;
  c.font = `13px ${colours.sans}`;
  const boxes: [number, number, number, number][] = [];
  const fired = [...run.firings.values()].map((pair) => pair.live ?? pair.recorded)
    .filter((firing) => firing !== undefined && isImportant(firing.name) && firing.firedSclk <= cutoff.value);
  for (const firing of fired) {
    if (!firing) continue;
    let nearest: (typeof points)[number] | undefined;
    for (const point of points) {
      if (!nearest || Math.abs(point.sclk - firing.firedSclk) < Math.abs(nearest.sclk - firing.firedSclk)) nearest = point;
    }
    if (!nearest || Math.abs(nearest.sclk - firing.firedSclk) > 3) continue;
    const px = x(nearest.speed);
    const py = y(nearest.altitude);
    c.fillStyle = colours.blue;
    c.beginPath();
    c.arc(px, py, 3.5, 0, 7);
    c.fill();
    const words = inWords(firing.name);
    const wide = c.measureText(words).width;
    for (const [dx, dy, align] of [[10, 12, 'left'], [-10, -12, 'right'], [10, -12, 'left'], [-10, 12, 'right'], [14, -28, 'left'], [14, 30, 'left'], [14, -44, 'left']] as const) {
      const left = align === 'left' ? px + dx : px + dx - wide;
      const box: [number, number, number, number] = [left, py + dy - 8, left + wide, py + dy + 8];
      if (box[0] < LEFT || box[2] > width - 8 || box[3] > bottom || box[1] < 4) continue;
      if (boxes.some((b) => box[0] < b[2] && box[2] > b[0] && box[1] < b[3] && box[3] > b[1])) continue;
      boxes.push(box);
      if (Math.abs(dy) > 14) {
        c.strokeStyle = colours.dim;
        c.lineWidth = 1;
        c.beginPath();
        c.moveTo(px, py);
        c.lineTo(px + dx - 2, py + dy);
        c.stroke();
      }
      c.fillStyle = colours.text;
      c.textAlign = align;
      c.fillText(words, px + dx, py + dy);
      break;
    }
  }
}

export function Descent() {
  const run = runNow();
  const until = lastInstant(run, cutoff.value);
  const words = dictionary.value;
  const altitude = words?.pick(LAYOUT.altitude);
  const speed = words?.pick(LAYOUT.speed);
  const h = altitude && run?.latest(altitude.id, until)?.value;
  const v = speed && run?.latest(speed.id, until)?.value;
  const inKm = (h ?? 0) >= 10000;
  return (
    <Panel name="descent" title="Descent, how high and how fast" extra={
      <span class="descent-now" title={`${altitude?.text ?? ''}; ${speed?.text ?? ''}`}>
        {until < cutoff.value && <span>at touchdown</span>}
        <span class="nowrap"><output data-testid="altitude">{h === undefined || Number.isNaN(h) ? '—' : inKm ? (h / 1000).toFixed(1) : h.toFixed(0)}</output> {inKm ? 'km' : 'm'}</span>
        <span class="nowrap"><output data-testid="speed">{v === undefined || Number.isNaN(v) ? '—' : v < 10 ? v.toFixed(2) : v.toFixed(0)}</output> m/s</span>
      </span>
    }>
      <Canvas label="Altitude against speed" draw={draw} testId="descent-canvas" keyOf={() =>
        `${store.value?.id} ${tick.value} ${timepoints.value.length} ${cutoff.value}`} />
    </Panel>
  );
}
