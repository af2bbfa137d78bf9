// SPDX-License-Identifier: Apache-2.0
// Measures of the vehicle in metres, in B: z towards the heatshield, down in powered descent. Both pictures use them.
// From [facts] are the aeroshell's diameter and cone, the parachute, the bridle and the number of engines;
// the engines' places are those of flight's own mounts. The rest is our drawing, marked "drawn".

import type { Scenery } from './model';

export const AEROSHELL = {
  radius: 2.25, // [facts] 4.5 m across
  cone_deg: 70, // [facts] 70° sphere-cone
  nose_z: 1.5, // drawn
  nose_radius: 1.125, // drawn: half of the radius, as on sphere-cones of its family
  shoulder_z: 0.78, // drawn
  backshell_z: -1.5, // drawn
} as const;

export const CRUISE_STAGE = { radius: 2.1, z: -1.75, height: 0.5 } as const; // drawn

export const PARACHUTE = {
  lines: 50, // [facts] lines of more than 50 m
  radius: 7.5, // drawn: a disk-gap-band of 21.35 m nominal diameter [facts] opens to about 0.7 of it
  dome: 3.4, // drawn
  gap: 0.9, // drawn
  band: 2.5, // drawn
} as const;

export const STAGE = { radius: 1.5, z: -0.35 } as const; // radius: of the engines' mounts
export const ROVER = { height: 1.35, stowed_z: 0.85 } as const; // drawn: its middle, inside the aeroshell

/** Azimuths of the eight engines about z, two at each diagonal. */
export const ENGINE_AZIMUTHS: readonly number[] = [45, 45, 135, 135, 225, 225, 315, 315].map(
  (deg, i) => ((deg + (i % 2 === 0 ? -9 : 9)) * Math.PI) / 180, // drawn apart, to be told one from the other
);

/** The profile of the heatshield from the nose to the shoulder: radius and z. */
export function heatshieldProfile(): [number, number][] {
  const { radius, cone_deg, nose_radius, nose_z } = AEROSHELL;
  const lean = ((90 - cone_deg) * Math.PI) / 180; // where the sphere meets the cone
  const points: [number, number][] = [];
  for (let i = 0; i <= 8; ++i) {
    const angle = (lean * i) / 8;
    points.push([nose_radius * Math.sin(angle), nose_z - nose_radius * (1 - Math.cos(angle))]);
  }
  const [r0, z0] = points.at(-1) as [number, number];
  const shoulder = radius - 0.1;
  points.push([shoulder, z0 - (shoulder - r0) * Math.tan(lean)]);
  const [, z1] = points.at(-1) as [number, number];
  points.push([radius, z1 - 0.1], [radius - 0.03, z1 - 0.22], [0, z1 - 0.22]);
  return points;
}

/** The profile of the backshell: three cones and the lid of the parachute. */
export const BACKSHELL_PROFILE: readonly (readonly [number, number])[] = [
  [2.2, 0.55],
  [2.2, 0.45],
  [1.72, -0.5],
  [1.15, -1.15],
  [0.85, -1.3],
  [0.85, -1.5],
  [0, -1.55],
];

/** How far below the vehicle's centre the wheels are, with so much of the bridle paid out. */
export const wheelsBelow_m = (bridle_m: number): number => bridle_m + ROVER.stowed_z + ROVER.height / 2;

/**
 * What the view holds, in metres: how tall, and how far below the vehicle's centre its middle is along its axis.
 * `arrow`: the length of the vectors, as a part of the height.
 */
export const VIEWS: Record<Scenery, { tall: number; below: number; arrow: number }> = {
  cruise: { tall: 9, below: -0.3, arrow: 0.3 },
  entry: { tall: 10, below: 0, arrow: 0.36 },
  parachute: { tall: PARACHUTE.lines + 34, below: -PARACHUTE.lines / 2 - 1, arrow: 0.11 },
  descent: { tall: 11, below: 0.9, arrow: 0.3 },
  crane: { tall: 17.5, below: 4.2, arrow: 0.13 },
};

export const RAISED = 0.07; // chosen: the vehicle stands so much of the height above the middle, over the figures
