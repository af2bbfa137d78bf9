// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { expect, it, vi } from 'vitest';
import { cursor } from '../run/cursor';
import { create } from '@bufbuild/protobuf';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { predictForTest } from '../prediction/model';
import { backToLive, useForTest } from '../run/session';
import { lookAtPast } from '../run/shown';
import { difference } from './model';
import { aDictionary, aStore, samples, silent, unit } from '../testing/fixtures';
import { Plots, toggleDifference } from './view';

const { looks, sizes } = vi.hoisted(() => ({ looks: [] as (() => (() => void) | undefined)[], sizes: [] as number[] }));
vi.mock('../draw/loop', () => ({
  onDraw: (look: (typeof looks)[number]) => {
    looks.push(look);
    return () => undefined;
  },
}));
vi.mock('uplot', () => ({
  default: class {
    scales = {};
    width = 300;
    height = 300;
    batch(change: () => void) {
      change();
    }
    setData([x]: number[][]) {
      sizes.push(x?.length ?? 0);
    }
    setScale() {}
    destroy() {}
  },
}));

it('a plot of the past is drawn again when only what it knows of it changes, with the recording or as it was heard', () => {
  const heard = (sclk: number, ert: string) => [unit({ name: 'Navigation', sclk, ert }), samples(sclk, { 3: sclk })];
  // SCLK 900 is heard at 05:00:00; an orbiter delivered 912 five minutes later.
  useForTest(
    aStore([
      ...heard(911, '2012-219T05:00:11.0'),
      ...heard(912, '2012-219T05:05:12.0'),
      ...heard(913, '2012-219T05:00:13.0'),
    ]),
    aDictionary,
  );
  for (const side of ['clientWidth', 'clientHeight'])
    vi.spyOn(HTMLElement.prototype, side as 'clientWidth', 'get').mockReturnValue(300);
  const root = document.createElement('div');
  act(() => render(<Plots />, root));
  const drawn = (recorded: boolean) => {
    lookAtPast({ from: -95, to: -80 }, recorded);
    sizes.length = 0;
    looks[0]?.()?.();
    return [...sizes];
  };
  expect([drawn(true), drawn(true), drawn(false), drawn(true)]).toEqual([[3], [], [2], [3]]);
  act(() => render(null, root));
  backToLive();
  vi.restoreAllMocks();
});

it('the figure beside a plot goes stale as the channel does, and not under the cursor, where it is of then', () => {
  const root = document.createElement('div');
  const shown = (at?: number) => {
    act(() => {
      cursor.value = at;
      render(<Plots />, root);
    });
    return [
      '.stale [data-testid=stale-altitude]',
      '.stale [data-testid=reading-altitude]',
      '[data-testid=reading-altitude]',
    ].map((each) => root.querySelector(each)?.textContent?.trim());
  };
  useForTest(aStore([samples(899, { 3: 65100 })]), aDictionary);
  expect(shown()).toEqual([undefined, undefined, '65.10']);
  act(() => useForTest(aStore([samples(859, { 3: 65100 }), silent('Navigation')]), aDictionary));
  expect(shown()).toEqual(['◌ 41 s', '65.10', '65.10']);
  expect(shown(-141)).toEqual([undefined, undefined, '65.10']);
  cursor.value = undefined;
});

it('at the cursor stands what was observed, what was predicted and the difference; a key puts the difference in place of the values', async () => {
  const root = document.createElement('div');
  act(() => {
    useForTest(aStore([samples(899, { 3: 65100 })]), aDictionary);
    predictForTest(create(PredictionSchema, { state: 'ready', basis: 'the nominal flight' }), {
      3: [
        [-102, 65000],
        [-101, 64000],
        [-100, 63000],
      ],
    });
    render(<Plots />, root);
  });
  await act(async () => vi.dynamicImportSettled());
  const text = (id: string) => root.querySelector(`[data-testid=${id}]`)?.textContent?.trim();
  expect([text('reading-altitude'), text('tip-altitude')]).toEqual(['65.10', undefined]);
  const button = root.querySelector<HTMLElement>('.panel-plot-altitude .plot-difference');
  expect([button?.getAttribute('aria-pressed'), button?.title]).toEqual([
    'false',
    'key j: observed less predicted, by the nominal flight',
  ]);
  act(() => {
    cursor.value = -101;
  });
  expect(text('tip-altitude')).toBe('observed65.10predicted64.00difference+1.10');
  act(() => {
    cursor.value = -101.5;
  });
  expect(text('tip-altitude'), 'nothing was observed yet').toBe('predicted64.50');
  act(() => {
    cursor.value = undefined;
    button?.click();
  });
  expect([text('reading-altitude'), button?.getAttribute('aria-pressed')]).toEqual(['+1.10', 'true']);
  expect(
    root.querySelector('.panel-plot-speed .plot-difference:not(.is-due)'),
    'nothing is predicted of it',
  ).toBeNull();
  act(toggleDifference);
  expect([difference.value, text('reading-altitude')]).toEqual([false, '65.10']);
});
