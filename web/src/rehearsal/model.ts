// SPDX-License-Identifier: Apache-2.0
// The paces that a key steps through. 0 is "as fast as possible".
export const PACES = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 0] as const;

export function nextPace(current: number, direction: 1 | -1): number {
  if (current === 0) return direction > 0 ? 0 : 1000;
  if (direction > 0) return PACES.find((pace) => pace > current) ?? 0;
  return PACES.findLast((pace) => pace !== 0 && pace < current) ?? 1;
}

export function paceText(pace: number): string {
  return pace === 0 ? 'max' : `${pace}×`;
}

/** "3.98×": the attained pace, if it differs from the requested one. */
export function attainedText(asked: number, attained: number): string {
  if (attained <= 0) return '';
  const digits = attained < 10 ? 1 : 0;
  return asked !== 0 && Math.abs(attained - asked) / asked < 0.05 ? '' : `reaches ${attained.toFixed(digits)}×`;
}
