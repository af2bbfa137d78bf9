// The strip of tones: 256 high, 10 s wide each.
import { Canvas } from '../draw/canvas';
import type { Surface } from '../draw/canvas';
import { axisTime, ticks, timeStep } from '../draw/axis';
import { Panel } from '../design/panel';
import { cutoff, store, tick } from '../run/session';
import { plotSpan } from '../run/window';
import { bestTones, latestTone, toneBars, toneEvidence, toneSpectrum, toneTitle } from './model';
import './style.css';

const LEFT = 42;
const SPECTRUM = 76; // wide, at the right, where there is one
const LOUDEST_DB = 30;
const HEIGHTS = [64, 128, 256]; // the strip is as high as the tones that came need

/** What the receiver saw of the last symbol: beside the strip, each tone at its height in it. */
function drawSpectrum({ context: c, width, colours }: Surface, y: (tone: number) => number): void {
  const tone = store.value && latestTone(store.value, cutoff.value);
  const left = width - SPECTRUM;
  const right = width - 12;
  for (const { tone: low, level_db } of toneSpectrum(tone)) {
    const decided = tone?.tone !== undefined && (tone.tone & ~1) === low;
    const long = (Math.max(0, Math.min(LOUDEST_DB, level_db)) / LOUDEST_DB) * (right - left);
    const thick = decided ? 2 : 1;
    c.fillStyle = decided ? colours.tone : colours.dim;
    c.fillRect(left, y(low + 0.5) - thick / 2, Math.max(1, long), thick);
  }
  c.fillStyle = colours.dim;
  c.font = `10px ${colours.mono}`;
  c.textAlign = 'right';
  c.fillText(`${LOUDEST_DB} dB`, right, 10);
}

function draw(surface: Surface): void {
  const { context: c, height, colours } = surface;
  const run = store.value;
  const heard = toneSpectrum(run && latestTone(run, cutoff.value)).length > 0;
  const width = surface.width - (heard ? SPECTRUM : 0);
  const { from, to } = plotSpan(run);
  const bottom = height - 20;
  const x = (e_s: number) => LEFT + ((e_s - from) / (to - from)) * (width - LEFT - 12);
  const bars = run ? toneBars(run, cutoff.value) : [];
  const most = bars.reduce((largest, bar) => Math.max(largest, bar.tone ?? 0), 0);
  const high = HEIGHTS.find((height) => most < height) ?? 256;
  const y = (tone: number) => bottom - (tone / high) * (bottom - 22);
  c.font = `11px ${colours.mono}`;
  c.lineWidth = 1;
  c.textBaseline = 'middle';
  for (const tone of [0, high / 4, high / 2, (high * 3) / 4, high - 1]) {
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
  c.textAlign = 'center';
  for (const e_s of ticks(from, to, step)) if (x(e_s) < width - 26) c.fillText(axisTime(e_s, step), x(e_s), height - 8);
  c.save();
  c.beginPath();
  c.rect(LEFT, 0, width - LEFT - 10, height);
  c.clip();
  let labelled = -Infinity;
  const lastLeft = x(bars[bars.length - 1]?.from_e_s ?? to);
  bars.forEach((bar, index) => {
    const left = x(bar.from_e_s);
    const wide = Math.max(2, x(bar.to_e_s) - left - 1);
    if (bar.tone === undefined) {
      // An erasure: an empty dashed box in the middle, never nothing.
      c.strokeStyle = colours.dim;
      c.setLineDash([2, 2]);
      c.strokeRect(left + 0.5, y(high / 2) - 3.5, wide, 7);
      c.setLineDash([]);
      return;
    }
    const last = index === bars.length - 1;
    c.globalAlpha = last ? 1 : 0.35 + 0.4 * Math.min(1, Math.max(0, bar.likelihood));
    c.fillStyle = colours.tone;
    c.fillRect(left, y(bar.tone) - 3.5, wide, 7);
    c.globalAlpha = 1;
    const before = bars[index - 1];
    const room = last || (left > labelled + 4 && left < lastLeft - 24);
    if (last || (before?.tone !== bar.tone && room)) {
      labelled = left + c.measureText(String(bar.tone)).width;
      c.fillStyle = last ? colours.text : colours.dim;
      c.font = last ? `bold 13px ${colours.mono}` : `10px ${colours.mono}`;
      c.textAlign = 'left';
      c.fillText(String(bar.tone), left, y(bar.tone) - 12);
    }
  });
  c.restore();
  if (!heard) return;
  c.save();
  c.beginPath();
  c.rect(surface.width - SPECTRUM, 0, SPECTRUM, bottom + 4); // tones above the strip's are not shown
  c.clip();
  drawSpectrum(surface, y);
  c.restore();
}

export function Tones() {
  void tick.value;
  const tone = store.value && latestTone(store.value, cutoff.value);
  return (
    <Panel name="tones" title={<span class="tone-title" data-testid="tone-title">{toneTitle(tone)}</span>}>
      <p class="tone-evidence" data-testid="tone-evidence" title={bestTones(tone)}>{toneEvidence(tone)}</p>
      <Canvas label={toneTitle(tone)} testId="tone-canvas" draw={draw} keyOf={() => {
        const span = plotSpan(store.value);
        return `${store.value?.id} ${store.value?.tones.length} ${Math.round(span.from * 2)} ${Math.round(span.to * 2)} ${cutoff.value}`;
      }} />
    </Panel>
  );
}
