// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { describe, expect, it } from 'vitest';
import type { Item } from '../gen/aeolis/v1/items_pb';
import { useForTest } from '../run/session';
import { timepoints } from '../run/shown';
import { ENTRY_SCLK, event, firing, link, tone } from '../testing/fixtures';
import { ROVER, lookAt, timepointOf, told, vehicleDictionary, vehiclePlan } from '../testing/vehicle';
import { TOUCHDOWN } from '../vehicle/layout';
import { compass, restOf, resultsOf, touchdownOf } from './model';
import type { Rules } from './model';
import { Touchdown } from './view';

const DOWN = 430;
const rules: Rules = { ...TOUCHDOWN, ...ROVER };
const fired = (recorded = false) =>
  firing({
    timepoint: timepointOf('touchdown'),
    name: 'touchdown',
    firedSclk: ENTRY_SCLK + DOWN,
    ...(recorded && { source: 2 }),
  });
const rest = { rover_x: 0.01, rover_y: -0.02, rover_g: 0.379 };
/** The rover at rest and the phase over UHF, each second of a stretch. */
const still = (from: number, to: number, more: Record<string, number> = {}): Item[] =>
  Array.from({ length: to - from + 1 }, (_, i) => told(from + i, { ...rest, ...more }));
const heard = (from: number, to: number): Item[] =>
  Array.from({ length: to - from + 1 }, (_, i) => told(from + i, { edl_phase: 11 }));
/** The test's clock: vehicle time 900 + n is 05:00:00 + n on Earth when the run is looked at then. */
const ert = (e_s: number, now_e_s: number) =>
  new Date(Date.UTC(2012, 7, 6, 5, 0, 0) + (e_s - now_e_s) * 1000).toISOString().slice(11, 23);
const uhf = (e_s: number, now_e_s: number, up: boolean, reason = '') =>
  link({ link: TOUCHDOWN.link, up, reason, ert: `2012-219T${ert(e_s, now_e_s)}` });

const states = (now_e_s: number, items: Item[], more: Parameters<typeof lookAt>[2] = {}, by: Rules = rules) => {
  const of = touchdownOf(lookAt(now_e_s, items, more), by);
  return of && [of.verdict, ...of.steps.map(({ state }) => state)];
};
const words = (now_e_s: number, items: Item[], step: number, by: Rules = rules) =>
  touchdownOf(lookAt(now_e_s, items), by)?.steps[step]?.words;

describe('a touchdown', () => {
  it('is not there until something has told of it', () => {
    expect(states(DOWN - 1, [...still(400, DOWN - 1), ...heard(400, DOWN - 1)])).toBeUndefined();
  });
  it('is reported by the event alone, and confirmed once the rover is still and UHF went on', () => {
    const all = [fired(), ...still(DOWN, DOWN + 15), ...heard(DOWN, DOWN + 15)];
    const until = (e_s: number) => states(DOWN + 15, all, { cutoff: ENTRY_SCLK + e_s });
    expect(until(DOWN)).toEqual(['reported', 'done', 'unknown', 'unknown']);
    expect(until(DOWN + 4)).toEqual(['reported', 'done', 'waiting', 'waiting']);
    expect(until(DOWN + 8)).toEqual(['reported', 'done', 'done', 'waiting']);
    expect(until(DOWN + 12)).toEqual(['confirmed', 'done', 'done', 'done']);
  });
  it('is told by tone too, with every source named', () => {
    const sclk = ENTRY_SCLK + DOWN;
    expect(words(DOWN + 1, [tone({ tone: 9, name: 'touchdown', sclk })], 0)).toBe(
      'E+7:10.0: timepoint touchdown by tone',
    );
    expect(
      words(DOWN + 1, [fired(), event({ name: 'TOUCHDOWN', sclk }), told(DOWN + 1, { touchdown_declared: 1 })], 0),
    ).toBe('E+7:10.0: timepoint touchdown by UHF, event TOUCHDOWN by UHF, touchdown_declared is 1');
    expect(words(DOWN + 1, [fired(true)], 0)).toMatch(/by the recording/);
  });
  it('is contradicted by a newer flag that says no, not by one of the same moment', () => {
    expect(states(DOWN + 9, [fired(), told(DOWN + 1, { touchdown_declared: 0 })])?.[0]).toBe('reported');
    expect(states(DOWN + 9, [fired(), told(DOWN + 6, { touchdown_declared: 0 })])?.slice(0, 2)).toEqual([
      'contradicted',
      'contradicted',
    ]);
  });
});

describe('the rover’s stillness', () => {
  it('is never told where flight sends no channel of its own IMU, and so the touchdown stays reported', () => {
    expect(words(DOWN + 20, [fired(), ...heard(DOWN, DOWN + 20)], 1, TOUCHDOWN)).toMatch(
      /the IMU told of is the descent stage’s: so this touchdown stays reported$/,
    );
  });
  it('begins anew with each motion and after each gap', () => {
    const moves = told(DOWN + 4, { ...rest, rover_x: 3 });
    expect(states(DOWN + 8, [fired(), ...still(DOWN, DOWN + 3), moves, ...still(DOWN + 5, DOWN + 8)])?.[2]).toBe(
      'waiting',
    );
    expect(words(DOWN + 8, [fired(), ...still(DOWN, DOWN + 3), moves, ...still(DOWN + 5, DOWN + 8)], 1)).toBe(
      'still for 3.0 s of 5 s; last moved: rover_x 3.000 °/s at E+7:14.0',
    );
    expect(states(DOWN + 9, [fired(), ...still(DOWN, DOWN + 3), ...still(DOWN + 7, DOWN + 9)])?.[2]).toBe('waiting');
  });
  it('ends with a later motion: what was still is not still', () => {
    const moves = told(DOWN + 9, { ...rest, rover_g: 0.9 });
    expect(words(DOWN + 9, [fired(), ...still(DOWN, DOWN + 8), moves], 1)).toMatch(/^it moves: rover_g 0\.900 g/);
  });
  it('needs each of its channels', () => {
    const part = Array.from({ length: 9 }, (_, i) => told(DOWN + i, { rover_x: 0, rover_y: 0 }));
    expect(words(DOWN + 8, [fired(), ...part], 1)).toBe('not all of it has come yet');
  });
  it('comes late with the recording', () => {
    const late = Array.from({ length: 8 }, (_, i) => told(DOWN + 1 + i, rest, true));
    expect(states(DOWN + 300, [fired(), ...late])?.[2]).toBe('done');
  });
});

describe('UHF after a touchdown', () => {
  it('does not count what came with the recording', () => {
    const late = Array.from({ length: 15 }, (_, i) => told(DOWN + i, { edl_phase: 11 }, true));
    expect(states(DOWN + 300, [fired(), ...late])?.[3]).toBe('unknown');
  });
  it('that falls silent is not known, with the time and the reason', () => {
    const now = DOWN + 40;
    const items = [
      uhf(0, now, true),
      fired(),
      ...heard(DOWN, DOWN + 4),
      uhf(DOWN + 5, now, false, 'orbiter below the horizon'),
    ];
    expect(words(now, items, 2)).toBe(
      'not known: no UHF since E+7:15.0: orbiter below the horizon; 3.0 s had come without a break',
    );
    expect(words(now, [uhf(0, now, true), fired(), uhf(DOWN, now, false, 'lost')], 2)).toBe(
      'not known: no UHF since E+7:10.0: lost',
    );
    expect(words(now, [fired()], 2)).toBe('not known: no UHF since touchdown at E+7:10.0');
  });
  it('starts anew after a break, and then suffices', () => {
    const items = [fired(), ...heard(DOWN, DOWN + 5), ...heard(DOWN + 12, DOWN + 24)];
    expect(words(DOWN + 24, items, 2)).toBe(
      'E+7:32.0: edl_phase came over uhf_live each second or more often since E+7:22.0',
    );
    expect(states(DOWN + 18, items.slice(0, -6))?.[3]).toBe('waiting');
  });
});

describe('its figures', () => {
  const solution: [string, number][] = [
    ['target_latitude_deg', 0],
    ['target_longitude_deg', 90],
    ['target_radius_m', 3.39e6],
  ];
  const place = { nav_position_x_m: -400, nav_position_y_m: 3.39e6, nav_position_z_m: 300 };
  it('are of the touchdown, not of the stage that flies away', () => {
    const look = lookAt(
      DOWN + 9,
      [
        fired(),
        told(DOWN - 0.5, { ...place, descent_rate_mps: 0.68, horizontal_speed_mps: 0.02, propellant_kg: 89.4 }),
        told(DOWN + 5, {
          ...place,
          nav_position_x_m: -9000,
          descent_rate_mps: -30,
          horizontal_speed_mps: 22,
          propellant_kg: 60,
        }),
      ],
      { solution },
    );
    expect(resultsOf(look, ENTRY_SCLK + DOWN).map(({ value }) => value)).toEqual(['0.68', '0.02', '500', '89.4', '—']);
    expect(resultsOf(look, ENTRY_SCLK + DOWN)[2]?.note).toBe(
      'to the north-east, by navigation on board; its uncertainty is not told',
    );
  });
  it('that did not come near the touchdown say that they are not known', () => {
    const look = lookAt(DOWN + 9, [fired(), told(DOWN - 20, { ...place, descent_rate_mps: 0.7 })], { solution });
    expect(resultsOf(look, ENTRY_SCLK + DOWN).map(({ value, note }) => [value, note.slice(0, 9)])).toEqual(
      Array(5).fill(['—', 'not known']),
    );
  });
  it('name the direction by eight points', () => {
    expect(compass({ east_m: 0, north_m: 5 })).toBe('north');
    expect(compass({ east_m: -5, north_m: 0.1 })).toBe('west');
    expect(compass({ east_m: 3, north_m: -3 })).toBe('south-east');
  });
  it('say what still comes, and nothing of it in a past view', () => {
    const look = lookAt(DOWN + 60, [fired()]);
    look.run.run.relayProgress = 0.374;
    expect(restOf(look, true)[0]).toEqual({
      words: '37 % of the recording has come. When the next pass is has not been told.',
      part: 0.374,
    });
    expect(restOf(look, false)[0]?.part).toBeUndefined();
  });
});

it('the card says the verdict, each step with its evidence, and leads on', () => {
  const root = document.createElement('div');
  const look = lookAt(DOWN + 15, [fired(), ...heard(DOWN, DOWN + 15)]);
  act(() => {
    useForTest(look.run, vehicleDictionary);
    timepoints.value = vehiclePlan;
    render(<Touchdown />, root);
  });
  expect(root.querySelector('h3')?.textContent).toBe('✓ Touchdown reported E+7:10.0, 2 of 3 signals, 1 never told');
  expect([...root.querySelectorAll('.touchdown-steps li')].map((each) => (each as HTMLElement).dataset.state)).toEqual([
    'done',
    'never',
    'done',
  ]);
  expect(root.querySelector('.touchdown-map')?.textContent).toBe('The place is not known.');
  expect([...root.querySelectorAll('a')].map((each) => each.getAttribute('href'))).toEqual([
    '?panel=flown&run=1',
    '?panel=verdicts&run=1',
  ]);
});
