// SPDX-License-Identifier: Apache-2.0
// Vectors and quaternions in monogram notation (docs/frames_and_units.md): M is Mars, B the vehicle, S the picture's
// own frame at the vehicle: x east, y up, z south.

export type Vector = readonly [number, number, number];
export type Quaternion = readonly [w: number, x: number, y: number, z: number];

export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const scaled = (a: Vector, by: number): Vector => [a[0] * by, a[1] * by, a[2] * by];
export const plus = (a: Vector, b: Vector): Vector => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const length = (a: Vector): number => Math.hypot(...a);
export const unit = (a: Vector): Vector => scaled(a, 1 / (length(a) || 1));

/** East, up and south at a place, in M. */
export function axesAt(p_M: Vector): { east: Vector; up: Vector; south: Vector } {
  const up = unit(p_M);
  const east = unit(cross([0, 0, 1], up));
  return { east, up, south: cross(east, up) };
}

/** From M to S at a place. */
export function toPicture(v_M: Vector, p_M: Vector): Vector {
  const { east, up, south } = axesAt(p_M);
  return [dot(v_M, east), dot(v_M, up), dot(v_M, south)];
}

export function rotated([w, x, y, z]: Quaternion, v: Vector): Vector {
  const q: Vector = [x, y, z];
  const t = scaled(cross(q, v), 2);
  return plus(plus(v, scaled(t, w)), cross(q, t));
}

/** The quaternion of a rotation whose matrix has these columns. [shepperd-1978]: divides by the largest part. */
export function ofColumns(a: Vector, b: Vector, c: Vector): Quaternion {
  const trace = a[0] + b[1] + c[2];
  const largest = Math.max(trace, a[0], b[1], c[2]);
  const parts: [number, number, number, number] =
    largest === trace
      ? [1 + trace, b[2] - c[1], c[0] - a[2], a[1] - b[0]]
      : largest === a[0]
        ? [b[2] - c[1], 1 + a[0] - b[1] - c[2], a[1] + b[0], c[0] + a[2]]
        : largest === b[1]
          ? [c[0] - a[2], a[1] + b[0], 1 + b[1] - a[0] - c[2], b[2] + c[1]]
          : [a[1] - b[0], c[0] + a[2], b[2] + c[1], 1 + c[2] - a[0] - b[1]];
  const norm = Math.hypot(...parts) || 1;
  return [parts[0] / norm, parts[1] / norm, parts[2] / norm, parts[3] / norm];
}

/** The vehicle's attitude in the picture, q_SB, from q_MB and the place. */
export function attitudeInPicture(q_MB: Quaternion, p_M: Vector): Quaternion {
  const axis = (v: Vector) => toPicture(rotated(q_MB, v), p_M);
  return ofColumns(axis([1, 0, 0]), axis([0, 1, 0]), axis([0, 0, 1]));
}

/**
 * The direction of lift in the picture: across the velocity, at the bank angle from straight up; positive to the
 * right of the motion. Undefined while the velocity is vertical or none.
 */
export function liftDirection(v_S: Vector, bank_deg: number): Vector | undefined {
  const forward = unit(v_S);
  const right = cross(forward, [0, 1, 0]);
  if (length(v_S) < 1 || length(right) < 0.05) return undefined;
  const across = unit(right);
  const above = cross(across, forward);
  const bank = (bank_deg * Math.PI) / 180;
  return plus(scaled(above, Math.cos(bank)), scaled(across, Math.sin(bank)));
}

/** East and north of `target` in metres over ground, for a place near it. */
export function overGround(p_M: Vector, target_M: Vector): { east_m: number; north_m: number } {
  const { east, up, south } = axesAt(target_M);
  const [x, y, z] = [dot(p_M, east), dot(p_M, up), -dot(p_M, south)];
  const across = Math.hypot(x, z);
  const arc = across === 0 ? 0 : (Math.atan2(across, y) * length(target_M)) / across;
  return { east_m: x * arc, north_m: z * arc };
}

/** The direction of a latitude and longitude, at a radius, in M. */
export function placeOf(latitude_deg: number, longitude_deg: number, radius_m: number): Vector {
  const [latitude, longitude] = [(latitude_deg * Math.PI) / 180, (longitude_deg * Math.PI) / 180];
  return scaled(
    [Math.cos(latitude) * Math.cos(longitude), Math.cos(latitude) * Math.sin(longitude), Math.sin(latitude)],
    radius_m,
  );
}
