// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, it } from 'vitest';
import { showAt, tab } from '../places/model';
import { useForTest } from '../run/session';
import { dismissNotice, notices } from '../run/shown';
import { aDictionary, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { asksElsewhere, flyOut } from './fly_out';

const server = aServer();
const intent = {
  command: 'EDL_SET_PARAMETERS',
  arguments: [{ name: 'parachute_speed_mps', value: 390 }],
  fromSolution: true,
  service: '',
  releaseAt: '2012-219T05:00:00',
  hold: false,
  priority: 0,
  controller: '',
};

beforeEach(() => useForTest(aStore(), aDictionary));
afterEach(() => {
  showAt('data', 'channels');
  for (const { id } of notices.value) dismissNotice(id);
});

it('a reviewed command is flown out as it stands, by what ground heard, and its panel is shown', async () => {
  server.routes['POST /runs/3/forecasts'] = { status: 201, json: { forecast: '2' } };
  const before = asksElsewhere.value;
  await flyOut(3, intent);
  expect(server.asked.at(-1)?.body).toEqual({
    from: 'telemetry',
    cases: 32,
    commands: [
      {
        command: 'EDL_SET_PARAMETERS',
        arguments: [{ name: 'parachute_speed_mps', value: 390 }],
        from_solution: true,
        release_at: '2012-219T05:00:00',
      },
    ],
  });
  expect([asksElsewhere.value, tab.value]).toEqual([before + 1, 'what_if']);
});

it('what cannot be flown out is told in words, and the panel stays as it is', async () => {
  server.routes['POST /runs/3/forecasts'] = { status: 503, json: { error: '8 forecasts wait already' } };
  await flyOut(3, intent);
  expect(notices.value.map(({ text }) => text)).toEqual(['no forecast: 8 forecasts wait already']);
  expect(tab.value).toBe('channels');
});
