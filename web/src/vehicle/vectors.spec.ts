// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  attitudeInPicture,
  cross,
  dot,
  liftDirection,
  ofColumns,
  overGround,
  placeOf,
  rotated,
  toPicture,
} from './vectors';
import type { Quaternion, Vector } from './vectors';

const near = (a: readonly number[] | undefined, b: readonly number[]) =>
  b.forEach((each, i) => void expect(a?.[i]).toBeCloseTo(each, 6));
const place: Vector = [0, 3.4e6, 0]; // on the equator at 90° E

describe('the picture’s frame', () => {
  it('has east, up and south as its axes, wherever on Mars', () => {
    near(toPicture([-1, 0, 0], place), [1, 0, 0]); // at 90° E, east is −x of Mars
    near(toPicture([0, 1, 0], place), [0, 1, 0]);
    near(toPicture([0, 0, 1], place), [0, 0, -1]); // north is away from south
  });
  it('turns an attitude as it turns each axis of the vehicle', () => {
    const q: Quaternion = [0.5, -0.5, 0.5, 0.5];
    for (const axis of [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ] as Vector[])
      near(rotated(attitudeInPicture(q, place), axis), toPicture(rotated(q, axis), place));
  });
  it('finds the quaternion of any rotation, half turns too', () => {
    for (const q of [
      [1, 0, 0, 0],
      [0, 1, 0, 0],
      [0, 0, 1, 0],
      [0, 0, 0, 1],
      [0.1, 0.7, -0.7, 0.1],
      [-0.348, 0.2226, -0.6407, 0.6469],
    ] as Quaternion[]) {
      const size = Math.hypot(...q);
      const unit = q.map((each) => each / size) as unknown as Quaternion;
      const found = ofColumns(rotated(unit, [1, 0, 0]), rotated(unit, [0, 1, 0]), rotated(unit, [0, 0, 1]));
      expect(Math.abs(found.reduce((sum, each, i) => sum + each * (unit[i] as number), 0))).toBeCloseTo(1, 6);
    }
  });
});

describe('the direction of lift', () => {
  const east: Vector = [1, 0, 0];
  it('is up at no bank, to the right of the motion at 90°, and always across the velocity', () => {
    near(liftDirection([5000, 0, 0], 0), [0, 1, 0]);
    near(liftDirection([5000, 0, 0], 90), [0, 0, 1]); // who flies east has the south on the right
    for (const bank of [-150, -40, 75, 180]) {
      const lift = liftDirection([3000, -800, 400], bank) as Vector;
      expect(dot(lift, [3000, -800, 400])).toBeCloseTo(0, 6);
      expect(Math.hypot(...lift)).toBeCloseTo(1, 6);
    }
    near(cross(east, [0, 1, 0]), [0, 0, 1]);
  });
  it('is not known of a velocity straight down, or of none', () => {
    expect(liftDirection([0, -80, 0], 10)).toBeUndefined();
    expect(liftDirection([0.1, 0, 0], 10)).toBeUndefined();
  });
});

it('measures over ground east and north of a target: a degree of latitude is as long everywhere, one of longitude shrinks', () => {
  const target = placeOf(-4.6, 137.4, 3391148);
  const degree_m = (3391148 * Math.PI) / 180;
  const north = overGround(placeOf(-3.6, 137.4, 3400000), target);
  expect(north.north_m).toBeCloseTo(degree_m, 0);
  expect(north.east_m).toBeCloseTo(0, 3);
  expect(overGround(placeOf(-4.6, 137.5, 3391148), target).east_m).toBeCloseTo(
    0.1 * degree_m * Math.cos((4.6 * Math.PI) / 180),
    -1,
  );
  expect(Math.hypot(...Object.values(overGround(target, target)))).toBeLessThan(1e-6);
});
