// SPDX-License-Identifier: Apache-2.0
// The timeline: lanes one below the other over one time axis, for comparing the plan with each source.
import { signal } from '@preact/signals';
import { Canvas } from '../draw/canvas';
import { palette } from '../draw/palette';
import { TYPE } from '../design/type';
import type { Surface } from '../draw/canvas';
import { ticks, timeLabel, timeStep } from '../draw/axis';
import { openedLater } from '../design/opened_later';
import { Panel } from '../design/panel';
import { LAYOUT } from '../layout';
import { cutoff, dictionary, pastRange, replay, runNow, shownRun, tick, timepoints, withRecording } from '../run/shown';
import type { RunStore } from '../run/store';
import { cursor } from '../run/cursor';
import { fromEntry } from '../run/time';
import { choice, pan, spanNow, zoom } from '../run/window';
import type { Choice } from '../run/window';
import { isPredicted, passes, windowWords, windowsOf } from '../prediction/model';
import { posteriorText } from '../tones/model';
import { timelineKnown } from './asked';
import { anchorLines, moved, predicted, predictedAsOf } from './now';
import { STATUS, SOURCES, held, silenceStatus } from '../design/status';
import { conditionLine, conditions, noteWords } from '../waiting/model';
import type { Line } from '../waiting/model';
import { momentsOf } from './moments';
import {
  firedCount,
  isImportant,
  lanesOf,
  nextTimepoint,
  pointDetail,
  shortReason,
  shortTitle,
  shortestReason,
  title,
} from './model';
import type { Lanes, Mark } from './model';
import './style.css';

const GUTTER = 118;
const TOP = 26;
const CLOSE_UP_S = 180; // chosen: in a shorter stretch every timepoint has room for its name
const LABELS = 42; // at least two rows of names
const AMISS_LETTERS = 30; // chosen: what went amiss has a name of that length at most, else its mark alone
const LANES = ['plan', 'predicted', 'by tone', 'by Doppler', 'by telemetry, live', 'by recording'] as const;
const [TONE, DOPPLER, LIVE, RECORDING] = [2, 3, 4, 5];
const selected = signal<number | undefined>(undefined);
const anchorsShown = signal(false);

export function toggleAnchors(): void {
  anchorsShown.value = !anchorsShown.value;
  if (!anchorsShown.value) return;
  selected.value = undefined; // the anchors take its place
  requestAnimationFrame(() => document.querySelector<HTMLElement>('[data-testid="anchors"]')?.focus());
}

/** Selects the next or the previous timepoint by key; without a selection, the next one that the vehicle waits for. */
export function stepTimepoint(direction: 1 | -1): void {
  const plan = timepoints.value;
  const at = plan.findIndex((row) => row.id === selected.value);
  const run = shownRun();
  const next = run && nextTimepoint(run, plan, cutoff.value);
  const to = at >= 0 ? plan[at + direction] : (next ?? plan[plan.length - 1]);
  if (to) select(to.id);
}
export function closeDetail(): boolean {
  const open = selected.value !== undefined || anchorsShown.value;
  select(undefined);
  return open;
}
function select(id: number | undefined): void {
  selected.value = id;
  anchorsShown.value = false;
}

/** The stretch shown. While the command in the form would move timepoints, it is widened to include them. */
function shown(run: RunStore | undefined): { from: number; to: number } {
  const span = spanNow(run);
  const all = moved.value ?? [];
  if (all.length === 0 || choice.value !== 'landing') return span;
  return {
    from: Math.min(LAYOUT.window.from, ...all.flatMap((each) => [each.from_e_s - 20, each.to_e_s - 20])),
    to: span.to,
  };
}

let hits: { x: number; y: number; id: number }[] = [];

/** The magnification against the console, for a panel alone on a large screen. */
let grown = 1;

function drawTimeline({ context: c, width: width_px, height: height_px, colours }: Surface): void {
  grown = Math.max(1, Math.min(2, width_px / 900, height_px / 400));
  c.scale(grown, grown);
  const [width, height] = [width_px / grown, height_px / grown];
  const run = shownRun();
  const { from, to } = shown(run);
  const x = (e_s: number) => GUTTER + ((e_s - from) / (to - from)) * (width - GUTTER - 14);
  const lane_px = Math.max(13, Math.min(grown > 1 ? 40 : 25, (height - TOP - LABELS) / LANES.length));
  const y = (lane: number) => TOP + lane_px * (lane + 0.5);
  const bottom = TOP + lane_px * LANES.length;
  hits = [];

  const now_px = run ? x(pastRange.value?.to ?? run.seenE) : -1000; // its flag is where labels would be
  const flag_px = pastRange.value ? 112 : 58; // a long flag leans inwards at the edge
  const pointed_px = cursor.value === undefined ? -1000 : x(cursor.value);
  const step = timeStep(to - from, Math.floor((width - GUTTER) / 90));
  c.textAlign = 'center';
  c.textBaseline = 'middle';
  c.font = `${TYPE.mark}px ${colours.mono}`;
  for (const e_s of ticks(from, to, step)) {
    c.strokeStyle = e_s === 0 ? colours.edge : colours.line;
    line(c, Math.round(x(e_s)) + 0.5, TOP - 6, Math.round(x(e_s)) + 0.5, bottom);
    c.fillStyle = colours.dim;
    if ([now_px, pointed_px].every((px) => Math.abs(x(e_s) - px) > flag_px))
      c.fillText(timeLabel(run?.entryKnown !== false)(e_s, step), x(e_s), 11);
  }
  c.font = `${TYPE.table}px ${colours.sans}`;
  c.textAlign = 'left';
  LANES.forEach((name, lane) => {
    c.fillStyle = colours.text;
    c.fillText(name, 14, y(lane));
    c.strokeStyle = colours.line;
    line(c, GUTTER, y(lane) + 0.5, width - 14, y(lane) + 0.5);
  });
  if (!run) return;
  const lanes = lanesOf(run, timepoints.value, cutoff.value);

  c.save();
  c.beginPath();
  c.rect(GUTTER - 6, 0, width - GUTTER, height);
  c.clip();
  drawWindows(c, x, y, width, Math.min(run.seenE, pastRange.value?.to ?? Infinity), colours);
  drawOutages(c, lanes, x, y, width, run.seenE, colours);
  // Of a followed mission nothing is known of a recording.
  if (
    run.entryKnown &&
    !pastRange.value &&
    lanes.relay < 1 &&
    !lanes.recorded.some(({ e_s }) => e_s >= from && e_s <= to)
  ) {
    c.textAlign = 'center';
    const told = `${Math.floor(lanes.relay * 100)} % of the recording has come`;
    const words =
      lanes.recorded.length > 0
        ? `${told}, up to ${fromEntry(Math.max(...lanes.recorded.map(({ e_s }) => e_s)))}`
        : lanes.relay > 0
          ? told
          : 'the recording comes down after landing';
    const wide = c.measureText(words).width;
    // in the middle, or beside the line of now that would cross it
    const middle = (GUTTER + width) / 2;
    const at = Math.abs(now_px - middle) < wide / 2 + 8 ? now_px - wide / 2 - 14 : middle;
    c.fillStyle = colours.panel; // not struck through by the lane
    c.fillRect(at - wide / 2 - 6, y(RECORDING) - 8, wide + 12, 16);
    c.fillStyle = colours.dim;
    c.fillText(words, at, y(RECORDING) - 0.5);
  }
  marks(lanes.plan, x, y(0), (px, py) => ring(c, px, py, 3.2, colours.dim), true);
  const now_e_s = Math.min(run.seenE, pastRange.value?.to ?? Infinity);
  drawPredicted(c, x, y(1), now_e_s, colours);
  marks(lanes.tones, x, y(TONE), (px, py) => box(c, px, py, 3.8, colours.tone), false);
  marks(lanes.heardByTone, x, y(TONE), (px, py) => box(c, px, py, 3.8, colours.tone), true);
  drawDoppler(c, lanes, x, y(DOPPLER), width - 14, now_e_s, colours);
  marks(
    lanes.live,
    x,
    y(LIVE),
    (px, py, bad) => (bad ? triangle(c, px, py, colours.caution) : diamond(c, px, py, 5, colours.uhf)),
    true,
  );
  marks(
    lanes.recorded,
    x,
    y(RECORDING),
    (px, py, bad) => (bad ? triangle(c, px, py, colours.caution) : framed(c, px, py, 4, colours.recording)),
    true,
  );
  for (const { e_s, danger } of lanes.amiss) {
    c.strokeStyle = danger ? colours.alarm : colours.caution;
    c.setLineDash([1, 3]);
    line(c, Math.round(x(e_s)) + 0.5, TOP, Math.round(x(e_s)) + 0.5, bottom);
    c.setLineDash([]);
    triangle(c, x(e_s), TOP - 2, c.strokeStyle);
  }
  const chosen = hits.filter((hit) => hit.id === selected.value);
  for (const hit of chosen) ring(c, hit.x, hit.y, 8, colours.text);
  labels(c, lanes, x, bottom, width, height, colours);
  cursors(c, pastRange.value?.to ?? run.seenE, run.run.lightTimeS, x, bottom, colours, width - 8, run.going);
  if (cursor.value !== undefined)
    flag(
      c,
      x(cursor.value),
      fromEntry(cursor.value, { tenths: true }),
      colours.accent,
      colours.page,
      bottom,
      width - 8,
    );
  c.restore();
}

/**
 * Draws what is predicted of the links: silences hollow, and passes as a line under the lane. What comes is drawn over
 * it. Words stand ahead of now only.
 */
function drawWindows(
  c: CanvasRenderingContext2D,
  x: (e: number) => number,
  y: (lane: number) => number,
  width: number,
  now_e_s: number,
  colours: Surface['colours'],
): void {
  const edge = width - 14;
  c.save();
  c.strokeStyle = c.fillStyle = colours.dim;
  c.textAlign = 'left';
  c.font = `${TYPE.mark}px ${colours.sans}`;
  const write = (all: readonly string[], from: number, to: number, at_y: number) => {
    const begin = Math.max(GUTTER, from, x(now_e_s));
    const words = all.find((each) => c.measureText(each).width + 8 <= to - begin);
    if (words !== undefined) c.fillText(words, begin + 5, at_y);
  };
  for (const [lane, link] of [
    [TONE, 'x_band'],
    [DOPPLER, 'x_band'],
    [LIVE, 'uhf_live'],
  ] as const) {
    const all = windowsOf('silence', link);
    for (const [i, silence] of all.entries()) {
      const from = Math.max(GUTTER, x(silence.fromES));
      const to = Math.min(edge, x(silence.toES ?? Infinity));
      if (to < GUTTER || from > edge) continue;
      c.setLineDash([3, 3]);
      if (to - from < 2) line(c, Math.round(from) + 0.5, y(lane) - 8, Math.round(from) + 0.5, y(lane) + 8);
      else c.strokeRect(from + 0.5, y(lane) - 7.5, to - from - 1, 15);
      c.setLineDash([]);
      const next = Math.min(edge, x(all[i + 1]?.fromES ?? Infinity));
      if (to - from >= 2 || silence.fromES > now_e_s)
        write(windowWords(silence), from, to - from < 2 ? next : to, y(lane) + 0.5);
    }
  }
  for (const pass of passes()) {
    const lane = pass.link === 'uhf_live' ? LIVE : RECORDING;
    const [from, to] = [Math.max(GUTTER, x(pass.fromES)), Math.min(edge, x(pass.toES ?? Infinity))];
    if (to - from < 2) continue;
    c.globalAlpha = 0.4;
    c.fillRect(from, y(lane) + 9, to - from, 1);
    c.globalAlpha = 1;
    const times = `${fromEntry(pass.fromES)} to ${pass.toES === undefined ? '' : fromEntry(pass.toES)}`;
    if (lane === RECORDING && pass.fromES > now_e_s)
      write([`${pass.words} in view, records, ${times}`, `${pass.words} records`], from, to, y(lane) + 0.5);
    else if (pass.fromES > now_e_s)
      write([`${pass.words} in view ${times}`, `${pass.words} in view`], from, to, y(lane) + 0.5);
  }
  c.restore();
}

function drawOutages(
  c: CanvasRenderingContext2D,
  lanes: Lanes,
  x: (e: number) => number,
  y: (lane: number) => number,
  width: number,
  now_e_s: number,
  colours: Surface['colours'],
): void {
  for (const [lane, all, link] of [
    [TONE, lanes.toneOutages, 'x_band'],
    [DOPPLER, lanes.toneOutages, 'x_band'],
    [LIVE, lanes.liveOutages, 'uhf_live'],
  ] as const) {
    for (const outage of all) {
      const left = Math.max(GUTTER, x(outage.from));
      const right = Math.min(width - 14, x(outage.to));
      if (right < GUTTER || left > width || right - left < 2) continue;
      const { shape, token } = silenceStatus(outage);
      const colour = colours[token];
      c.fillStyle = colours.panel;
      c.fillRect(left, y(lane) - 8, right - left, 16);
      c.save();
      c.globalAlpha = 0.2;
      c.fillStyle = colour;
      c.fillRect(left, y(lane) - 8, right - left, 16);
      c.restore();
      c.strokeStyle = colour;
      c.setLineDash([3, 3]);
      c.strokeRect(left + 0.5, y(lane) - 7.5, right - left - 1, 15);
      c.setLineDash([]);
      c.fillStyle = colour;
      c.textAlign = 'left';
      c.font = `${TYPE.mark}px ${colours.sans}`;
      // As long a name as is whole there, else its mark. The name of a present one may reach into what is predicted of
      // it, where that has no room for it either.
      const [shortest = '', ...longer] = [shortestReason(outage.words), shortReason(outage.words), outage.words].map(
        (each) => `${shape} ${each}`,
      );
      const fits = (each: string, room: number) => c.measureText(each).width + 8 <= room;
      const ahead = windowsOf('silence', link).find((each) => each.fromES < now_e_s && (each.toES ?? 0) > now_e_s);
      const end = outage.to >= now_e_s && ahead ? Math.min(width - 14, x(ahead.toES ?? now_e_s)) : right;
      const words =
        [...longer.reverse(), shortest].find((each) => fits(each, right - left)) ??
        (fits(shortest, end - left) && !fits(shortest, end - right) ? shortest : shape);
      // The mark alone stays where it is, beside the words of what is predicted.
      if (fits(words, words === shape ? right - left : end - left)) c.fillText(words, left + 5, y(lane) + 0.5);
    }
  }
}

/**
 * Draws predictions: future ones in the accent's colour, past ones as they were predicted, and the new places under the
 * command in the form.
 */
function drawPredicted(
  c: CanvasRenderingContext2D,
  x: (e: number) => number,
  y: number,
  now_e_s: number,
  colours: Surface['colours'],
): void {
  for (const { id, e_s, fired, within } of predicted.value) {
    const px = x(e_s);
    if (within && x(within.to_e_s) > GUTTER) {
      // No wider than what is drawn: a bar of the interval, under the ring.
      c.strokeStyle = colours.dim;
      line(c, Math.max(GUTTER, x(within.from_e_s)), y, x(within.to_e_s), y);
    }
    if (px < GUTTER - 6) continue;
    ring(c, px, y, fired ? 2.4 : 3.6, fired || e_s < now_e_s ? colours.dim : colours.accent);
    hits.push({ x: px, y, id });
  }
  for (const { from_e_s, to_e_s } of moved.value ?? []) {
    const [from, to] = [x(from_e_s), x(to_e_s)];
    c.strokeStyle = colours.caution;
    c.setLineDash([2, 2]);
    line(c, from, y, to, y);
    ring(c, to, y, 5, colours.caution);
    c.setLineDash([]);
  }
}

/**
 * Features that the carrier's Doppler shows: each where the vehicle was, and until when ground had recognised it, in
 * words where they meet neither the next feature nor a silence nor now.
 */
function drawDoppler(
  c: CanvasRenderingContext2D,
  lanes: Lanes,
  x: (e: number) => number,
  y: number,
  edge: number,
  now_e_s: number,
  colours: Surface['colours'],
): void {
  c.font = `${TYPE.mark}px ${colours.sans}`;
  c.textAlign = 'left';
  const silences = [
    ...lanes.toneOutages.map(({ from }) => from),
    ...windowsOf('silence', 'x_band').map((w) => w.fromES),
  ];
  for (const [i, { e_s, told_e_s }] of lanes.doppler.entries()) {
    const px = x(e_s);
    if (px < GUTTER - 6) continue;
    c.strokeStyle = colours.tone;
    line(c, px, y, x(told_e_s), y);
    triangle(c, px, y, colours.tone);
    const later = `${(told_e_s - e_s).toFixed(1)} s later`;
    const ends = [now_e_s, lanes.doppler[i + 1]?.e_s ?? Infinity, ...silences.filter((from) => from > e_s)];
    const room = Math.min(edge, x(Math.min(...ends))) - px - 12;
    const words = [`seen ${later}`, later].find((each) => c.measureText(each).width < room);
    if (words !== undefined) c.fillText(words, px + 8, y + 0.5);
  }
}

function marks(
  all: Mark[],
  x: (e: number) => number,
  y: number,
  shape: (x: number, y: number, bad: boolean) => void,
  hit: boolean,
): void {
  for (const mark of all) {
    const px = x(mark.e_s);
    if (px < GUTTER - 6) continue;
    shape(px, y, mark.bad);
    if (hit) hits.push({ x: px, y, id: mark.id });
  }
}

/** Draws the names below the lanes, in as many rows as keep them apart. */
function labels(
  c: CanvasRenderingContext2D,
  lanes: Lanes,
  x: (e: number) => number,
  top: number,
  width: number,
  height: number,
  colours: Surface['colours'],
): void {
  const { from, to } = shown(shownRun());
  const closeUp = to - from <= CLOSE_UP_S;
  const known = new Map<number, { mark: Mark; done: boolean }>();
  for (const mark of lanes.plan) known.set(mark.id, { mark, done: false });
  for (const { id, name, e_s, fired } of predicted.value)
    if (!fired) known.set(id, { mark: { id, name, e_s, important: isImportant(name), bad: false }, done: false });
  for (const mark of [...lanes.heardByTone, ...lanes.recorded, ...lanes.live]) known.set(mark.id, { mark, done: true });
  const run = shownRun();
  const moments = run ? momentsOf(run, timepoints.value, cutoff.value) : [];
  for (const [i, { name, e_s, done }] of moments.entries()) {
    if (e_s !== undefined) known.set(-1 - i, { mark: { id: -1 - i, name, e_s, important: true, bad: false }, done });
  }
  const all = [...known.values()]
    .filter(({ mark }) => mark.important || closeUp)
    .sort((a, b) => Number(b.mark.important) - Number(a.mark.important) || a.mark.e_s - b.mark.e_s);
  const rows: [number, number][][] = Array.from({ length: Math.max(0, Math.floor((height - top - 6) / 15)) }, () => []);
  c.font = `${TYPE.table}px ${colours.sans}`;
  c.textAlign = 'center';
  const amiss = lanes.amiss
    .filter(({ words }) => words.length <= AMISS_LETTERS)
    .map(({ e_s, words, danger }) => ({
      e_s,
      words,
      colour: danger ? colours.alarm : colours.caution,
      important: true,
    }));
  const names = all.map(({ mark: { e_s, name, important }, done }) => ({
    e_s,
    words: shortTitle(name),
    colour: done ? colours.text : colours.dim,
    important,
  }));
  for (const { e_s, words, colour, important } of [...amiss, ...names]) {
    const px = x(e_s);
    if (px < GUTTER || px > width - 14) continue;
    const half = c.measureText(words).width / 2 + 5;
    const at = Math.min(width - 14 - half, Math.max(GUTTER + half, px));
    const row = rows.findIndex((taken) => taken.every(([left, right]) => at + half < left || at - half > right));
    if (row < 0) continue;
    rows[row]?.push([at - half, at + half]);
    c.strokeStyle = colours.line;
    line(c, px, top, px, top + 6 + row * 15);
    c.fillStyle = colour;
    c.globalAlpha = important ? 1 : 0.75;
    c.fillText(words, at, top + 13 + row * 15);
    c.globalAlpha = 1;
  }
}

function cursors(
  c: CanvasRenderingContext2D,
  seen: number,
  lightTime: number,
  x: (e: number) => number,
  bottom: number,
  colours: Surface['colours'],
  right: number,
  going: boolean,
): void {
  const past = pastRange.value; // a past view keeps both flags at its instant
  if (lightTime > 0)
    flag(c, x(seen + lightTime), past ? 'then at Mars' : 'at Mars', colours.dim, colours.page, bottom, right);
  flag(
    c,
    x(seen),
    replay.value ? 'replayed to' : past ? 'end of past view' : !going ? 'end' : lightTime > 0 ? 'seen on Earth' : 'now',
    colours.text,
    colours.page,
    bottom,
    right,
  );
}

function flag(
  c: CanvasRenderingContext2D,
  px: number,
  words: string,
  colour: string,
  ink: string,
  bottom: number,
  right: number,
): void {
  if (px < GUTTER - 6 || px > right + 10) return; // a zoomed stretch may end before it
  c.strokeStyle = colour;
  line(c, Math.round(px) + 0.5, TOP - 8, Math.round(px) + 0.5, bottom + 4);
  c.font = `bold ${TYPE.mark}px ${palette().sans}`;
  const half = c.measureText(words).width / 2 + 6;
  const middle = Math.max(GUTTER + half - 6, Math.min(right - half, px));
  c.fillStyle = colour;
  c.beginPath();
  c.roundRect(middle - half, 3, half * 2, 17, 3);
  c.fill();
  c.fillStyle = ink;
  c.textAlign = 'center';
  c.fillText(words, middle, 12);
}

function line(c: CanvasRenderingContext2D, x1: number, y1: number, x2: number, y2: number): void {
  c.lineWidth = 1;
  c.beginPath();
  c.moveTo(x1, y1);
  c.lineTo(x2, y2);
  c.stroke();
}
function ring(c: CanvasRenderingContext2D, x: number, y: number, r: number, colour: string): void {
  c.strokeStyle = colour;
  c.beginPath();
  c.arc(x, y, r, 0, 7);
  c.stroke();
}
function framed(c: CanvasRenderingContext2D, x: number, y: number, r: number, colour: string): void {
  box(c, x, y, r / 2, colour);
  c.strokeStyle = colour;
  c.strokeRect(x - r, y - r, 2 * r, 2 * r);
}
function box(c: CanvasRenderingContext2D, x: number, y: number, r: number, colour: string): void {
  c.fillStyle = colour;
  c.fillRect(x - r, y - r, 2 * r, 2 * r);
}
function diamond(c: CanvasRenderingContext2D, x: number, y: number, r: number, colour: string): void {
  c.fillStyle = colour;
  c.beginPath();
  c.moveTo(x, y - r);
  c.lineTo(x + r, y);
  c.lineTo(x, y + r);
  c.lineTo(x - r, y);
  c.fill();
}
function triangle(c: CanvasRenderingContext2D, x: number, y: number, colour: string): void {
  c.fillStyle = colour;
  c.beginPath();
  c.moveTo(x, y - 5);
  c.lineTo(x + 5, y + 4);
  c.lineTo(x - 5, y + 4);
  c.fill();
}

function selectAt(px: number, py: number): void {
  let best: (typeof hits)[number] | undefined;
  for (const hit of hits) {
    const distance = (each: typeof hit) => Math.hypot(each.x - px / grown, each.y - py / grown);
    if (distance(hit) < 14 && (!best || distance(hit) < distance(best))) best = hit;
  }
  select(best?.id);
}

function timeAt(px: number, width: number): number {
  const { from, to } = shown(shownRun());
  return from + ((px / grown - GUTTER) / (width / grown - GUTTER - 14)) * (to - from);
}
const within = (px: number, width: number) => (px / grown < GUTTER ? undefined : timeAt(px, width));

const CHOICES: [Choice & string, string, string][] = [
  ['landing', 'landing', '1'],
  ['minute', 'last minute', '2'],
  ['run', 'whole run', '3'],
];

const BY = { uhf: SOURCES.uhf, recording: SOURCES.recording, tone: SOURCES.tone } as const;

function Conditions({ lines }: { lines: readonly Line[] }) {
  if (lines.length === 0) return null;
  return (
    <ul class="point-conditions" aria-label="its conditions">
      {lines.map((line) => (
        <li key={line.words} class={held(line.holds)}>
          <span title={STATUS[held(line.holds)].word}>{STATUS[held(line.holds)].shape}</span> {line.words}{' '}
          <output>{line.value}</output>
        </li>
      ))}
    </ul>
  );
}

function Detail() {
  const run = runNow();
  const [id, words] = [selected.value, dictionary.value];
  if (!run || !words || id === undefined) return null;
  const detail = pointDetail(run, words, timepoints.value, id, cutoff.value);
  if (!detail) return null;
  const { row, why } = detail;
  const foreseen = predicted.value.find((each) => each.id === id);
  const offset = (value: number | undefined) => (value === undefined ? 'undefined' : `${value} s`);
  const at = (e_s: number) => fromEntry(e_s, { tenths: true });
  const isOver = detail.by !== undefined || detail.state === 'passed';
  // For a fired timepoint, flight's conditions at the firing; otherwise its present conditions.
  const lines = !isOver
    ? conditions(run, words, timepoints.value, row, cutoff.value, predicted.value)
    : why?.verdict === 'fired'
      ? why.conditions.map(conditionLine)
      : [];
  return (
    <div class="point" data-testid="timepoint-detail">
      <b>{title(row.name)}</b>{' '}
      <span class={`state state-${detail.state.replaceAll(' ', '-')}`}>
        {detail.state}
        {detail.by && `, ${BY[detail.by].shape} ${BY[detail.by].word}`}
      </span>
      <button type="button" class="quiet" onClick={() => select(undefined)} aria-label="close">
        ×
      </button>
      <dl>
        <dt>desired</dt>
        <dd>
          {offset(row.desiredOffsetS)} after {row.anchor || 'the one before'}
        </dd>
        <dt>minimum</dt>
        <dd>{offset(row.minimumOffsetS)} after the one before</dd>
        {!foreseen && row.notPredicted !== '' && !isOver && (
          <>
            <dt>not predicted</dt>
            <dd>{row.notPredicted}</dd>
          </>
        )}
        {foreseen && (
          <>
            <dt>{foreseen.fired ? 'was predicted' : 'predicted'}</dt>
            <dd>{at(foreseen.e_s)}</dd>
          </>
        )}
        {foreseen?.flights !== undefined && (
          <>
            <dt>in 99 of 100</dt>
            <dd data-testid="timepoint-within">
              {foreseen.within
                ? `${at(foreseen.within.from_e_s)} to ${at(foreseen.within.to_e_s)}, by ${foreseen.flights} flights of the plan`
                : `not known: ${foreseen.flights} flights of the plan are too few`}
            </dd>
          </>
        )}
        {row.plannedES !== undefined && (
          <>
            <dt>planned</dt>
            <dd>{at(row.plannedES)}</dd>
          </>
        )}
        {detail.triggered_e_s !== undefined && (
          <>
            <dt>triggered</dt>
            <dd>{at(detail.triggered_e_s)}</dd>
          </>
        )}
        {detail.tone_e_s !== undefined && (
          <>
            <dt>heard by tone</dt>
            <dd>
              its beginning {at(detail.tone_e_s)}, posterior {posteriorText(detail.posterior ?? NaN)}
            </dd>
          </>
        )}
        {detail.firedLive_e_s !== undefined && (
          <>
            <dt>fired, by telemetry</dt>
            <dd>{at(detail.firedLive_e_s)}</dd>
          </>
        )}
        {detail.firedRecorded_e_s !== undefined && (
          <>
            <dt>fired, by recording</dt>
            <dd>{at(detail.firedRecorded_e_s)}</dd>
          </>
        )}
        {ENDS[detail.verdict] && (
          <>
            <dt>how it ended</dt>
            <dd>{ENDS[detail.verdict]}</dd>
          </>
        )}
        {row.tone && (
          <>
            <dt>tone</dt>
            <dd>{row.tone}</dd>
          </>
        )}
      </dl>
      {detail.state === 'passed' && <p>Nothing told of it; one after it has fired, so it is past.</p>}
      <Conditions lines={lines} />
      {why && <p class="why">why: {why.text}</p>}
      {row.note && <p>{noteWords(row.note)}</p>}
    </div>
  );
}

/** Flight's verdicts in words. */
const ENDS: Record<string, string> = {
  completed: 'done; no reply was asked for',
  verified: 'the reply says that it is done',
  unverified: 'no reply in time: done or not, nobody knows yet',
  no_operation: 'nothing was to be done',
  refused: 'the reply says that it is not done',
};

const ANCHOR_SHAPES = { defined: '✓', predicted: '◌', undefined: '?' } as const;

function AnchorTree() {
  if (!anchorsShown.value) return null;
  const lines = anchorLines.value;
  return (
    <div class="point anchors" data-testid="anchors" role="region" aria-label="anchors" tabIndex={0}>
      <b>Anchors</b> that timepoints hang from{' '}
      <button type="button" class="quiet" onClick={() => (anchorsShown.value = false)} aria-label="close">
        ×
      </button>
      {lines.length === 0 && <p>no anchors have come yet</p>}
      <table>
        <thead>
          <tr>
            <th>anchor</th>
            <th class="number">offset from parent</th>
            <th class="number">is at</th>
            <th>state, by</th>
          </tr>
        </thead>
        <tbody>
          {lines.map((line) => (
            <tr key={line.id} data-anchor={line.name} class={line.state === 'defined' ? '' : 'status-dim'}>
              <td style={{ paddingLeft: `${line.depth * 14}px` }}>
                {line.depth > 0 && '└ '}
                {title(line.name)}
              </td>
              <td class="number">
                {line.parent === '' ? '' : line.offset_s === undefined ? 'undefined' : `${line.offset_s} s`}
              </td>
              <td class="number">{line.e_s === undefined ? '—' : fromEntry(line.e_s, { tenths: true })}</td>
              <td>
                {ANCHOR_SHAPES[line.state]} {line.state}: {line.by}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

const UnderWay = openedLater(async () => (await import('../procedures/under_way')).UnderWay);

export function Timeline() {
  const run = runNow();
  const fired = run ? firedCount(run, timepoints.value, cutoff.value) : { all: 0, byTone: 0 };
  return (
    <Panel
      name="timeline"
      title="Timeline"
      extra={
        <>
          {predictedAsOf.value !== undefined && (
            <span data-testid="predicted-as-of">predicted as of {fromEntry(predictedAsOf.value)}</span>
          )}
          <span data-testid="timepoints-fired">
            {fired.all} of {timepoints.value.length} timepoints fired{fired.byTone > 0 && `, ■ ${fired.byTone} by tone`}
          </span>
          <button type="button" aria-pressed={anchorsShown.value} title="key h" onClick={toggleAnchors}>
            anchors
          </button>
          <span class="choices" role="group" aria-label="Stretch of time">
            {CHOICES.map(([id, words, key]) => (
              <button
                type="button"
                key={id}
                aria-pressed={choice.value === id}
                disabled={pastRange.value !== undefined && !replay.value}
                onClick={() => (choice.value = id)}
                title={`key ${key}`}
              >
                {words}
              </button>
            ))}
            <button type="button" title="key ]" aria-label="zoom in" onClick={() => zoom(run, 0.5)}>
              +
            </button>
            <button type="button" title="key [" aria-label="zoom out" onClick={() => zoom(run, 2)}>
              −
            </button>
            <button type="button" aria-label="earlier" title="key ←" onClick={() => pan(run, -0.25)}>
              ‹
            </button>
            <button type="button" aria-label="later" title="key →" onClick={() => pan(run, 0.25)}>
              ›
            </button>
          </span>
        </>
      }
    >
      <Canvas
        label="Timepoints by plan, prediction, tone, Doppler, live telemetry and recording, over time from entry"
        testId="timeline-canvas"
        keyOf={() => {
          const span = shown(shownRun());
          return `${shownRun()?.id} ${withRecording.value} ${tick.value} ${span.from} ${span.to} ${timepoints.value.length} ${cutoff.value} ${selected.value} ${cursor.value} ${JSON.stringify(moved.value)} ${timelineKnown.value?.at_ms} ${isPredicted()}`;
        }}
        draw={drawTimeline}
        onPoint={selectAt}
        onHover={(px, width) => (cursor.value = px === undefined ? undefined : within(px, width))}
        onWheel={(px, width, delta) => {
          zoom(shownRun(), delta > 0 ? 1.25 : 0.8, timeAt(px, width));
        }}
      />
      <Detail />
      <AnchorTree />
      {run && run.proceduresVersion > 0 && <UnderWay />}
    </Panel>
  );
}
