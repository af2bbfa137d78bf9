// SPDX-License-Identifier: Apache-2.0
// The flight path from above: north up, one scale for east and north, around the target and its ellipse.
import { useMemo } from 'preact/hooks';
import { STATUS } from '../design/status';
import type { TargetEllipse } from '../gen/aeolis/v1/prediction_pb';

interface Place {
  east_m: number;
  north_m: number;
}
interface Properties {
  points: readonly (Place & { recorded: boolean })[];
  /** The path that is expected, dashed. */
  predicted?: readonly (Place & { recorded: boolean })[] | undefined;
  /** The newest known place; undefined: not known. */
  now: Place | undefined;
  stale: boolean;
  label: string;
  /** That is to hold 99 % of the landings. */
  ellipse?: TargetEllipse | undefined;
  /** How far the picture reaches at least. */
  least_m?: number;
}

const HALF = 100; // of the drawing's own units
const STEPS = [1, 2, 5];

/** The round length that is nearest to a quarter of the picture. */
export function scaleBar_m(reach_m: number): number {
  const wanted = reach_m / 2;
  const decade = 10 ** Math.floor(Math.log10(Math.max(1e-3, wanted)));
  return (STEPS.findLast((step) => step * decade <= wanted) ?? 1) * decade;
}

const NEAREST_M = 50;
const STEPS_AN_OCTAVE = 4; // chosen: between two of them the map stands still, and the paths on it are as they were

/** How far the picture reaches from the target: all that matters now, in steps, and no nearer than 50 m. */
export function reachOf(now: Place | undefined): number {
  if (!now) return 1000;
  const octaves = Math.log2((Math.hypot(now.east_m, now.north_m) * 1.25) / NEAREST_M);
  return NEAREST_M * 2 ** Math.max(0, Math.ceil(octaves * STEPS_AN_OCTAVE) / STEPS_AN_OCTAVE);
}

export const lengthWords = (m: number): string => (m >= 1000 ? `${m / 1000} km` : `${m} m`);

export const ellipseWords = ({ majorM, minorM }: TargetEllipse): string =>
  `the 99 % ellipse, ${majorM / 1000} × ${minorM / 1000} km`;

/** Runs of points of one source that lie within the picture, and one beyond it to either side. */
function lines(points: Properties['points'], reach: number): { recorded: boolean; d: string }[] {
  const all: { recorded: boolean; d: string }[] = [];
  const limit = reach * 4;
  let before: (Place & { recorded: boolean }) | undefined;
  for (const point of points) {
    const inside = Math.abs(point.east_m) < limit && Math.abs(point.north_m) < limit;
    const at = `${((point.east_m / reach) * HALF).toFixed(1)} ${((-point.north_m / reach) * HALF).toFixed(1)}`;
    const last = all.at(-1);
    if (!inside) before = undefined;
    else {
      if (!before || !last || last.recorded !== point.recorded)
        all.push({
          recorded: point.recorded,
          d: `${last && before ? (/[^ML]+$/.exec(last.d)?.[0] ?? '') && `M${/[^ML]+$/.exec(last.d)?.[0]}L` : 'M'}${at}`,
        });
      else last.d += `L${at}`;
      before = point;
    }
  }
  return all;
}

const NONE: NonNullable<Properties['predicted']> = [];

export function Path({ points, predicted = NONE, now, stale, label, ellipse, least_m = 0 }: Properties) {
  const reach = Math.max(reachOf(now), least_m);
  const foreseen = useMemo(() => lines(predicted, reach), [predicted, reach]);
  const bar = scaleBar_m(reach);
  const x = (m: number) => (m / reach) * HALF;
  const from = now && Math.hypot(now.east_m, now.north_m);
  return (
    <svg
      class="path"
      viewBox={`${-HALF} ${-HALF} ${2 * HALF} ${2 * HALF}`}
      role="img"
      aria-label={`${label}: ${from === undefined ? 'the place is not known' : `${from.toFixed(0)} m from the target`}`}
      data-testid="path"
    >
      <circle r={x(bar)} class="path-ring" />
      <circle r={x(2 * bar)} class="path-ring" />
      <path d="M-6 0H6M0-6V6" class="path-target" />
      {ellipse && (
        <ellipse
          ry={x(ellipse.majorM / 2)}
          rx={x(ellipse.minorM / 2)}
          transform={`rotate(${ellipse.azimuthDeg})`}
          class="path-ellipse"
          data-testid="ellipse"
        />
      )}
      {foreseen.map(({ d }, i) => (
        <path key={i} d={d} class="path-predicted" />
      ))}
      {lines(points, reach).map(({ recorded, d }, i) => (
        <path key={i} d={d} class={recorded ? 'path-recorded' : 'path-live'} />
      ))}
      {now && <circle cx={x(now.east_m)} cy={-x(now.north_m)} r="4" class={stale ? 'path-old' : 'path-now'} />}
      <text class="path-word" x="0" y="16" text-anchor="middle">
        target
      </text>
      <path d={`M${-HALF + 8} ${HALF - 8}h${x(bar)}m0-3v6m${-x(bar)}-6v6`} class="path-bar" />
      <text x={-HALF + 8} y={HALF - 14}>
        {lengthWords(bar)}
      </text>
      <text class="path-word" x={HALF - 8} y={-HALF + 16} text-anchor="end">
        ↑ N
      </text>
      {stale && (
        <text x={-HALF + 8} y={-HALF + 16}>
          {STATUS.stale.shape} {STATUS.stale.word}
        </text>
      )}
    </svg>
  );
}
