// The strip of tones: 256 high, 10 s wide each.
import { Canvas } from '../draw/canvas';
import type { Surface } from '../draw/canvas';
import { axisTime, ticks, timeStep } from '../draw/axis';
import { Panel } from '../panel';
import { cutoff, store, tick } from '../run/session';
import { plotSpan } from '../run/window';
import { latestTone, toneBars, toneEvidence, toneTitle } from './model';
import './style.css';

const LEFT = 42;
const HEIGHTS = [64, 128, 256]; // the strip is as high as the tones that came need

function draw({ context: c, width, height, colours }: Surface): void {
  const run = store.value;
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
    c.fillStyle = colours.violet;
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
}

export function Tones() {
  void tick.value;
  const tone = store.value && latestTone(store.value, cutoff.value);
  return (
    <Panel name="tones" title={<span class="tone-title" data-testid="tone-title">{toneTitle(tone)}</span>}>
      <p class="tone-evidence" data-testid="tone-evidence">{toneEvidence(tone)}</p>
      <Canvas label={toneTitle(tone)} testId="tone-canvas" draw={draw} keyOf={() => {
        const span = plotSpan(store.value);
        return `${store.value?.id} ${store.value?.tones.length} ${Math.round(span.from * 2)} ${Math.round(span.to * 2)} ${cutoff.value}`;
      }} />
    </Panel>
  );
}
