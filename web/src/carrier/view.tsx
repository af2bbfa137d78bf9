// SPDX-License-Identifier: Apache-2.0
// The X-band carrier: how far it lies from its predict over time, and what its Doppler has shown.
import { useEffect } from 'preact/hooks';
import { TYPE } from '../design/type';
import { axisNumber, ticks, timeLabel, timeStep, valueTicks } from '../draw/axis';
import { Canvas } from '../draw/canvas';
import type { Surface } from '../draw/canvas';
import { seriesPath } from '../recorded/model';
import { ask, isLost } from '../run/connection';
import { cursor } from '../run/cursor';
import { cutoff, dictionary, shownRun, store, tick } from '../run/shown';
import { fromEntry } from '../run/time';
import { plotSpan, zoomedTo } from '../run/window';
import { featuresSeen } from '../timeline/model';
import { columnsOf } from '../stream/series_answer';
import type { SeriesAnswer } from '../stream/series_answer';
import { CARRIER } from './layout';
import { carrierWords, isKnown, residualLines } from './model';
import { Waterfall } from './waterfall_view';
import './style.css';

const NAMES = [CARRIER.lock, CARRIER.residual, CARRIER.sigma, CARRIER.rate, CARRIER.level].flat();
const LEFT = 62;
const RIGHT = 12;
const BOTTOM = 20;
const TOP = 14;
const LEAST_HZ = 2; // chosen: the noise of a quiet carrier stays small
const POINTS = 1000; // chosen: one a pixel, within the 2048 that a channel may hold which is no plot

export function draw({ context: c, width, height, colours }: Surface): void {
  const [run, words] = [shownRun(), dictionary.value];
  const { from, to } = plotSpan(run);
  const lines = run && words ? residualLines(run, words, from, to, cutoff.value) : [];
  const all = lines.flat().map(({ hz }) => hz);
  const [least, most] = all.reduce(([low, high], hz) => [Math.min(low, hz), Math.max(high, hz)], [-LEAST_HZ, LEAST_HZ]);
  const [low, high] = [least - 0.05 * (most - least), most + 0.05 * (most - least)];
  const bottom = height - BOTTOM;
  const x = (e_s: number) => LEFT + ((e_s - from) / (to - from)) * (width - LEFT - RIGHT);
  const y = (hz: number) => bottom - ((hz - low) / (high - low)) * (bottom - TOP);
  c.font = `${TYPE.mark}px ${colours.mono}`;
  c.textBaseline = 'middle';
  c.lineWidth = 1;
  c.textAlign = 'right';
  for (const hz of valueTicks(low, high, bottom - TOP)) {
    c.strokeStyle = hz === 0 ? colours.edge : colours.line;
    c.beginPath();
    c.moveTo(LEFT, Math.round(y(hz)) + 0.5);
    c.lineTo(width - RIGHT, Math.round(y(hz)) + 0.5);
    c.stroke();
    c.fillStyle = colours.dim;
    c.fillText(axisNumber(hz), LEFT - 8, y(hz));
  }
  c.textAlign = 'center';
  const step = timeStep(to - from, Math.floor(width / 100));
  const label = timeLabel(run?.entryKnown !== false);
  for (const e_s of ticks(from, to, step)) if (x(e_s) < width - 26) c.fillText(label(e_s, step), x(e_s), height - 8);
  c.save();
  c.beginPath();
  c.rect(LEFT, 0, width - LEFT - RIGHT, height);
  c.clip();
  for (const { e_s } of run ? featuresSeen(run, cutoff.value) : []) {
    c.fillStyle = colours.tone;
    c.fillRect(Math.round(x(e_s)), 0, 1, bottom);
  }
  c.strokeStyle = colours.tone;
  for (const line of lines) {
    c.beginPath();
    for (const { e_s, hz } of line) c.lineTo(x(e_s), y(hz)); // the first one only begins it
    c.stroke();
  }
  if (cursor.value !== undefined) {
    c.fillStyle = colours.accent;
    c.fillRect(Math.round(x(cursor.value)), 0, 1, bottom);
  }
  c.restore();
}

/** Asks for the residuals of the run, or of the stretch that is looked at, as finely as they are drawn. */
function useHistory(): void {
  const run = store.value;
  const span = zoomedTo();
  const wanted = isKnown(dictionary.value);
  useEffect(() => {
    if (!run || !wanted) return;
    const [from, to] = span ? [run.entrySclk + span.from, run.entrySclk + span.to] : [run.run.startSclk, run.seenSclk];
    ask<SeriesAnswer[]>('series', seriesPath(run.id, NAMES, from, to, POINTS, true)).then(
      (list) => {
        if (store.peek() !== run) return;
        for (const column of columnsOf(list)) run.addRange([column], from, Math.min(to, column.sclk.at(-1) ?? to));
      },
      () => undefined, // the samples held stay; the header reports a lost connection
    );
  }, [run, wanted, span?.from, span?.to]);
}

export function Carrier() {
  void tick.value;
  useHistory();
  const [run, words] = [shownRun(), dictionary.value];
  if (!run || !words || !isKnown(words)) return null;
  const said = carrierWords(run, words, cutoff.value, isLost.value);
  return (
    <section class="carrier" data-testid="carrier">
      <h3>X-band carrier less its predict, in Hz</h3>
      <p data-testid="carrier-words">{said}</p>
      <Canvas
        label={`X-band carrier less its predict: ${said}`}
        testId="carrier-canvas"
        draw={draw}
        keyOf={() => {
          const [now, span] = [shownRun(), plotSpan(shownRun())];
          const channel = dictionary.value?.pick(CARRIER.residual);
          const version = channel && now?.live.get(channel.id)?.version;
          return `${now?.id} ${version} ${now?.events.length} ${Math.round(span.from * 2)} ${Math.round(span.to * 2)} ${cutoff.value} ${cursor.value}`;
        }}
      />
      <ul data-testid="carrier-features">
        {featuresSeen(run, cutoff.value).map(({ e_s, text }) => (
          <li key={e_s}>
            <time>{fromEntry(e_s)}</time> {text}
          </li>
        ))}
      </ul>
      <Waterfall />
    </section>
  );
}
