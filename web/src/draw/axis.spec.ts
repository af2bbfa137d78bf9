// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { decadeTicks } from './axis';

describe('the ticks of an axis that is logarithmic far from zero', () => {
  it('are zero and the powers of ten in sight, each as it is written', () => {
    expect(decadeTicks(-0.05, 140, 200, 0.1)).toEqual([0, 0.1, 1, 10, 100]);
    expect(decadeTicks(-20, 20, 200, 0.1)).toEqual([-10, -1, -0.1, 0, 0.1, 1, 10]);
  });
  it('are round numbers where the powers of ten would be one or none', () => {
    expect(decadeTicks(20, 80, 100, 0.1)).toEqual([20, 40, 60, 80]);
  });
  it('keep their distance in a low plot', () => {
    expect(decadeTicks(-0.05, 140, 90, 0.1)).toEqual([0, 1, 10, 100]);
    expect(decadeTicks(-0.05, 140, 45, 0.1)).toEqual([0, 1, 100]);
  });
});
