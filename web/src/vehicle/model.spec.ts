// SPDX-License-Identifier: Apache-2.0
import { silent } from '../testing/fixtures';
import { describe, expect, it } from 'vitest';
import dictionary from '../../../dictionaries/msl/msl.xml?raw';
import timeline from '../../../dictionaries/msl/timeline.csv?raw';
import { ENTRY_SCLK, firing, tone } from '../testing/fixtures';
import { lookAt, of, timepointOf, told } from '../testing/vehicle';
import { VEHICLE } from './layout';
import layout from './layout.ts?raw';
import type { Happening } from './layout';
import {
  configurationOf,
  configurationWords,
  happened,
  headingOf,
  missingOf,
  motionOf,
  partsOf,
  pathOf,
  sceneOf,
  sceneryOf,
} from './model';
import { dueWords, figuresOf, rowsOf } from './rows';

const flags = (values: Partial<Record<Happening, number>>) =>
  Object.fromEntries(
    Object.keys(VEHICLE.happenings).flatMap((which) => {
      const { flag } = of(which as Happening);
      return flag === undefined ? [] : [[flag, values[which as Happening] ?? 0]];
    }),
  );
const notFired = Object.fromEntries(
  Object.keys(VEHICLE.happenings).flatMap((which) => (of(which as Happening).pyros ?? []).map((name) => [name, 0])),
);
const upright = { nav_attitude_w: 1, nav_attitude_x: 0, nav_attitude_y: 0, nav_attitude_z: 0 };
const place = { nav_position_x_m: 0, nav_position_y_m: 3.4e6, nav_position_z_m: 0 };
const motion = { nav_velocity_x_mps: -5000, nav_velocity_y_mps: -500, nav_velocity_z_mps: 0 };
const fired = (name: string, e_s: number, verdict?: 'verified' | 'unverified') =>
  firing({ timepoint: timepointOf(name), name, firedSclk: ENTRY_SCLK + e_s, verdict });

describe('what the vehicle looks like', () => {
  it('is not known before anything has told', () => {
    const look = lookAt(-900, []);
    expect(configurationWords(configurationOf(look)).words).toBe('not received yet');
    expect(new Set(Object.values(partsOf(configurationOf(look))).flat())).toEqual(new Set(['unknown']));
    expect(missingOf(sceneOf(look))).toContain('configuration not received yet');
  });
  it('follows the flags of configuration from cruise to the sky crane', () => {
    const steps: [Partial<Record<Happening, number>>, string, string][] = [
      [{}, 'cruise', 'cruise stage, backshell, heatshield'],
      [{ cruiseStageGone: 1 }, 'entry', 'backshell, heatshield'],
      [{ cruiseStageGone: 1, parachuteOut: 1 }, 'parachute', 'parachute, backshell, heatshield'],
      [{ cruiseStageGone: 1, parachuteOut: 1, heatshieldGone: 1 }, 'parachute', 'parachute, backshell'],
      [
        { cruiseStageGone: 1, parachuteOut: 1, heatshieldGone: 1, backshellGone: 1 },
        'descent',
        'descent stage with the rover',
      ],
      [
        { cruiseStageGone: 1, parachuteOut: 1, heatshieldGone: 1, backshellGone: 1, roverSeparated: 1 },
        'crane',
        'descent stage, the rover below it on its bridle',
      ],
    ];
    for (const [given, scenery, words] of steps) {
      const configuration = configurationOf(lookAt(10, [told(9, { ...flags(given), ...notFired })]));
      expect([sceneryOf(configuration), configurationWords(configuration)]).toEqual([scenery, { words, doubts: [] }]);
    }
  });
  it('loses its balance masses by their pyros, pair by pair, and all of them with the backshell', () => {
    const partsAfter = (values: Record<string, number>) =>
      partsOf(configurationOf(lookAt(10, [told(9, { ...flags({}), ...notFired, ...values })])));
    expect(partsAfter({ pyro_entry_balance_1: 2 }).entryMasses).toEqual(['gone', 'there', 'there']);
    expect(partsAfter({ pyro_cruise_balance_2: 2 }).cruiseMasses).toEqual(['there', 'gone']);
    expect(partsAfter({ pyro_entry_balance_1: 1 }).entryMasses[0]).toBe('unknown'); // commanded: no one knows yet
    expect(partsAfter({ backshell_gone: 1 }).entryMasses).toEqual(['gone', 'gone', 'gone']);
  });
  it('believes a timepoint that UHF or a tone told of before any flag', () => {
    expect(happened(lookAt(10, [fired('heatshield_separation', 9)]), 'heatshieldGone').state).toBe('yes');
    const byTone = lookAt(10, [tone({ tone: 7, name: 'parachute_deploy', sclk: ENTRY_SCLK + 4 })]);
    expect(happened(byTone, 'parachuteOut')).toEqual({
      state: 'yes',
      why: 'timepoint parachute_deploy by tone at E+0:04.0',
    });
    expect(partsOf(configurationOf(byTone)).heatshield).toBe('unknown');
  });
  it('takes a flag that is a second late for late, and one that says no for longer for a contradiction', () => {
    const flag = (e_s: number) => told(e_s, { heatshield_gone: 0 });
    const at = (e_s: number) => happened(lookAt(20, [fired('heatshield_separation', 9), flag(e_s)]), 'heatshieldGone');
    expect(at(8).state).toBe('yes');
    expect(at(11).state).toBe('yes');
    expect(at(13)).toEqual({
      state: 'contradicted',
      why: 'timepoint heatshield_separation fired at E+0:09.0, but heatshield_gone is 0 at E+0:13.0',
    });
  });
  it('says a refused pyro beside a flag that believes it fired, and draws neither there nor gone', () => {
    const look = lookAt(20, [told(9, flags({ cruiseStageGone: 1 })), told(14, { pyro_cruise_stage_separation: 3 })]);
    const configuration = configurationOf(look);
    expect(partsOf(configuration).cruiseStage).toBe('unknown');
    expect(configurationWords(configuration).doubts).toEqual([
      expect.stringMatching(/^cruise stage gone: contradicted.*refused/),
    ]);
    expect(rowsOf(look, motionOf(look)).map(({ name }) => name)).toContain('contradiction');
  });
  it('is, in a past view, what was known then', () => {
    const items = [told(5, flags({})), told(15, flags({ parachuteOut: 1 }))];
    expect(happened(lookAt(20, items, { cutoff: ENTRY_SCLK + 10 }), 'parachuteOut').state).toBe('no');
    expect(happened(lookAt(20, items), 'parachuteOut').state).toBe('yes');
  });
});

describe('how it lies and moves', () => {
  it('has no attitude from parts of different instants, or from no quaternion, and says so', () => {
    const whole = lookAt(10, [told(9, { ...upright, ...place })]);
    expect(motionOf(whole).attitude).toBeDefined();
    const { nav_attitude_z, ...rest } = upright;
    const torn = lookAt(10, [told(5, { nav_attitude_z }), told(9, { ...rest, ...place })]);
    expect(motionOf(torn).attitude).toBeUndefined();
    const long = lookAt(10, [told(9, { ...upright, nav_attitude_x: 0.9, ...place })]);
    expect(motionOf(long).attitude).toBeUndefined();
    expect(missingOf(sceneOf(torn)).join()).toMatch(/attitude not received yet/);
  });
  it('flies to the right of a picture that looks across its approach', () => {
    const look = lookAt(10, [told(9, { ...upright, ...place, ...motion, bank_deg: 0 })]);
    const moved = motionOf(look);
    expect(moved.velocity?.map((each) => Math.round(each) + 0)).toEqual([5000, -500, 0]); // east, and down
    expect(headingOf(look, moved)).toBeCloseTo(Math.PI / 2);
    expect(moved.lift?.[1]).toBeGreaterThan(0.9);
  });
  it('keeps its heading from the first known place when it moves no more', () => {
    const look = lookAt(400, [
      told(0, { nav_position_x_m: 3e5, nav_position_y_m: 3.4e6, nav_position_z_m: 0 }),
      told(399, { ...place, nav_velocity_x_mps: 0, nav_velocity_y_mps: -1, nav_velocity_z_mps: 0 }),
    ]);
    expect(headingOf(look, motionOf(look))).toBeCloseTo(Math.PI / 2); // from +x to 0 at 90° E is to the east
  });
  it('tells no throttle while the engines are inside, and none that is not of one instant', () => {
    const all = Object.fromEntries(VEHICLE.throttles.map((name) => [name, 50]));
    const at = (configuration: object, more: Record<string, number>) =>
      sceneOf(lookAt(10, [told(8, configuration as Record<string, number>), told(9, more)])).throttles;
    expect(at(flags({}), all)).toBeUndefined();
    expect(at(flags({ backshellGone: 1 }), all)).toEqual(Array(8).fill(0.5));
    expect(at(flags({ backshellGone: 1 }), { throttle_1_percent: 50 })).toBeUndefined();
    // An order is no deed.
    expect(at({ ...flags({ backshellGone: 1 }), engines_off: 1 }, all)).toEqual(Array(8).fill(0.5));
    const stopped = (verdict: 'verified' | 'unverified') =>
      sceneOf(lookAt(10, [told(8, flags({ backshellGone: 1 })), told(9, all), fired('engines_off', 9, verdict)]))
        .throttles;
    expect(stopped('verified')).toEqual(Array(8).fill(0));
    expect(stopped('unverified')).toEqual(Array(8).fill(0.5));
  });
  it('draws no rover on a bridle of which nothing was told', () => {
    const scene = sceneOf(lookAt(10, [told(9, flags({ backshellGone: 1, roverSeparated: 1 }))]));
    expect(scene.bridle_m).toBeUndefined();
    expect(missingOf(scene)).toContain('bridle not received: the rover is not drawn');
  });
  it('has its path from above east and north of the target, of what was received alone', () => {
    const solution: [string, number][] = [
      ['target_latitude_deg', 0],
      ['target_longitude_deg', 90],
      ['target_radius_m', 3.39e6],
    ];
    const look = lookAt(10, [told(5, { ...place, nav_position_x_m: 34000 }), told(9, place)], { solution });
    const path = pathOf(look);
    expect(path.map(({ east_m, north_m }) => [Math.round(east_m / 1000) + 0, Math.round(north_m) + 0])).toEqual([
      [-34, 0],
      [0, 0],
    ]);
    expect(pathOf(lookAt(10, []))).toEqual([]);
  });
});

describe('the same as text', () => {
  it('gives every old value its age, and says of each missing one that it was not received', () => {
    const heard = told(9, { ...flags({}), ...upright, ...place, bank_deg: -40 });
    const rows = rowsOf(...lookAndMotion(lookAt(60, [heard, silent('Vehicle')])));
    const of = (name: string) => rows.find((row) => row.name === name);
    expect(of('bank')).toEqual({ name: 'bank', text: '−40.0°, lift up to the left', age: '◌ 51 s' });
    expect(of('mode')?.text).toBe('not received yet');
    expect(of('thrust')?.text).toBe('engines still inside the aeroshell');
    expect(figuresOf(...lookAndMotion(lookAt(0, [])))[0]).toMatchObject({ value: '—', note: 'not received yet' });
  });
  it('never counts down to what is past, or to what is not predicted', () => {
    expect(dueWords(100, 88)).toEqual({ value: '≈ 12 s', note: '≈ E+1:40' });
    expect(dueWords(100, 100.4).value).toBe('due');
    expect(dueWords(100, 103)).toEqual({ value: '+3 s', note: 'was predicted for ≈ E+1:40' });
    expect(dueWords(undefined, 3)).toEqual({ value: '—', note: 'time not predicted' });
    expect(dueWords(100, NaN).value, 'while the clock stands still').toBe('E+1:40');
  });
});

const lookAndMotion = (look: ReturnType<typeof lookAt>) => [look, motionOf(look)] as const;

it('names of the mission in the layout are words of the shipped dictionary', () => {
  const names = [...layout.matchAll(/'([A-Za-z0-9]+(?:_[A-Za-z0-9]+)+)'/g)].map((match) => match[1] as string);
  expect(names.length).toBeGreaterThan(50);
  const links = ['uhf_live'];
  const unknown = names.filter(
    (name) => !links.includes(name) && !dictionary.includes(`"${name}"`) && !timeline.includes(`\n${name},`),
  );
  expect(unknown).toEqual([]);
});
