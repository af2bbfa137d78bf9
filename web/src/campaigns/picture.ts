// SPDX-License-Identifier: Apache-2.0
// Touchdown points about the target and the ellipse that holds 99 % of them, with one scale for east and north.
import { ticks, valueStep } from '../draw/axis';
import type { Surface } from '../draw/canvas';
import { openedCase, reach_km, report, touchdowns } from './model';

const EDGE = 10;
const LOW_PX = 170; // chosen: below this height the axes have no words

/** Where the picture last drew, so that a click finds its case. */
let drawn: { x: (east_km: number) => number; y: (north_km: number) => number } | undefined;
const NEAR_PX = 14; // chosen: as far from a dot as a finger is sure of

/** The case whose dot is nearest to a place in the picture. */
export function caseAt(px: number, py: number): number | undefined {
  let [nearest, apart_px]: [number | undefined, number] = [undefined, NEAR_PX];
  for (const { case: number, east_m, north_m } of touchdowns.value) {
    if (!drawn || east_m === undefined || north_m === undefined) continue;
    const away = Math.hypot(drawn.x(east_m / 1000) - px, drawn.y(north_m / 1000) - py);
    if (away <= apart_px) [nearest, apart_px] = [number, away];
  }
  return nearest;
}

export function drawTouchdowns({ context: c, width, height, colours }: Surface): void {
  const points = touchdowns.value;
  const ellipse = report.value?.ellipse;
  const reach = reach_km(points, ellipse);
  const low = height < LOW_PX;
  // larger where the picture is, for reading from a distance
  const type_px = Math.round(Math.min(17, Math.max(11, height / 32)));
  c.font = `${type_px}px ${colours.sans}`;
  const [left_px, bottom_px] = [type_px * 4, type_px * (low ? 1.7 : 3.1)];
  const [wide, high] = [width - left_px - EDGE, height - bottom_px - EDGE];
  if (wide < 40 || high < 40) return;
  const km_px = Math.min(wide / (2 * reach.east), high / (2 * reach.north));
  const [x0, y0] = [left_px + wide / 2, EDGE + high / 2];
  const x = (east_km: number) => x0 + east_km * km_px;
  const y = (north_km: number) => y0 - north_km * km_px;
  drawn = { x, y };
  const [bottom, right] = [EDGE + high, left_px + wide];

  // The grid: the same step in both directions, so that its cells are square.
  const [half_east, half_north] = [wide / 2 / km_px, high / 2 / km_px];
  const step = valueStep((low ? 28 : type_px * 3.6) / km_px, 1);
  c.strokeStyle = colours.line;
  c.fillStyle = colours.dim;
  c.lineWidth = 1;
  c.textBaseline = 'top';
  c.textAlign = 'center';
  const words = (value: number) => String(Math.round(value * 10) / 10).replace('-', '−');
  for (const east of ticks(-half_east, half_east, step)) {
    line(c, x(east), EDGE, x(east), bottom);
    c.fillText(words(east), x(east), bottom + 4);
  }
  c.textAlign = 'right';
  c.textBaseline = 'middle';
  for (const north of ticks(-half_north, half_north, step)) {
    line(c, left_px, y(north), right, y(north));
    c.fillText(words(north), left_px - 5, y(north));
  }
  c.textAlign = 'center';
  if (!low) {
    c.textBaseline = 'bottom';
    c.fillText('km east of the target', x0, height - 2);
    c.save();
    c.translate(type_px, y0);
    c.rotate(-Math.PI / 2);
    c.textBaseline = 'middle';
    c.fillText('km north of it', 0, 0);
    c.restore();
  }

  // Cases: a dot for each touchdown, a cross of another colour for each failure.
  c.fillStyle = colours.rehearsal;
  c.globalAlpha = points.length > 2000 ? 0.45 : 0.75;
  const radius = points.length > 2000 ? 1.5 : type_px * 0.23;
  for (const point of points) {
    if (point.outcome !== 'touchdown' || point.east_m === undefined || point.north_m === undefined) continue;
    c.beginPath();
    c.arc(x(point.east_m / 1000), y(point.north_m / 1000), radius, 0, 7);
    c.fill();
  }
  c.globalAlpha = 1;
  c.strokeStyle = colours.alarm;
  c.lineWidth = 2;
  for (const point of points) {
    if (point.outcome === 'touchdown' || point.east_m === undefined || point.north_m === undefined) continue;
    const [px, py] = [x(point.east_m / 1000), y(point.north_m / 1000)];
    line(c, px - 5, py - 5, px + 5, py + 5);
    line(c, px - 5, py + 5, px + 5, py - 5);
  }

  const opened = points.find((point) => point.case === openedCase.value);
  if (opened?.east_m !== undefined && opened.north_m !== undefined) {
    c.strokeStyle = colours.accent;
    c.beginPath();
    c.arc(x(opened.east_m / 1000), y(opened.north_m / 1000), radius + 5, 0, 7);
    c.stroke();
  }

  if (ellipse) {
    c.strokeStyle = colours.text;
    c.lineWidth = 1.5;
    c.beginPath();
    c.ellipse(
      x(ellipse.east_m / 1000),
      y(ellipse.north_m / 1000),
      (ellipse.major_m / 2000) * km_px,
      (ellipse.minor_m / 2000) * km_px,
      ((ellipse.azimuth_deg - 90) * Math.PI) / 180,
      0,
      7,
    );
    c.stroke();
  }

  c.strokeStyle = colours.accent;
  c.fillStyle = colours.accent;
  c.lineWidth = 2;
  line(c, x0 - 9, y0, x0 + 9, y0);
  line(c, x0, y0 - 9, x0, y0 + 9);
  c.textAlign = 'left';
  c.textBaseline = 'bottom';
  label(c, 'target', x0 + 8, y0 - 4, colours.panel);

  // A scale bar of a round length.
  const bar_km = valueStep((wide / km_px) * 0.25, 1.01);
  const [bx, by] = [left_px + 12, bottom - 12];
  c.strokeStyle = colours.text;
  c.fillStyle = colours.text;
  line(c, bx, by, bx + bar_km * km_px, by);
  line(c, bx, by - 4, bx, by + 4);
  line(c, bx + bar_km * km_px, by - 4, bx + bar_km * km_px, by + 4);
  label(c, `${words(bar_km)} km`, bx, by - 5, colours.panel);
}

/** Draws words with a background, so that dots do not run through them. */
function label(c: CanvasRenderingContext2D, words: string, px: number, py: number, back: string): void {
  c.save();
  c.strokeStyle = back;
  c.lineWidth = 4;
  c.lineJoin = 'round';
  c.strokeText(words, px, py);
  c.restore();
  c.fillText(words, px, py);
}

function line(c: CanvasRenderingContext2D, x1: number, y1: number, x2: number, y2: number): void {
  c.beginPath();
  c.moveTo(x1, y1);
  c.lineTo(x2, y2);
  c.stroke();
}
