// SPDX-License-Identifier: Apache-2.0
// The flat picture, from the side, across the approach: where there is no WebGL, or on request. It shows the same
// scene by the same measures.
import { TYPE } from '../design/type';
import type { Surface } from '../draw/canvas';
import {
  AEROSHELL,
  BACKSHELL_PROFILE,
  CRUISE_STAGE,
  PARACHUTE,
  RAISED,
  ROVER,
  STAGE,
  VIEWS,
  heatshieldProfile,
  wheelsBelow_m,
} from './geometry';
import type { Presence, Scene } from './model';
import { rotated, unit } from './vectors';
import type { Vector } from './vectors';

const GROUND = {
  dark: ['#5f3e30', '#0d131c', '#6b5243', '#4d3228'],
  light: ['#c79f84', '#dfe7f0', '#ecdccb', '#b1886e'],
} as const; // ground far off, space, haze, ground below the vehicle
const AIR_M = 18000; // as in the other picture: how much of the air is still above

/** The vehicle before sky and ground, with its vectors. */
export function drawFlat(surface: Surface, scene: Scene): void {
  const { context: c, width, height, colours } = surface;
  const { motion } = scene;
  const { px, at, flat } = stand(surface, scene, 0.5);
  const wheels_m = wheelsBelow_m(scene.bridle_m ?? 0);
  const known = motion.attitude !== undefined;
  drawBackground(c, width, height, colours.name === 'light', known ? motion.altitude_m : undefined, () => {
    const altitude = Math.max(motion.altitude_m ?? Infinity, scene.bridle_m ? wheels_m : 0);
    return altitude * px < height * 3 ? at[1] + altitude * px : undefined;
  });
  drawBody(surface, scene, 0.5, !known);
  const view = VIEWS[scene.scenery];
  const reach = view.tall * view.arrow * px;
  arrow(
    c,
    at,
    motion.velocity && known ? flat(unit(motion.velocity)) : undefined,
    reach,
    colours.accent,
    'velocity',
    colours.sans,
  );
  arrow(
    c,
    at,
    motion.lift && known && scene.scenery === 'entry' ? flat(motion.lift) : undefined,
    reach,
    colours.text,
    'lift',
    colours.sans,
  );
}

/** The same vehicle hollow, over another picture: as it is predicted. `part`: how far from the left. */
export const drawOutline = (surface: Surface, scene: Scene, part: number): void => drawBody(surface, scene, part, true);

/** Where the vehicle stands in the picture, and how it is turned. */
function stand({ width, height }: Surface, { motion, scenery, heading }: Scene, part: number) {
  const view = VIEWS[scenery];
  const px = Math.min(height, width * 1.15) / view.tall;
  const ahead: Vector = [Math.sin(heading), 0, -Math.cos(heading)];
  const flat = (v: Vector): [number, number] => [v[0] * ahead[0] + v[2] * ahead[2], -v[1]];
  const down: [number, number] = motion.attitude ? flat(rotated(motion.attitude, [0, 0, 1])) : [0, 1];
  const turn = Math.atan2(down[1], down[0]);
  const at: [number, number] = [
    width * part - Math.cos(turn) * view.below * px,
    height * (0.5 - RAISED) - Math.sin(turn) * view.below * px,
  ];
  return { px, flat, turn, at };
}

function drawBody(surface: Surface, scene: Scene, part: number, isHollow: boolean): void {
  const { context: c, colours } = surface;
  const { parts } = scene;
  const {
    px,
    turn,
    at: [x0, y0],
  } = stand(surface, scene, part);
  c.save();
  c.translate(x0, y0);
  c.rotate(turn - Math.PI / 2);
  c.lineWidth = 1.2;
  const shape = (points: readonly (readonly [number, number])[], presence: Presence, fill: string) => {
    if (presence === 'gone') return;
    c.beginPath();
    for (const [r, z] of points) c.lineTo(r * px, z * px); // the first one moves there
    c.closePath();
    const hollow = presence === 'unknown' || isHollow;
    c.setLineDash(hollow ? [4, 4] : []);
    c.strokeStyle = hollow ? colours.dim : colours.edge;
    c.fillStyle = fill;
    if (!hollow) c.fill();
    c.stroke();
    c.setLineDash([]);
  };
  const both = (profile: readonly (readonly [number, number])[]) => [
    ...profile,
    ...profile.map(([r, z]) => [-r, z] as const).reverse(),
  ];
  const box = (r: number, z1: number, z2: number, at = 0) =>
    [
      [at - r, z1],
      [at + r, z1],
      [at + r, z2],
      [at - r, z2],
    ] as const;

  const skirt = -1.6 - PARACHUTE.lines;
  const { radius, band, gap, dome } = PARACHUTE;
  if (parts.parachute !== 'gone') {
    c.strokeStyle = colours.dim;
    c.beginPath();
    for (let i = -4; i <= 4; ++i) {
      c.moveTo(0, -5 * px);
      c.lineTo((i / 4) * radius * px, skirt * px);
    }
    c.moveTo(0, -5 * px);
    c.lineTo(0, -1.5 * px);
    c.globalAlpha = 0.6;
    c.stroke();
    c.globalAlpha = 1;
    shape(box(radius, skirt, skirt - band), parts.parachute, '#e6e3de');
    const top = skirt - band - gap;
    const arc = Array.from({ length: 17 }, (_, i) => {
      const part = (i - 8) / 8;
      return [part * radius, top - dome * (1 - part * part)] as const;
    });
    shape(arc, parts.parachute, '#e6e3de');
  }
  const { radius: stage_m, z: cruise_z, height: tall } = CRUISE_STAGE;
  shape(box(stage_m, cruise_z - tall / 2, cruise_z + tall / 2), parts.cruiseStage, '#3b5375');
  const open = parts.backshell === 'gone' || parts.heatshield === 'gone';
  if (open) {
    const rover_z = ROVER.stowed_z + (scene.bridle_m ?? 0);
    const rover: Presence = scene.bridle_m === undefined ? 'gone' : parts.rover;
    if ((scene.bridle_m ?? 0) > 0.05 && rover !== 'gone') {
      c.strokeStyle = colours.text;
      c.beginPath();
      for (const side of [-1, 0, 1]) {
        c.moveTo(side * 0.3 * px, STAGE.z * px);
        c.lineTo(side * 0.6 * px, (rover_z - 0.4) * px);
      }
      c.stroke();
    }
    shape(box(0.85, rover_z - 0.4, rover_z + 0.1), rover, '#d9d6d0');
    for (const at of [-1, 0, 1])
      shape(box(0.22, rover_z + 0.17, rover_z + ROVER.height / 2, at * 0.85), rover, '#4a525c');
    shape(box(STAGE.radius, STAGE.z - 0.25, STAGE.z + 0.2), parts.descentStage, '#9aa3ad');
    scene.throttles?.forEach((throttle, i) => {
      if (throttle <= 0.02) return;
      const at = [-1.5, -1.3, 1.3, 1.5][Math.floor(i / 2)] ?? 0;
      const long = 0.6 + 4.2 * throttle;
      c.globalAlpha = 0.5;
      shape(
        [
          [at - 0.12, STAGE.z + 0.3],
          [at + 0.12, STAGE.z + 0.3],
          [at, STAGE.z + 0.3 + long],
        ],
        'there',
        colours.accent,
      );
      c.globalAlpha = 1;
    });
  }
  shape(both(BACKSHELL_PROFILE), parts.backshell, '#b9b3a6');
  shape(both(heatshieldProfile()), parts.heatshield, '#74675b');
  for (const [i, mass] of parts.entryMasses.entries())
    shape(box(0.12, -0.2 + 0.3 * i, 0.3 * i, AEROSHELL.radius - 0.2), mass, '#5d6a78');
  for (const [i, mass] of parts.cruiseMasses.entries())
    shape(box(0.12, -0.2 + 0.3 * i, 0.3 * i, 0.2 - AEROSHELL.radius), mass, '#5d6a78');
  c.restore();
}

function drawBackground(
  c: CanvasRenderingContext2D,
  width: number,
  height: number,
  light: boolean,
  altitude_m: number | undefined,
  groundAt: () => number | undefined,
): void {
  const [soil, space, haze, near] = GROUND[light ? 'light' : 'dark'];
  c.fillStyle = space;
  c.fillRect(0, 0, width, height);
  if (altitude_m === undefined) return;
  const thick = Math.exp(-altitude_m / AIR_M);
  const horizon = height * (0.6 + 0.25 * (1 - thick));
  const ground = groundAt();
  const sky = c.createLinearGradient(0, horizon - height * (0.15 + 0.85 * thick), 0, horizon);
  sky.addColorStop(0, space);
  sky.addColorStop(1, haze);
  c.fillStyle = sky;
  c.fillRect(0, 0, width, horizon);
  c.fillStyle = soil;
  c.fillRect(0, horizon, width, height - horizon);
  if (ground === undefined || ground >= height) return;
  c.fillStyle = near;
  c.fillRect(0, ground, width, height - ground);
}

/** `way`: a unit vector as seen in the picture, short where it points towards the viewer or away. */
function arrow(
  c: CanvasRenderingContext2D,
  [x, y]: [number, number],
  way: [number, number] | undefined,
  reach: number,
  colour: string,
  words: string,
  font: string,
): void {
  const size = way && Math.hypot(...way);
  if (!way || !size) return;
  const [dx, dy] = [way[0] / size, way[1] / size];
  const [tx, ty] = [x + way[0] * reach, y + way[1] * reach];
  c.strokeStyle = c.fillStyle = colour;
  c.lineWidth = 2;
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(tx, ty);
  c.stroke();
  c.beginPath();
  c.moveTo(tx + dx * 10, ty + dy * 10);
  c.lineTo(tx - dy * 5, ty + dx * 5);
  c.lineTo(tx + dy * 5, ty - dx * 5);
  c.fill();
  c.font = `600 ${TYPE.body}px ${font}`;
  c.textAlign = dx < -0.2 ? 'right' : 'left';
  c.textBaseline = 'middle';
  c.fillText(words, tx + dx * 16 + (dx < -0.2 ? -4 : 4), ty + dy * 16);
}
