// SPDX-License-Identifier: Apache-2.0
// Plots over one time axis with one cursor. History and live data are one trace; a gap stays a gap.
import { useLayoutEffect, useRef } from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { TYPE } from '../design/type';
import { CHARACTER_PX, axisNumber, shortStep, shortTime, ticks, valueTicks } from '../draw/axis';
import { grownBy } from '../draw/canvas';
import { onDraw } from '../draw/loop';
import { palette } from '../draw/palette';
import { LAYOUT } from '../layout';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { Panel } from '../design/panel';
import { SOURCES, silenceStatus } from '../design/status';
import { staleWords } from '../channels/model';
import { cursor } from '../run/cursor';
import { inWords, numberText } from '../run/dictionary';
import { isWorst, limitsOver } from '../run/limits';
import { namedChannels } from '../run/address';
import { isLost } from '../run/connection';
import { cutoff, dictionary, shownRun, tick } from '../run/shown';
import type { Series } from '../run/series';
import { fromEntry } from '../run/time';
import { whoseAt } from '../run/whose';
import { LIVE_LINKS, liveOutages, shortReason } from '../timeline/model';
import { plotSpan } from '../run/window';
import { align, gapOf, readingAt } from './model';
import type { Aligned } from './model';
import './style.css';

interface Properties {
  title: string;
  channel: DictionaryChannel;
  unit: string;
  per: number;
  /** Of the reading; left out: those that fit the value. */
  digits?: number | undefined;
}

const X_AXIS_PX = 22;
const Y_AXIS_PX = 48;
const RIGHT_PX = 20;
/** The room for labels of time. The plot's own box still has its former size while ticks are chosen. */
const wideOf = (plot: uPlot): number => plot.width - Y_AXIS_PX - RIGHT_PX;

function options(width: number, height: number, channel: DictionaryChannel, per: number): uPlot.Options {
  const colours = palette();
  const axis = {
    stroke: colours.dim,
    font: `${TYPE.mark}px ${colours.mono}`,
    grid: { stroke: colours.line, width: 1 },
    ticks: { show: false },
  };
  return {
    width,
    height,
    legend: { show: false },
    pxAlign: 1,
    padding: [6, RIGHT_PX, 0, 0],
    cursor: { show: false }, // our own cursor is shared by plots, tones and timeline
    scales: { x: { time: false } },
    axes: [
      {
        ...axis,
        size: X_AXIS_PX,
        gap: 3,
        splits: (plot, _index, from, to) => ticks(from, to, shortStep(from, to, wideOf(plot))),
        values: (plot, splits) => {
          const { min = 0, max = 1 } = plot.scales.x ?? {};
          const step = shortStep(min, max, wideOf(plot));
          return splits.map((e_s) => shortTime(e_s, step));
        },
      },
      {
        ...axis,
        // as wide as its longest number: those of a large constant are whole too
        size: (_plot, words) => Math.max(Y_AXIS_PX, ...(words ?? []).map((each) => each.length * CHARACTER_PX + 10)),
        gap: 4,
        splits: (plot, _index, low, high) => valueTicks(low, high, plot.height - X_AXIS_PX),
        values: (_plot, splits) => splits.map(axisNumber),
      },
    ],
    series: [
      {},
      { stroke: colours.recording, width: 1, points: { show: false } },
      { stroke: colours.uhf, width: 1, points: { show: false } },
    ],
    hooks: {
      drawClear: [(plot) => shadeSilence(plot), (plot) => alarmBands(plot, channel, per)],
    },
  };
}

/** Shades the times without live telemetry, instead of drawing a line that was never measured. */
function shadeSilence(plot: uPlot): void {
  const run = shownRun();
  if (!run) return;
  const { left, top, width, height } = plot.bbox;
  const now = Math.min(run.seenSclk, cutoff.value) - run.entrySclk;
  plot.ctx.save();
  for (const outage of liveOutages(run, now, cutoff.value)) {
    const from = Math.max(left, plot.valToPos(outage.from, 'x', true));
    const to = Math.min(left + width, plot.valToPos(outage.to, 'x', true));
    if (to <= from) continue;
    const { shape, token } = silenceStatus(outage.words);
    plot.ctx.fillStyle = palette()[token];
    plot.ctx.globalAlpha = 0.1;
    plot.ctx.fillRect(from, top, to - from, height);
    const words = `${shape} ${shortReason(outage.words)}`;
    plot.ctx.font = `${TYPE.mark * (window.devicePixelRatio || 1)}px ${palette().sans}`;
    if (plot.ctx.measureText(words).width + 8 > to - from) continue;
    plot.ctx.globalAlpha = 1;
    plot.ctx.textAlign = 'center';
    plot.ctx.textBaseline = 'bottom';
    plot.ctx.fillText(words, (from + to) / 2, top + height - 4);
  }
  plot.ctx.restore();
}

/**
 * Shades the area outside each limit while the limit was in force, with its name. The worst limit is named first, so
 * that it has its name where room is short.
 */
function alarmBands(plot: uPlot, channel: DictionaryChannel, per: number): void {
  const [run, words] = [shownRun(), dictionary.value];
  const { min: from, max: to } = plot.scales.x ?? {};
  if (!run || !words || from === undefined || to === undefined) return;
  const { left, top, width, height } = plot.bbox;
  const [right, bottom] = [left + width, top + height];
  const colours = palette();
  const ratio = window.devicePixelRatio || 1;
  const { ctx } = plot;
  const named: { words: string; x: number; y: number; room: number; colour: string }[] = [];
  ctx.save();
  for (const stretch of limitsOver(
    run,
    words,
    channel,
    run.entrySclk + from,
    Math.min(run.seenSclk, cutoff.value, run.entrySclk + to),
  )) {
    const x1 = Math.max(left, plot.valToPos(stretch.from_sclk - run.entrySclk, 'x', true));
    const x2 = Math.min(right, plot.valToPos(stretch.to_sclk - run.entrySclk, 'x', true));
    if (x2 - x1 < 1) continue;
    for (const limit of stretch.limits) {
      const colour = isWorst(limit.severity) ? colours.alarm : colours.caution;
      for (const [bound, side] of [
        [limit.below, bottom],
        [limit.above, top],
      ] as const) {
        if (bound === undefined) continue;
        const y = plot.valToPos(bound / per, 'y', true);
        const above = side === top;
        if (above ? y <= top : y >= bottom) continue; // the bound is outside the plot
        const edge = Math.max(top, Math.min(bottom, y));
        ctx.fillStyle = colour;
        ctx.globalAlpha = 0.1;
        ctx.fillRect(x1, Math.min(edge, side), x2 - x1, Math.abs(side - edge));
        ctx.globalAlpha = 0.8;
        ctx.fillRect(x1, Math.round(edge), x2 - x1, ratio);
        const name = `${limit.severity} ${above ? '>' : '<'} ${+(bound / per).toPrecision(4)}${stretch.context && limit.context ? `, ${inWords(stretch.context)}` : ''}`;
        named.unshift({
          words: name,
          x: x1,
          room: x2 - x1,
          y:
            above && edge - top > 13 * ratio
              ? edge - 3 * ratio
              : bottom - edge > 13 * ratio
                ? edge + 11 * ratio
                : edge - 3 * ratio,
          colour,
        });
      }
    }
  }
  ctx.globalAlpha = 1;
  ctx.font = `${TYPE.mark * ratio}px ${colours.sans}`;
  ctx.textAlign = 'left';
  ctx.textBaseline = 'alphabetic';
  const taken: [number, number, number][] = []; // left, right, row
  for (const { words: whole, x, y, room, colour } of named.sort(
    (one, other) => Number(other.colour === colours.alarm) - Number(one.colour === colours.alarm),
  )) {
    const short = ctx.measureText(whole).width < room - 6 * ratio ? whole : (whole.split(',')[0] as string);
    if (y - 9 * ratio < top || y > bottom) continue;
    const wide = ctx.measureText(short).width;
    const at = Math.max(left + 2, Math.min(right - wide - 2, x + 3));
    if (taken.some(([from_px, to_px, line]) => at < to_px && at + wide > from_px && Math.abs(y - line) < 10 * ratio))
      continue;
    taken.push([at, at + wide, y]);
    ctx.fillStyle = colour;
    ctx.strokeStyle = colours.panel; // an outline against the lines of other limits; the trace is drawn later, over it
    ctx.lineWidth = 3 * ratio;
    ctx.lineJoin = 'round';
    ctx.strokeText(short, at, y);
    ctx.fillText(short, at, y);
  }
  ctx.restore();
}

function Plot({ title, channel, unit, per, digits }: Properties) {
  const box = useRef<HTMLDivElement>(null);
  const mark = useRef<HTMLElement>(null);
  const drawn = useRef<uPlot | undefined>(undefined);
  useLayoutEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    let plot: uPlot | undefined;
    let placed: number | undefined;
    const placeCursor = () => {
      const [at, line] = [cursor.peek(), mark.current];
      const { min = 0, max = 0 } = plot?.scales.x ?? {};
      if (!plot || !line) return;
      placed = at;
      line.hidden = at === undefined || at < min || at > max;
      if (!line.hidden) line.style.left = `${plot.over.offsetLeft + plot.valToPos(at as number, 'x')}px`;
    };
    let shown = '';
    // kept because a series as heard is a copy, which may have the same version as the whole
    let traces: (Series | undefined)[] = [];
    let shape = '';
    const stop = onDraw(() => {
      const width = element.clientWidth;
      const height = element.clientHeight;
      if (width < 60 || height < 40) return undefined;
      const run = shownRun();
      const recorded = run?.recorded.get(channel.id);
      const live = run?.live.get(channel.id);
      const span = plotSpan(run);
      const newShape = `${palette().name} ${channel.id}`;
      const changes = LIVE_LINKS.map((link) => run?.links.get(link) ?? []);
      const silences = changes.reduce((all, each) => all + each.length, 0);
      // a present silence grows with the clock, without new samples
      const silent = changes.every((each) => each.at(-1)?.fact.up !== true) ? run?.seenSclk.toFixed(0) : '';
      const key = `${run?.id} ${silences} ${silent} ${recorded?.version} ${live?.version} ${span.from.toFixed(1)} ${span.to.toFixed(1)} ${cutoff.value} ${width} ${height} ${newShape}`;
      if (key === shown && traces[0] === recorded && traces[1] === live)
        return cursor.peek() === placed ? undefined : placeCursor;
      shown = key;
      traces = [recorded, live];
      return () => {
        if (!plot || newShape !== shape) {
          plot?.destroy();
          shape = newShape;
          plot = drawn.current = new uPlot(options(width, height, channel, per), [[], [], []], element);
        } else if (plot.width !== width || plot.height !== height) {
          plot.setSize({ width, height });
        }
        const data = run
          ? align(
              recorded,
              live,
              liveOutages(run, span.to, cutoff.value),
              run.entrySclk,
              span.from,
              span.to,
              cutoff.value,
              per,
              width,
              gapOf(channel.expectedRateHz),
            )
          : ([[], [], []] as Aligned);
        element.dataset.holes = String(holesOf(data));
        element.dataset.newest = String(Math.max(recorded?.newestSclk ?? -Infinity, live?.newestSclk ?? -Infinity));
        plot.batch(() => {
          plot?.setData(data as uPlot.AlignedData, false);
          plot?.setScale('x', { min: span.from, max: span.to });
          const [low, high] = bounds(data);
          plot?.setScale('y', { min: low, max: high });
        });
        placeCursor();
      };
    });
    return () => {
      stop();
      plot?.destroy();
    };
  }, [channel.id, per]);

  void tick.value;
  const run = shownRun();
  const at = cursor.value;
  const now = run?.latest(channel.id, cutoff.value)?.value;
  const shown =
    at === undefined || !run ? undefined : readingAt(run, channel.id, at, cutoff.value, gapOf(channel.expectedRateHz));
  const value = at === undefined ? now : shown?.value;
  const sources = [run?.live.has(channel.id) && SOURCES.uhf, run?.recorded.has(channel.id) && SOURCES.recording].filter(
    (each) => each !== false && each !== undefined,
  );
  const whose =
    run &&
    whoseAt(
      run,
      channel.name,
      at === undefined ? (run.latest(channel.id, cutoff.value)?.sclk ?? -Infinity) : run.entrySclk + at,
    );
  const stale = at === undefined ? staleWords(run, channel, cutoff.value, isLost.value) : undefined;
  const name = title.toLowerCase();
  return (
    <Panel
      name={`plot-${name}`}
      title={title}
      extra={
        <span class={`reading ${at !== undefined ? 'at-cursor' : stale ? 'stale' : ''}`}>
          {stale && <span data-testid={`stale-${name}`}>{stale} </span>}
          {whose && (
            <span class="whose" data-testid={`whose-${name}`} title={whose}>
              <i>{whose.replace(/\S+$/, '')}</i>
              {/\S+$/.exec(whose)}{' '}
            </span>
          )}
          {at !== undefined ? (
            <span class="cursor-time" data-testid={`cursor-${name}`}>
              {fromEntry(at, { tenths: true })} {shown && (shown.recorded ? SOURCES.recording : SOURCES.uhf).shape}
            </span>
          ) : (
            !whose &&
            !stale && (
              <span class="legend">
                {sources.map((each) => (
                  <span key={each.word} style={{ color: `var(--${each.token})` }} title={each.word}>
                    {each.shape} <i>{each.word.split(/[ ,]/)[1]}</i>{' '}
                  </span>
                ))}
              </span>
            )
          )}{' '}
          <output data-testid={`reading-${name}`}>
            {value === undefined || Number.isNaN(value) ? '—' : reading(value / per, digits)}
          </output>{' '}
          {unit}
        </span>
      }
    >
      {now === undefined && <span class="plot-empty">no {channel.name} has come yet</span>}
      <div
        class={`plot ${now === undefined ? 'is-empty' : ''}`}
        ref={box}
        role="img"
        aria-label={`${title} in ${unit} over time from entry`}
        onMouseMove={(event) => {
          const plot = drawn.current;
          if (plot)
            cursor.value = plot.posToVal(
              (event.clientX - plot.over.getBoundingClientRect().left) / grownBy(plot.over),
              'x',
            );
        }}
        onMouseLeave={() => (cursor.value = undefined)}
      >
        <i class="plot-cursor" ref={mark} hidden />
      </div>
    </Panel>
  );
}

/** Formats a value, without a minus sign on zero. */
const reading = (value: number, digits: number | undefined): string =>
  (digits === undefined ? numberText(value) : value.toFixed(digits)).replace(/^-(?=0(\.0*)?$)/, '');

/** The number of instants at which neither trace continues, for observers that cannot see a canvas. */
function holesOf([x, silent, lit]: Aligned): number {
  let holes = 0;
  for (let i = 0; i < x.length; ++i) if (silent[i] === null && lit[i] === null) ++holes;
  return holes;
}

function bounds(data: readonly (readonly (number | null | undefined)[])[]): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const values of data.slice(1)) {
    for (const value of values) {
      if (value === null || value === undefined) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return [0, 1];
  const margin = high > low ? (high - low) * 0.06 : Math.max(1, Math.abs(high) * 0.1);
  return [low - margin, high + margin];
}

/** Channels named at ?panel=plots&channels=one,two. */
const NAMED = namedChannels();
const MOST_NAMED = 16; // chosen: more are not legible

export function Plots() {
  const words = dictionary.value;
  if (!words) return null;
  if (NAMED.length > 0) {
    return (
      <div class="plots plots-named">
        {NAMED.slice(0, MOST_NAMED).map((name) => {
          const channel = words.pick([name]);
          return channel ? (
            <Plot key={name} channel={channel} title={name} unit={channel.unit} per={1} />
          ) : (
            <p class="none" key={name}>
              no channel {name} in the dictionary
            </p>
          );
        })}
      </div>
    );
  }
  const taken = new Set<number>();
  return (
    <div class="plots">
      {LAYOUT.plots.map((pick) => {
        const known = words.pick(pick.channel);
        const channel =
          known ?? words.channels.find((candidate) => candidate.labels.length === 0 && !taken.has(candidate.id));
        if (!channel) return null;
        taken.add(channel.id);
        const scaled = known && (pick.unit === undefined || pick.channel.length > 0);
        return (
          <Plot
            key={channel.id}
            channel={channel}
            title={known ? pick.title : channel.name}
            unit={(scaled && pick.unit) || channel.unit}
            per={scaled ? pick.per : 1}
            digits={pick.digits}
          />
        );
      })}
    </div>
  );
}
