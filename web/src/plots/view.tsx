// SPDX-License-Identifier: Apache-2.0
// Plots over one time axis with one cursor. History and live data are one trace; a gap stays a gap.
import { useLayoutEffect, useRef } from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { TYPE } from '../design/type';
import { CHARACTER_PX, axisNumber, decadeTicks, shortLabel, shortStep, ticks, valueTicks } from '../draw/axis';
import { grownBy } from '../draw/canvas';
import { onDraw } from '../draw/loop';
import { palette } from '../draw/palette';
import { LAYOUT } from '../layout';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { Panel } from '../design/panel';
import { PREDICTED, SOURCES, silenceStatus } from '../design/status';
import { staleWords } from '../channels/model';
import { cursor } from '../run/cursor';
import { inWords, numberText, valueText } from '../run/dictionary';
import { isWorst, limitsOver } from '../run/limits';
import { isLost } from '../run/connection';
import { cutoff, dictionary, laidOver, notify, plots, shownRun, tick } from '../run/shown';
import type { Series } from '../run/series';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { whoseAt } from '../run/whose';
import { LIVE_LINKS, liveOutages, shortReason } from '../timeline/model';
import { plotSpan, plotSpanOf } from '../run/window';
import {
  differenceOf,
  hasDifference,
  isPredicted,
  predictedAt,
  predictedSeries,
  predictedVersion,
  prediction,
} from '../prediction/model';
import { predicted } from '../timeline/now';
import { align, difference, gapIn, gapOf, less, readingAt } from './model';
import { drawOver, extremes, overVersions } from './over';
import type { Aligned } from './model';
import type { PredictedLine } from './predicted';
import './style.css';

interface Properties {
  title: string;
  channel: DictionaryChannel;
  unit: string;
  per: number;
  /** Further channels, drawn over it. */
  over?: readonly DictionaryChannel[];
  /** Of the reading; left out: those that fit the value. */
  digits?: number | undefined;
  /** The axis of values is logarithmic above this, in `unit`; left out: linear. */
  linearBelow?: number | undefined;
}

const X_AXIS_PX = 22;
const Y_AXIS_PX = 48;
const RIGHT_PX = 20;
/** The room for labels of time. The plot's own box still has its former size while ticks are chosen. */
const wideOf = (plot: uPlot): number => plot.width - Y_AXIS_PX - RIGHT_PX;

/** What draws a prediction: loaded once there is one, so that the page's first load stays small. */
let drawing: typeof import('./predicted') | undefined;
let isLoading = false;
function loadDrawing(): void {
  if (isLoading || !(isPredicted() || laidOver.value)) return;
  isLoading = true;
  import('./predicted').then(
    (loaded) => {
      drawing = loaded;
      predictedVersion.value += 1;
    },
    () => (isLoading = false), // the next draw asks again
  );
}

/** What is predicted of a channel, as of the instant shown. */
function lineOf(channel: DictionaryChannel, per: number): PredictedLine | undefined {
  loadDrawing();
  const [run, series] = [shownRun(), predictedSeries(channel)];
  if (!run || !series || series.length === 0 || !drawing) return undefined;
  const gap_s = gapOf(channel.expectedRateHz);
  return { channel, series, entry_sclk: run.entrySclk, per, gap_s, now_e_s: nowOf() };
}
/** The instant shown, in seconds from entry. */
function nowOf(): number {
  const run = shownRun();
  return run ? Math.min(run.seenSclk, cutoff.value) - run.entrySclk : Infinity;
}
/** Whether the plot of this channel shows the difference. */
const showsDifference = (channel: DictionaryChannel) => difference.value && hasDifference(channel);

/** Whether the time ahead of now is shown: a difference has nothing there. */
const isAhead = () => isPredicted() && !difference.value;

/** Draws what lies under grid and samples. */
function underlay(plot: uPlot, channel: DictionaryChannel, per: number): void {
  silenceWords.delete(plot);
  shadeSilence(plot);
  limitNames.delete(plot);
  if (!lineOf(channel, per) || !showsDifference(channel)) alarmBands(plot, channel, per);
}
/** Draws what is predicted, over the grid and under the samples; names of limits are over both. */
function drawPredicted(plot: uPlot, channel: DictionaryChannel, per: number): void {
  const line = lineOf(channel, per);
  const names = limitNames.get(plot) ?? [];
  const taken = [...names, ...(silenceWords.get(plot) ?? [])];
  if (isAhead()) drawing?.drawAhead(plot, nowOf(), taken);
  if (line) drawing?.drawPredictedLine(plot, line, showsDifference(channel), taken);
  if (!showsDifference(channel)) drawing?.drawOther(plot, channel, per);
  const { ctx } = plot;
  const ratio = window.devicePixelRatio || 1;
  ctx.save();
  ctx.font = `${TYPE.mark * ratio}px ${palette().sans}`;
  ctx.textAlign = 'left';
  ctx.textBaseline = 'alphabetic';
  for (const { words, from, to, y, colour } of names) {
    ctx.fillStyle = palette().panel; // against the lines behind it
    ctx.fillRect(from - ratio, y - 9 * ratio, to - from + 2 * ratio, 11 * ratio);
    ctx.fillStyle = colour;
    ctx.fillText(words, from, y);
  }
  ctx.restore();
}

function options(
  width: number,
  height: number,
  { channel, per, over }: Properties,
  linear_below: number | undefined,
): uPlot.Options {
  const colours = palette();
  const label = shortLabel(shownRun()?.entryKnown !== false);
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
    scales: { x: { time: false }, ...(linear_below !== undefined && { y: { distr: 4, asinh: linear_below } }) },
    axes: [
      {
        ...axis,
        size: X_AXIS_PX,
        gap: 3,
        splits: (plot, _index, from, to) => ticks(from, to, shortStep(from, to, wideOf(plot), label)),
        values: (plot, splits) => {
          const { min = 0, max = 1 } = plot.scales.x ?? {};
          const step = shortStep(min, max, wideOf(plot), label);
          return splits.map((e_s) => label(e_s, step));
        },
      },
      {
        ...axis,
        // as wide as its longest number: those of a large constant are whole too
        size: (_plot, words) => Math.max(Y_AXIS_PX, ...(words ?? []).map((each) => each.length * CHARACTER_PX + 10)),
        gap: 4,
        splits: (plot, _index, low, high) =>
          linear_below === undefined
            ? valueTicks(low, high, plot.height - X_AXIS_PX)
            : decadeTicks(low, high, plot.height - X_AXIS_PX, linear_below),
        filter: (_plot, splits) => splits, // of a logarithmic axis, too: they have their distance already
        values: (_plot, splits) => splits.map(axisNumber),
      },
    ],
    series: [
      {},
      { stroke: colours.recording, width: 1, points: { show: false } },
      { stroke: colours.uhf, width: 1, points: { show: false } },
    ],
    hooks: {
      drawClear: [(plot) => underlay(plot, channel, per)],
      drawAxes: [(plot) => drawPredicted(plot, channel, per)],
      draw: [(plot) => drawOver(plot, showsDifference(channel) ? [] : (over ?? []), channel.unit, per)],
    },
  };
}

/** The words of silences in a plot: the place of each, as drawn last. */
const silenceWords = new WeakMap<uPlot, { from: number; to: number; y: number }[]>();

/** Shades the times without live telemetry, instead of drawing a line that was never measured. */
function shadeSilence(plot: uPlot): void {
  const run = shownRun();
  if (!run) return;
  const { left, top, width, height } = plot.bbox;
  const now = Math.min(run.seenSclk, cutoff.value) - run.entrySclk;
  const places: { from: number; to: number; y: number }[] = [];
  silenceWords.set(plot, places);
  plot.ctx.save();
  for (const outage of liveOutages(run, now, cutoff.value)) {
    const from = Math.max(left, plot.valToPos(outage.from, 'x', true));
    const to = Math.min(left + width, plot.valToPos(outage.to, 'x', true));
    if (to <= from) continue;
    const { shape, token } = silenceStatus(outage);
    plot.ctx.fillStyle = palette()[token];
    plot.ctx.globalAlpha = 0.1;
    plot.ctx.fillRect(from, top, to - from, height);
    const words = `${shape} ${shortReason(outage.words)}`;
    plot.ctx.font = `${TYPE.mark * (window.devicePixelRatio || 1)}px ${palette().sans}`;
    const wide = plot.ctx.measureText(words).width;
    if (wide + 8 > to - from) continue;
    places.push({ from: (from + to - wide) / 2, to: (from + to + wide) / 2, y: top + height - 4 });
    plot.ctx.globalAlpha = 1;
    plot.ctx.textAlign = 'center';
    plot.ctx.textBaseline = 'bottom';
    plot.ctx.fillText(words, (from + to) / 2, top + height - 4);
  }
  plot.ctx.restore();
}

/** The limits' names in a plot, each with its place, as found last. */
interface LimitName {
  words: string;
  from: number;
  to: number;
  y: number;
  colour: string;
}
const limitNames = new WeakMap<uPlot, LimitName[]>();

/**
 * Shades the area outside each limit while the limit was in force, and finds a place for its name. The worst limit is
 * named first, so that it has its name where room is short.
 */
function alarmBands(plot: uPlot, channel: DictionaryChannel, per: number): void {
  const run = shownRun();
  const { min: from, max: to } = plot.scales.x ?? {};
  if (!run || from === undefined || to === undefined) return;
  const { left, top, width, height } = plot.bbox;
  const [right, bottom] = [left + width, top + height];
  const colours = palette();
  const ratio = window.devicePixelRatio || 1;
  const { ctx } = plot;
  const named: { words: string; x: number; y: [number, number]; room: number; colour: string }[] = [];
  const drawn: { from: number; to: number; y: number }[] = []; // the limits' lines
  ctx.save();
  for (const stretch of limitsOver(
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
        const name = `${limit.severity} ${above ? '>' : '<'} ${+(bound / per).toPrecision(4)}${stretch.context ? `, ${inWords(stretch.context)}` : ''}`;
        drawn.push({ from: x1, to: x2, y: edge });
        const [over, under] = [edge - 3 * ratio, edge + 11 * ratio];
        named.unshift({ words: name, x: x1, room: x2 - x1, y: above ? [over, under] : [under, over], colour });
      }
    }
  }
  ctx.font = `${TYPE.mark * ratio}px ${colours.sans}`;
  const names: LimitName[] = [];
  limitNames.set(plot, names);
  for (const { words: whole, x, y, room, colour } of named.sort(
    (one, other) => Number(other.colour === colours.alarm) - Number(one.colour === colours.alarm),
  )) {
    const words = ctx.measureText(whole).width < room - 6 * ratio ? whole : (whole.split(',')[0] as string);
    const wide = ctx.measureText(words).width;
    const at = Math.max(left + 2, Math.min(right - wide - 2, x + 3));
    const within = ({ from, to }: { from: number; to: number }) => at < to && at + wide > from;
    // Beside its line, on no other line and no other name; else it has none here.
    const free = y.find(
      (each) =>
        each - 9 * ratio >= top &&
        each <= bottom &&
        !names.some((name) => within(name) && Math.abs(each - name.y) < 10 * ratio) &&
        !drawn.some((line) => within(line) && line.y > each - 10 * ratio && line.y < each + 2 * ratio),
    );
    if (free !== undefined) names.push({ words, from: at, to: at + wide, y: free, colour });
  }
  ctx.restore();
}

export function toggleDifference(): void {
  if (isPredicted()) difference.value = !difference.value;
  else
    notify(
      prediction.value?.state === 'none'
        ? `nothing is predicted of this run: ${prediction.value.reason}`
        : 'the prediction is being made: it is there in a few seconds',
    );
}

/** "altitude_m" is "altitude": the unit stands beside it. */
const wordsOf = (name: string) => inWords(name).replace(/ (m|km|mps|mps2|g|deg|dps|s|n|kg|pa)$/, '');

function Plot(properties: Properties) {
  const { title, channel, unit, per, digits, over = [], linearBelow } = properties;
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
      const span = plotSpanOf(run, channel.id, isAhead());
      const isDifference = showsDifference(channel);
      const line = lineOf(channel, per);
      const linear_below = isDifference ? undefined : linearBelow;
      const ids = [channel, ...over].map(({ id }) => id).join();
      const newShape = `${palette().name} ${run?.entryKnown} ${ids} ${linear_below}`;
      const changes = LIVE_LINKS.map((link) => run?.links.get(link) ?? []);
      const silences = changes.reduce((all, each) => all + each.length, 0);
      // a present silence grows with the clock, without new samples
      const silent = changes.every((each) => each.at(-1)?.fact.up !== true) ? run?.seenSclk.toFixed(0) : '';
      const limits = limitsOver(channel, -Infinity, Infinity).map(({ from_sclk }) => from_sclk);
      const times = [span.from, span.to, line?.now_e_s].map((each) => each?.toFixed(1));
      const versions = [
        recorded?.version,
        live?.version,
        overVersions(run, over),
        predictedVersion.value,
        laidOver.value,
      ];
      const looks = [cutoff.value, width, height, newShape, isPredicted(), isDifference, predicted.value.length];
      const key = [run?.id, silences, silent, ...versions, ...times, ...looks, limits].join(' ');
      if (key === shown && traces[0] === recorded && traces[1] === live)
        return cursor.peek() === placed ? undefined : placeCursor;
      shown = key;
      traces = [recorded, live];
      return () => {
        if (!plot || newShape !== shape) {
          plot?.destroy();
          shape = newShape;
          plot = drawn.current = new uPlot(options(width, height, properties, linear_below), [[], [], []], element);
        } else if (plot.width !== width || plot.height !== height) {
          plot.setSize({ width, height });
        }
        const observed = run
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
              gapIn(run, channel),
            )
          : ([[], [], []] as Aligned);
        const data =
          isDifference && line && run ? less(observed, channel, line.series, run.entrySclk, per, line.gap_s) : observed;
        element.dataset.holes = String(holesOf(data));
        element.dataset.predicted = String((line && drawing?.samplesAhead(line, span.to)) ?? 0);
        element.dataset.over = String(drawing?.samplesOfOther(channel, span.from, span.to) ?? 0);
        element.dataset.newest = String(Math.max(recorded?.newestSclk ?? -Infinity, live?.newestSclk ?? -Infinity));
        plot.batch(() => {
          plot?.setData(data as uPlot.AlignedData, false);
          plot?.setScale('x', { min: span.from, max: span.to });
          const [low, high] = bounds(
            data,
            isDifference
              ? [0, 0]
              : [
                  ...((line && drawing?.predictedBounds(line, span.from, span.to)) ?? []),
                  ...(drawing?.boundsOfOther(channel, per, span.from, span.to) ?? []),
                  ...(run ? extremes(run, over, channel.unit, span).map((each) => each / per) : []),
                ],
            linear_below,
          );
          plot?.setScale('y', { min: low, max: high });
        });
        placeCursor();
      };
    });
    return () => {
      stop();
      plot?.destroy();
    };
  }, [channel.id, per, over.length, linearBelow]);

  void tick.value;
  const run = shownRun();
  const at = cursor.value;
  const newest = run?.latest(channel.id, cutoff.value);
  const now = newest?.value;
  const shown =
    at === undefined || !run ? undefined : readingAt(run, channel.id, at, cutoff.value, gapIn(run, channel));
  const value = at === undefined ? now : shown?.value;
  const sources = [run?.live.has(channel.id) && SOURCES.uhf, run?.recorded.has(channel.id) && SOURCES.recording].filter(
    (each) => each !== false && each !== undefined,
  );
  const whose = run && whoseAt(run, channel.name, at === undefined ? (newest?.sclk ?? -Infinity) : run.entrySclk + at);
  const line = lineOf(channel, per);
  const sample_sclk = run && (at === undefined ? newest?.sclk : run.entrySclk + at);
  const expected =
    line && sample_sclk !== undefined ? predictedAt(channel, line.series, sample_sclk, line.gap_s) : undefined;
  const off =
    value === undefined || Number.isNaN(value) || expected === undefined || !hasDifference(channel)
      ? undefined
      : differenceOf(channel, value, expected);
  const inDifference = line !== undefined && showsDifference(channel);
  // Of the hollow dot, which stands at now whatever has been heard.
  const foreseen =
    line && run && at === undefined && !inDifference
      ? predictedAt(channel, line.series, run.entrySclk + line.now_e_s, line.gap_s)
      : undefined;
  const textOf = (of: number | undefined) =>
    of === undefined || Number.isNaN(of)
      ? '—'
      : hasDifference(channel)
        ? reading(of / per, digits)
        : valueText(channel, of, at === undefined ? newest?.text : undefined);
  const stale = at === undefined ? staleWords(run, channel, cutoff.value, isLost.value) : undefined;
  const name = title.toLowerCase();
  return (
    <Panel
      name={`plot-${name}`}
      head={`channel ${channel.name}`}
      title={[title, ...over.map((each) => each.name)].join(', ')}
      extra={
        <span class={`reading ${at !== undefined ? 'at-cursor' : whose ? 'other' : stale ? 'stale' : ''}`}>
          {stale && <span data-testid={`stale-${name}`}>{stale} </span>}
          {now === undefined && line && at === undefined && <span class="cursor-time none-yet">none yet</span>}
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
          <output data-testid={`reading-${name}`} class={now === undefined ? 'unseen' : ''}>
            {inDifference ? signed(off, per, digits) : textOfValue(value, per, digits)}
          </output>{' '}
          {now !== undefined && unit}
          {hasDifference(channel) && (line || prediction.value?.state !== 'none') && (
            <button
              type="button"
              class={`quiet plot-difference ${line ? '' : 'is-due'}`}
              aria-pressed={inDifference}
              title={`key j: observed less predicted, by ${prediction.value?.basis ?? ''}`}
              aria-label={`${title}: observed less predicted`}
              onClick={toggleDifference}
            >
              {PREDICTED.shape}
              {foreseen !== undefined && '○'}
              <i>
                {' '}
                {inDifference ? 'less predicted' : PREDICTED.word}
                {foreseen !== undefined && <b> {textOfValue(foreseen, per, digits)}</b>}
              </i>
            </button>
          )}
        </span>
      }
    >
      {now === undefined && !line && <span class="plot-empty">nothing of {wordsOf(channel.name)} has come yet</span>}
      <div
        class={`plot ${now === undefined && !line ? 'is-empty' : ''}`}
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
        <i class="plot-cursor" ref={mark} hidden>
          {at !== undefined && line && expected !== undefined && (
            <dl class={`plot-tip ${isRight(at, run) ? 'at-left' : ''}`} data-testid={`tip-${name}`}>
              {shown && (
                <>
                  <dt>observed</dt>
                  <dd>{textOf(shown.value)}</dd>
                </>
              )}
              <dt>predicted</dt>
              <dd>{textOf(expected)}</dd>
              {off !== undefined && (
                <>
                  <dt>difference</dt>
                  <dd>{signed(off, per, digits)}</dd>
                </>
              )}
            </dl>
          )}
        </i>
      </div>
    </Panel>
  );
}

/** Whether an instant lies in the right half of the plots, where a box beside it stands to its left. */
function isRight(at: number, run: RunStore | undefined): boolean {
  const { from, to } = plotSpan(run, isAhead());
  return at > (from + to) / 2;
}

const textOfValue = (value: number | undefined, per: number, digits: number | undefined): string =>
  value === undefined || Number.isNaN(value) ? '—' : reading(value / per, digits);
const signed = (off: number | undefined, per: number, digits: number | undefined): string =>
  off === undefined ? '—' : `${off > 0 ? '+' : ''}${textOfValue(off, per, digits)}`;

/** Formats a value, without a minus sign on zero. */
const reading = (value: number, digits: number | undefined): string =>
  (digits === undefined ? numberText(value) : value.toFixed(digits)).replace(/^-(?=0(\.0*)?$)/, '');

/** The number of instants at which neither trace continues, for observers that cannot see a canvas. */
function holesOf([x, silent, lit]: Aligned): number {
  let holes = 0;
  for (let i = 0; i < x.length; ++i) if (silent[i] === null && lit[i] === null) ++holes;
  return holes;
}

/** The range of the axis: all data, and what else must be in sight, with a margin of the axis's length. */
function bounds(
  data: readonly (readonly (number | null | undefined)[])[],
  also: readonly number[],
  linear_below: number | undefined,
): [number, number] {
  let low = Math.min(Infinity, ...also);
  let high = Math.max(-Infinity, ...also);
  for (const values of data.slice(1)) {
    for (const value of values) {
      if (value === null || value === undefined) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return [0, 1];
  const onAxis = (value: number) => (linear_below === undefined ? value : Math.asinh(value / linear_below));
  const valueAt = (at: number) => (linear_below === undefined ? at : Math.sinh(at) * linear_below);
  const length = onAxis(high) - onAxis(low);
  const margin = length > 0 ? length * 0.06 : linear_below === undefined ? Math.max(1, Math.abs(high) * 0.1) : 0.1;
  return [valueAt(onAxis(low) - margin), valueAt(onAxis(high) + margin)];
}

export function Plots() {
  const words = dictionary.value;
  if (!words) return null;
  if (plots.value) {
    return (
      <div class="plots plots-named" data-panel="plots" tabIndex={0} role="region" aria-label="plots">
        {plots.value.map((names) => {
          const [channel, ...over] = names.flatMap((name) => words.pick([name]) ?? []);
          if (!channel) return null;
          const pick = LAYOUT.plots.find((each) => (each.channel as readonly string[]).includes(channel.name));
          return (
            <Plot
              key={names.join()}
              channel={channel}
              over={over}
              title={pick?.title ?? channel.name}
              unit={pick?.unit ?? channel.unit}
              per={pick?.per ?? 1}
              digits={pick?.digits}
              linearBelow={pick?.linearBelow}
            />
          );
        })}
      </div>
    );
  }
  const taken = new Set<number>();
  return (
    <div class="plots" data-panel="plots">
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
            linearBelow={known && pick.linearBelow}
          />
        );
      })}
    </div>
  );
}
