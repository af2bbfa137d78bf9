// Four plots over one axis of time, with one cursor. History and live are one trace; a gap stays a gap.
import { useEffect, useRef } from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { axisTime, timeStep } from '../draw/axis';
import { onDraw } from '../draw/loop';
import { palette } from '../draw/palette';
import { LAYOUT } from '../layout';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { Panel } from '../design/panel';
import { cutoff, dictionary, namedChannels, store, tick } from '../run/session';
import { outages, shortReason } from '../timeline/model';
import { plotSpan } from '../run/window';
import { align } from './model';
import type { Aligned } from './model';
import './style.css';

const sync = uPlot.sync('aeolis');

interface Properties {
  title: string;
  channel: DictionaryChannel;
  unit: string;
  per: number;
  digits: number;
}

function options(width: number, height: number, channel: DictionaryChannel, per: number): uPlot.Options {
  const colours = palette();
  const axis = { stroke: colours.dim, font: `11px ${colours.mono}`, grid: { stroke: colours.line, width: 1 }, ticks: { show: false } };
  return {
    width, height, legend: { show: false }, pxAlign: 1, padding: [6, 24, 0, 0],
    cursor: { sync: { key: sync.key, setSeries: false }, drag: { x: false, y: false }, points: { show: false }, y: false },
    scales: { x: { time: false } },
    axes: [
      {
        ...axis, size: 22, gap: 3,
        splits: (_plot, _index, from, to) => {
          const step = timeStep(to - from, Math.max(2, Math.floor(width / 90)));
          const all: number[] = [];
          for (let n = Math.ceil(from / step); n * step <= to; ++n) all.push(n * step);
          return all;
        },
        values: (plot, splits) => {
          const { min = 0, max = 1 } = plot.scales['x'] ?? {};
          return splits.map((e_s) => axisTime(e_s, timeStep(max - min, Math.max(2, Math.floor(width / 90)))));
        },
      },
      { ...axis, size: 52, gap: 4, space: 26 },
    ],
    series: [
      {},
      { stroke: colours.recording, width: 1, points: { show: false } },
      { stroke: colours.uhf, width: 1, points: { show: false } },
    ],
    hooks: {
      drawClear: [(plot) => shadeSilence(plot)],
      draw: [(plot) => limitLines(plot, channel, per)],
    },
  };
}

/** Where UHF was silent the plot says so by a shade, instead of a line that was never measured. */
function shadeSilence(plot: uPlot): void {
  const run = store.value;
  if (!run) return;
  const { left, top, width, height } = plot.bbox;
  const now = Math.min(run.seenSclk, cutoff.value) - run.entrySclk;
  plot.ctx.save();
  plot.ctx.fillStyle = palette().caution;
  for (const outage of outages(run, 'uhf_live', now, cutoff.value)) {
    const from = Math.max(left, plot.valToPos(outage.from, 'x', true));
    const to = Math.min(left + width, plot.valToPos(outage.to, 'x', true));
    if (to <= from) continue;
    plot.ctx.globalAlpha = 0.1;
    plot.ctx.fillRect(from, top, to - from, height);
    const words = shortReason(outage.words);
    plot.ctx.font = `${11 * (window.devicePixelRatio || 1)}px ${palette().sans}`;
    if (plot.ctx.measureText(words).width + 8 > to - from) continue;
    plot.ctx.globalAlpha = 1;
    plot.ctx.textAlign = 'center';
    plot.ctx.textBaseline = 'bottom';
    plot.ctx.fillText(words, (from + to) / 2, top + height - 4);
  }
  plot.ctx.restore();
}

function limitLines(plot: uPlot, channel: DictionaryChannel, per: number): void {
  const { left, top, width, height } = plot.bbox;
  const colours = palette();
  for (const limit of channel.limits) {
    for (const bound of [limit.below, limit.above]) {
      if (bound === undefined) continue;
      const y = Math.round(plot.valToPos(bound / per, 'y', true)) + 0.5;
      if (!(y > top && y < top + height)) continue;
      plot.ctx.save();
      plot.ctx.strokeStyle = limit.severity === 'critical' || limit.severity === 'severe' ? colours.alarm : colours.caution;
      plot.ctx.setLineDash([4, 4]);
      plot.ctx.beginPath();
      plot.ctx.moveTo(left, y);
      plot.ctx.lineTo(left + width, y);
      plot.ctx.stroke();
      plot.ctx.restore();
    }
  }
}

function Plot({ title, channel, unit, per, digits }: Properties) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = box.current;
    if (!element) return undefined;
    let plot: uPlot | undefined;
    let shown = '';
    let shape = '';
    const stop = onDraw(() => {
      const width = element.clientWidth;
      const height = element.clientHeight;
      if (width < 60 || height < 40) return;
      const run = store.value;
      const recorded = run?.recorded.get(channel.id);
      const live = run?.live.get(channel.id);
      const span = plotSpan(run);
      const newShape = `${palette().name} ${channel.id}`;
      const key = `${run?.id} ${recorded?.version} ${live?.version} ${span.from.toFixed(1)} ${span.to.toFixed(1)} ${cutoff.value} ${width} ${height} ${newShape}`;
      if (key === shown) return;
      shown = key;
      if (!plot || newShape !== shape) {
        plot?.destroy();
        shape = newShape;
        plot = new uPlot(options(width, height, channel, per), [[], [], []], element);
      } else if (plot.width !== width || plot.height !== height) {
        plot.setSize({ width, height });
      }
      const data = run
        ? align(recorded, live, outages(run, 'uhf_live', span.to, cutoff.value), run.entrySclk, span.from, span.to, cutoff.value, per, width * 2)
        : ([[], [], []] as Aligned);
      element.dataset['newest'] = String(Math.max(recorded?.newestSclk ?? -Infinity, live?.newestSclk ?? -Infinity));
      plot.batch(() => {
        plot?.setData(data as uPlot.AlignedData, false);
        plot?.setScale('x', { min: span.from, max: span.to });
        const [low, high] = bounds(data);
        plot?.setScale('y', { min: low, max: high });
      });
    });
    return () => {
      stop();
      plot?.destroy();
    };
  }, [channel.id, per]);

  void tick.value;
  const now = store.value?.latest(channel.id, cutoff.value)?.value;
  return (
    <Panel name={`plot-${title.toLowerCase()}`} title={title} extra={
      <span class="reading">
        <output data-testid={`reading-${title.toLowerCase()}`}>{now === undefined || Number.isNaN(now) ? '—' : (now / per).toFixed(digits)}</output> {unit}
      </span>
    }>
      {now === undefined && <span class="plot-empty">no {channel.name} has come yet</span>}
      <div class={`plot ${now === undefined ? 'is-empty' : ''}`} ref={box} role="img" aria-label={`${title} in ${unit} over time from entry`} />
    </Panel>
  );
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

/** Named at ?panel=plots&channels=one,two: any of the dictionary, as many as are named. */
const NAMED = namedChannels();
const MOST_NAMED = 16; // ours: more cannot be read

export function Plots() {
  const words = dictionary.value;
  if (!words) return null;
  if (NAMED.length > 0) {
    return (
      <div class="plots plots-named">
        {NAMED.slice(0, MOST_NAMED).map((name) => {
          const channel = words.pick([name]);
          return channel ? <Plot key={name} channel={channel} title={name} unit={channel.unit} per={1} digits={3} /> : <p class="none" key={name}>no channel {name} in the dictionary</p>;
        })}
      </div>
    );
  }
  const taken = new Set<number>();
  return (
    <div class="plots">
      {LAYOUT.plots.map((pick) => {
        const known = words.pick(pick.channel);
        const channel = known ?? words.channels.find((candidate) => candidate.labels.length === 0 && !taken.has(candidate.id));
        if (!channel) return null;
        taken.add(channel.id);
        const scaled = known && (pick.unit === undefined || pick.channel.length > 0);
        return (
          <Plot key={channel.id} channel={channel} title={known ? pick.title : channel.name}
            unit={(scaled && pick.unit) || channel.unit} per={scaled ? pick.per : 1} digits={pick.digits} />
        );
      })}
    </div>
  );
}
