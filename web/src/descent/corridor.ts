// SPDX-License-Identifier: Apache-2.0
// The predicted corridor, written by web/scripts/corridor.mjs: the published prediction [od137], and how far 12
// landings of the scenario "nominal_auto" strayed from it, in decades of altitude and speed.
export interface CorridorPoint {
  e_s: number; // from entry
  altitude_m: number; // above the landing radius
  speed_mps: number; // relative to Mars
  half_decades: number;
}

export const CORRIDOR: readonly CorridorPoint[] = [
  { e_s: -15.0, altitude_m: 156100, speed_mps: 5831, half_decades: 0.012 },
  { e_s: 61.5, altitude_m: 43730, speed_mps: 5666, half_decades: 0.012 },
  { e_s: 72.8, altitude_m: 31850, speed_mps: 4954, half_decades: 0.014 },
  { e_s: 82.8, altitude_m: 24650, speed_mps: 3841, half_decades: 0.02 },
  { e_s: 93.0, altitude_m: 20530, speed_mps: 2800, half_decades: 0.026 },
  { e_s: 104.0, altitude_m: 18700, speed_mps: 2052, half_decades: 0.09 },
  { e_s: 193.5, altitude_m: 17590, speed_mps: 613.5, half_decades: 0.092 },
  { e_s: 226.0, altitude_m: 15440, speed_mps: 490.6, half_decades: 0.14 },
  { e_s: 257.3, altitude_m: 11700, speed_mps: 399.9, half_decades: 0.218 },
  { e_s: 273.5, altitude_m: 10190, speed_mps: 158.4, half_decades: 0.23 },
  { e_s: 285.4, altitude_m: 9261, speed_mps: 115.5, half_decades: 0.23 },
  { e_s: 296.8, altitude_m: 8352, speed_mps: 99.93, half_decades: 0.227 },
  { e_s: 325.9, altitude_m: 5793, speed_mps: 90.07, half_decades: 0.227 },
  { e_s: 374.8, altitude_m: 1677, speed_mps: 78.83, half_decades: 0.193 },
  { e_s: 378.3, altitude_m: 1380, speed_mps: 91.5, half_decades: 0.03 },
  { e_s: 388.7, altitude_m: 605.3, speed_mps: 64.72, half_decades: 0.028 },
  { e_s: 396.8, altitude_m: 239.5, speed_mps: 32.17, half_decades: 0.019 },
  { e_s: 400.0, altitude_m: 135.5, speed_mps: 31.68, half_decades: 0.036 },
  { e_s: 402.8, altitude_m: 64.59, speed_mps: 19.91, half_decades: 0.067 },
  { e_s: 404.3, altitude_m: 39.52, speed_mps: 13.52, half_decades: 0.105 },
  { e_s: 405.4, altitude_m: 27.01, speed_mps: 8.724, half_decades: 0.142 },
  { e_s: 406.3, altitude_m: 21.0, speed_mps: 5.0, half_decades: 0.163 },
  { e_s: 406.9, altitude_m: 18.71, speed_mps: 2.343, half_decades: 0.241 },
  { e_s: 407.3, altitude_m: 18.13, speed_mps: 0.7496, half_decades: 0.241 },
  { e_s: 420.8, altitude_m: 8.01, speed_mps: 0.7496, half_decades: 0.241 },
];
