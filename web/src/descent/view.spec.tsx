// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { describe, expect, it } from 'vitest';
import { TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { predictForTest } from '../prediction/model';
import { Series } from '../run/series';
import { useForTest } from '../run/session';
import { timepoints } from '../run/shown';
import { aDictionary, aStore, firing, samples, silent } from '../testing/fixtures';
import { LEAST_M, fraction, isClear, pathOf, wayOf } from './model';
import { Descent } from './view';

/** [e_s, altitude, speed] of a made-up descent: fast and high, a brake, a parachute, a landing. */
const PREDICTED: [number, number, number][] = Array.from({ length: 460 }, (_, i) => {
  const e_s = i - 25;
  const altitude_m = e_s < 100 ? 130000 - 1100 * e_s : Math.max(8, 20000 * ((430 - e_s) / 330) ** 1.5);
  const braked_mps = e_s < 60 ? 5800 : Math.max(80, 5800 * Math.exp(-(e_s - 60) / 42));
  const speed_mps = e_s < 380 ? braked_mps : Math.max(0.75, (80 * (430 - e_s)) / 50);
  return [e_s, altitude_m, speed_mps];
});
function seriesOf(of: 1 | 2): Series {
  const series = new Series();
  series.append(
    Float64Array.from(PREDICTED, ([e_s]) => 1000 + e_s),
    Float64Array.from(PREDICTED, (point) => point[of]),
  );
  return series;
}

describe('the descent picture', () => {
  it('gives the last ten metres as much room as the last hundred kilometres have for each factor of ten', () => {
    const height = (m: number) => fraction(m, LEAST_M, 200000);
    expect(height(100) - height(10)).toBeCloseTo(height(100000) - height(10000));
    expect([height(0), height(200000)]).toEqual([0, 1]);
  });
  it('has the predicted path from just before entry down to the touchdown, and none without a prediction', () => {
    const path = pathOf(seriesOf(1), seriesOf(2), 1000, 430);
    expect([path[0]?.e_s, path.at(-1)?.e_s]).toEqual([-15, 430]);
    expect(pathOf(undefined, undefined, 1000, 430)).toEqual([]);
  });
  it('lets no way run through words that have another place: however small the words, and dense its points', () => {
    const way = wayOf(Array.from({ length: 4001 }, (_, i) => [i / 10, i / 20] as const)); // from (0, 0) to (400, 200)
    expect(way.length).toBeLessThan(130);
    for (let x = 10; x < 380; x += 7) {
      expect(isClear([x, x / 2 - 4, x + 30, x / 2 + 8], way), `through it at ${x}`).toBe(false);
      expect(isClear([x, x / 2 + 22, x + 30, x / 2 + 38], way), `below it at ${x}`).toBe(true);
    }
  });
});

it('figures that nothing has come for are dim, with their age; at touchdown they are of then', () => {
  const root = document.createElement('div');
  const shown = (sclk: number, more: Parameters<typeof aStore>[0] = []) => {
    act(() => {
      useForTest(aStore([samples(sclk, { 3: 60000, 4: 5800 }), ...more]), aDictionary);
      predictForTest(create(PredictionSchema, { state: 'ready' }), {
        3: PREDICTED.map(([e_s, altitude]) => [e_s, altitude]),
        4: PREDICTED.map(([e_s, , speed]) => [e_s, speed]),
      });
      timepoints.value = [create(TimepointRowSchema, { id: 9, name: LAYOUT.landed })];
      render(<Descent />, root);
    });
    return ['descent-now.stale', 'descent-now [data-testid=descent-stale] dd'].map(
      (each) => root.querySelector(`.${each}`)?.textContent,
    );
  };
  expect(shown(899)).toEqual([undefined, undefined]);
  expect(shown(859, [silent('Navigation')])).toEqual([expect.stringContaining('60.0 km'), '◌ 41 s old']);
  expect(shown(850, [firing({ timepoint: 9, name: LAYOUT.landed, firedSclk: 850 })])[1]).toBeUndefined();
});
