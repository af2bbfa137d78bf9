// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { describe, expect, it } from 'vitest';
import { useForTest } from '../run/session';
import { pastRange, timepoints } from '../run/shown';
import { ColumnCollector } from '../stream/columns';
import { ENTRY_SCLK, aBatch, situation } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { lookAt, vehicleDictionary, vehiclePlan } from '../testing/vehicle';
import { compass, refreshTouchdown, restOf, resultsOf } from './model';
import { touchdownAnswer, touchdownKnown } from './shown';
import type { TouchdownReport } from './shown';
import { Touchdown } from './view';

const server = aServer();
const DOWN = 430;
const REPORT: TouchdownReport = {
  verdict: 'reported',
  sclk: ENTRY_SCLK + DOWN,
  steps: [
    { name: 'touchdown told by the vehicle', state: 'done', words: 'E+7:10.0: timepoint touchdown by UHF' },
    { name: 'rover’s own IMU is still: this vehicle never tells', state: 'never', words: 'flight sends no channel' },
    { name: 'UHF came for 10 s', state: 'done', words: 'E+7:21.0: edl_phase came' },
  ],
  figures: [
    { name: 'down', channel: 'descent_rate_mps', unit: 'm/s', value: 0.684, before_s: 0.5 },
    { name: 'across', channel: 'horizontal_speed_mps', unit: 'm/s', value: -0.02, before_s: 0 },
    { name: 'propellant left', channel: 'propellant_kg', unit: 'kg', before_s: 0 },
  ],
  place: { east_m: 400, north_m: 300, inside_ellipse: true, rests_on: 'the entry solution' },
  place_unknown: '',
};

describe('the figures of a touchdown', () => {
  it('are the server’s, with how long before it each was measured', () => {
    const results = resultsOf(lookAt(DOWN + 9, []), REPORT);
    expect(results.map(({ name, value }) => [name, value])).toEqual([
      ['down', '0.68'],
      ['across', '−0.02'],
      ['from the target', '500'],
      ['propellant left', '—'],
      ['against predicted', '—'],
    ]);
    expect(results.map(({ note }) => note).slice(0, 4)).toEqual([
      'descent_rate_mps, 0.5 s before',
      'horizontal_speed_mps, at touchdown',
      'to the north-east, by navigation on board, uncertainty not known',
      'not known: propellant_kg did not come near it',
    ]);
  });
  it('say why the place is not known', () => {
    const { place: _, ...rest } = REPORT;
    const results = resultsOf(lookAt(DOWN + 9, []), { ...rest, place_unknown: 'no target in the ground’s solution' });
    expect(results[2]).toMatchObject({ value: '—', note: 'not known: no target in the ground’s solution' });
  });
  it('name the direction by eight points', () => {
    expect(compass({ east_m: 0, north_m: 5 })).toBe('north');
    expect(compass({ east_m: -5, north_m: 0.1 })).toBe('west');
    expect(compass({ east_m: 3, north_m: -3 })).toBe('south-east');
  });
  it('say what still comes, and nothing of it in a past view', () => {
    const look = lookAt(DOWN + 60, []);
    look.run.run.relayProgress = 0.374;
    expect(restOf(look, true)[0]).toEqual({
      words: '37 % of the recording has come. When the next pass is has not been told.',
      part: 0.374,
    });
    expect(restOf(look, false)[0]?.part).toBeUndefined();
  });
});

it('a past view asks for its own instant as it was heard, and shows no answer that knows later data', async () => {
  const { run } = lookAt(DOWN + 15, []);
  act(() => useForTest(run, vehicleDictionary));
  pastRange.value = { from: 0, to: DOWN + 5 };
  server.routes[`GET /runs/1/touchdown?at=${ENTRY_SCLK + DOWN + 5}&recorded=false`] = { json: REPORT };
  await refreshTouchdown();
  expect(touchdownKnown.value?.verdict).toBe('reported');
  pastRange.value = { from: 0, to: DOWN + 7 }; // the replay has advanced
  expect(touchdownKnown.value?.verdict).toBe('reported');
  pastRange.value = { from: 0, to: DOWN };
  expect(touchdownKnown.value).toBeUndefined();
  pastRange.value = undefined;
  expect(touchdownKnown.value).toBeUndefined();
});

it('the card is asked for anew as soon as the banner says another thing of the touchdown', async () => {
  const landed = (sentence: string) => situation('2012-219T05:08:50.0', { rank: 'news', subject: 'landed', sentence });
  const { run } = lookAt(DOWN + 15, [landed('Touchdown reported at E+7:10')]);
  act(() => useForTest(run, vehicleDictionary));
  const path = 'GET /runs/1/touchdown?';
  server.routes[path] = { json: REPORT };
  await refreshTouchdown();
  server.routes[path] = { json: { ...REPORT, verdict: 'confirmed' } };
  await refreshTouchdown();
  expect(touchdownKnown.value?.verdict, 'asked for a moment ago').toBe('reported');
  const heard = new ColumnCollector();
  heard.add(aBatch([landed('Touchdown confirmed, at E+7:10')]));
  run.add(heard.take());
  await refreshTouchdown();
  expect(touchdownKnown.value?.verdict).toBe('confirmed');
});

it('the card says the verdict, each step with its evidence, and leads on', () => {
  const root = document.createElement('div');
  const shown = (report: TouchdownReport | undefined) => {
    touchdownAnswer.value = report && { at: Infinity, live: false, report };
    render(<Touchdown />, root);
  };
  act(() => {
    useForTest(lookAt(DOWN + 15, []).run, vehicleDictionary);
    timepoints.value = vehiclePlan;
    shown(undefined);
  });
  expect(root.textContent).toBe('Asking the server for the touchdown…');
  act(() => shown({ ...REPORT, verdict: 'untold' }));
  expect(root.textContent).toBe('No touchdown has been told.');
  const { place: _, ...placeless } = REPORT;
  act(() => shown(placeless));
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
