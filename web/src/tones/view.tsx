// SPDX-License-Identifier: Apache-2.0
// The strip of tones: 256 rows, 10 s per column.
import { signal } from '@preact/signals';
import { Canvas } from '../draw/canvas';
import { TYPE } from '../design/type';
import type { Surface } from '../draw/canvas';
import { ticks, timeLabel, timeStep } from '../draw/axis';
import { Panel } from '../design/panel';
import type { NamedTone } from '../stream/names';
import { isLost } from '../run/connection';
import { cursor } from '../run/cursor';
import { cutoff, shownRun, tick } from '../run/shown';
import { fromEntry } from '../run/time';
import { plotSpan } from '../run/window';
import {
  bestTones,
  isLast,
  neighbour,
  shownTone,
  toneBars,
  toneEvidence,
  toneSilence,
  toneSpectrum,
  toneTitle,
} from './model';
import './style.css';

const LEFT = 42;
const SPECTRUM = 106; // width of the spectrum at the right, if there is one
const TONES = 256;
const LOUDEST_DB = 30;
const LABEL_PX = 12;
const HEIGHTS = [64, 128, 256]; // the strip is only as high as the received tones need

/** Each part of a line of evidence stands in one piece. */
const unbroken = (evidence: string) =>
  evidence.split(' · ').map((part, i) => (
    <span key={i}>
      {i > 0 && ' · '}
      <span class="tone-part">{part}</span>
    </span>
  ));

/** The selected symbol of the run; undefined: the newest. */
const choice = signal<{ run: number; sclk: number } | undefined>(undefined);
const chosenSclk = () => (choice.value?.run === shownRun()?.id ? choice.value?.sclk : undefined);
function toneNow(): NamedTone | undefined {
  const run = shownRun();
  return run && shownTone(run, cutoff.value, chosenSclk());
}
function look(sclk: number | undefined): void {
  const run = shownRun();
  choice.value = sclk === undefined || !run ? undefined : { run: run.id, sclk };
}

export function focusTones(): void {
  document.querySelector<HTMLElement>('[data-testid="tone-symbols"]')?.focus();
}

function onKey(event: KeyboardEvent): void {
  const run = shownRun();
  const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key] as 1 | -1 | undefined;
  if (event.key === 'Escape' && chosenSclk() !== undefined) look(undefined);
  else if (run && direction && !event.shiftKey) look(neighbour(run, cutoff.value, toneNow()?.sclk, direction));
  else return;
  event.preventDefault();
}

let scale: { from: number; to: number; width: number } | undefined; // the strip as last drawn
const timeAt = (px: number) =>
  scale && scale.from + ((px - LEFT) / (scale.width - LEFT - 12)) * (scale.to - scale.from);

function choose(px: number): void {
  const [run, e_s] = [shownRun(), timeAt(px)];
  if (!run || e_s === undefined) return;
  const bars = toneBars(run, cutoff.value);
  const at = bars.findLastIndex((bar) => bar.from_e_s <= e_s);
  look(at < 0 || at === bars.length - 1 ? undefined : run.tonesBy(cutoff.value)[at]?.fact.sclk);
}

/**
 * The spectrum of the selected symbol beside the strip: all 256 tones on a scale of its own, with the numbers of the
 * decided tone and the runner-up.
 */
export function drawSpectrum(
  { context: c, width, colours }: Pick<Surface, 'context' | 'width' | 'colours'>,
  tone: NamedTone | undefined,
  bottom: number,
): void {
  const y = (index: number) => bottom - (index / TONES) * (bottom - 22);
  const [left, right] = [width - SPECTRUM + 30, width - 12];
  const numbered = [tone?.tone, tone?.runnerUp].filter((each) => each !== undefined);
  c.font = `${TYPE.mark}px ${colours.mono}`;
  c.textBaseline = 'middle';
  c.fillStyle = colours.dim;
  c.fillRect(left - 2, y(TONES), 1, bottom - y(TONES));
  c.textAlign = 'right';
  const apart = (bottom - y(TONES)) / 4;
  for (const [i, each] of [0, 64, 128, 192, TONES - 1].entries())
    if ((i % 4 === 0 ? 4 : 1) * apart >= LABEL_PX) c.fillText(String(each), left - 6, y(each));
  c.fillText(`${LOUDEST_DB} dB`, right, 10);
  for (const { tone: low, level_db } of toneSpectrum(tone)) {
    const long = (Math.max(0, Math.min(LOUDEST_DB, level_db)) / LOUDEST_DB) * (right - left);
    const which = numbered.find((each) => (each & ~1) === low);
    const thick = which === undefined ? 1 : 2;
    c.fillStyle = which === undefined ? colours.dim : which === tone?.tone ? colours.tone : colours.text;
    c.fillRect(left, y(low + 0.5) - thick / 2, Math.max(1, long), thick);
    const isCrowded = which !== undefined && tone?.tone !== undefined && Math.abs(y(which) - y(tone.tone)) < LABEL_PX;
    if (which === undefined || (which !== tone?.tone && isCrowded)) continue;
    const room = right - left - long > 24;
    c.textAlign = room ? 'left' : 'right';
    c.fillText(String(which), room ? left + long + 4 : right, y(low + 0.5) + (room ? 0 : -8));
  }
}

function draw(surface: Surface): void {
  const { context: c, height, colours } = surface;
  const run = shownRun();
  const looked = toneNow();
  const heard = toneSpectrum(looked).length > 0;
  const width = surface.width - (heard ? SPECTRUM : 0);
  const { from, to } = plotSpan(run);
  scale = { from, to, width };
  const bottom = height - 20;
  const x = (e_s: number) => LEFT + ((e_s - from) / (to - from)) * (width - LEFT - 12);
  const bars = run ? toneBars(run, cutoff.value) : [];
  const most = bars.reduce((largest, bar) => Math.max(largest, bar.tone ?? 0), 0);
  const high = HEIGHTS.find((height) => most < height) ?? 256;
  const y = (tone: number) => bottom - (tone / high) * (bottom - 22);
  c.font = `${TYPE.mark}px ${colours.mono}`;
  c.lineWidth = 1;
  c.textBaseline = 'middle';
  const quarters = [0, high / 4, high / 2, (high * 3) / 4, high - 1];
  const apart = (y(0) - y(high)) / 4;
  for (const tone of quarters.filter((_, i) => (i % 4 === 0 ? 4 : 1) * apart >= LABEL_PX)) {
    c.strokeStyle = colours.line;
    c.beginPath();
    c.moveTo(LEFT, Math.round(y(tone)) + 0.5);
    c.lineTo(width - 12, Math.round(y(tone)) + 0.5);
    c.stroke();
    c.fillStyle = colours.dim;
    c.textAlign = 'right';
    c.fillText(String(tone), LEFT - 8, y(tone));
  }
  const step = timeStep(to - from, Math.floor(width / 100));
  c.fillStyle = colours.dim;
  c.textAlign = 'center';
  const label = timeLabel(run?.entryKnown !== false);
  for (const e_s of ticks(from, to, step)) if (x(e_s) < width - 26) c.fillText(label(e_s, step), x(e_s), height - 8);
  c.save();
  c.beginPath();
  c.rect(LEFT, 0, width - LEFT - 10, height);
  c.clip();
  let labelled = -Infinity;
  const lastLeft = looked && run ? x(looked.sclk - run.entrySclk) : x(to);
  bars.forEach((bar, index) => {
    const left = x(bar.from_e_s);
    const wide = Math.max(2, x(bar.to_e_s) - left - 1);
    if (run?.tones[index]?.fact === looked && chosenSclk() !== undefined) {
      c.strokeStyle = colours.text;
      c.strokeRect(left - 2.5, y(bar.tone ?? high / 2) - 6.5, wide + 5, 13);
    }
    if (bar.tone === undefined) {
      // An erasure is an empty dashed box in the middle.
      c.strokeStyle = colours.dim;
      c.setLineDash([2, 2]);
      c.strokeRect(left + 0.5, y(high / 2) - 3.5, wide, 7);
      c.setLineDash([]);
      return;
    }
    const last = run?.tones[index]?.fact === looked;
    c.globalAlpha = last ? 1 : 0.35 + 0.4 * Math.min(1, Math.max(0, bar.likelihood));
    c.fillStyle = colours.tone;
    c.fillRect(left, y(bar.tone) - 3.5, wide, 7);
    c.globalAlpha = 1;
    const before = bars[index - 1];
    const room = last || (left > labelled + 4 && (left < lastLeft - 24 || left > lastLeft + 24));
    if (last || (before?.tone !== bar.tone && room)) {
      labelled = left + c.measureText(String(bar.tone)).width;
      c.fillStyle = last ? colours.text : colours.dim;
      c.font = last ? `bold ${TYPE.body}px ${colours.mono}` : `${TYPE.mark}px ${colours.mono}`;
      c.textAlign = 'left';
      c.fillText(String(bar.tone), left, y(bar.tone) - 12);
    }
  });
  if (cursor.value !== undefined) {
    c.fillStyle = colours.accent;
    c.fillRect(Math.round(x(cursor.value)), 0, 1, bottom);
  }
  c.restore();
  if (heard) drawSpectrum(surface, looked, bottom);
}

export function Tones() {
  void tick.value;
  const [run, tone] = [shownRun(), toneNow()];
  const back = tone !== undefined && tone.sclk === chosenSclk();
  const at_e_s = run && tone && tone.sclk - run.entrySclk;
  const old = !back && run !== undefined && tone !== undefined && isLast(run, cutoff.value, isLost.value);
  const title = toneTitle(tone, old ? at_e_s : undefined);
  return (
    <Panel
      name="tones"
      title={
        <span class={`tone-title ${old ? 'tone-old' : ''}`} data-testid="tone-title">
          {title}
        </span>
      }
      extra={
        back && (
          <button type="button" class="quiet" data-testid="tone-newest" onClick={() => look(undefined)}>
            newest <kbd>Esc</kbd>
          </button>
        )
      }
    >
      <p class="tone-evidence" data-testid="tone-evidence">
        {at_e_s !== undefined && !old && (
          <>
            <b>at {fromEntry(at_e_s)}</b> ·{' '}
          </>
        )}
        {run?.entryKnown === false && !tone
          ? 'no tone comes over this link'
          : unbroken(toneEvidence(tone, run && toneSilence(run, cutoff.value)))}
        {back && bestTones(tone) !== '' && ` · likeliest ${bestTones(tone)}`}
      </p>
      <div
        class="tone-symbols"
        data-testid="tone-symbols"
        role="group"
        aria-label="symbols: ← → choose one"
        tabIndex={0}
        onKeyDown={onKey}
      >
        <Canvas
          label={title}
          testId="tone-canvas"
          draw={draw}
          onPoint={choose}
          onHover={(px) => (cursor.value = px === undefined || px < LEFT ? undefined : timeAt(px))}
          keyOf={() => {
            const strip = shownRun();
            const span = plotSpan(strip);
            return `${strip?.id} ${strip?.tones.length} ${Math.round(span.from * 2)} ${Math.round(span.to * 2)} ${cutoff.value} ${chosenSclk()} ${cursor.value}`;
          }}
        />
      </div>
    </Panel>
  );
}
