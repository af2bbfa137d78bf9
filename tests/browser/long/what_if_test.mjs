// SPDX-License-Identifier: Apache-2.0
// A landing is forked in the browser, waits at its instant, is broken there, and is laid over the one that it was; then it is asked what would
// have come of it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { control, findings, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

test('a landing is forked, goes on otherwise, is laid over the one that it was, and is forecast with a fault and without', async (t) => {
  const server = await serve(t, 'what_if', ['--scenario', 'nominal_auto', '--pace', '0']);
  await waitFor(async () => (await server.get('/runs/1')).state, /finished/);
  const { page, problems, text, shows } = await open(server.address, { width: 1440, height: 790 });
  await waitFor(() => text('stream-state'), /connected/);
  await page.getByRole('tab', { name: 'What if' }).click();
  await shows('what-if', /Go on otherwise[^]*there is no other run/);
  await page.getByTestId('fork').getByTestId('what-if-at').fill('E+1:30');
  await page.getByTestId('fork-go').click();
  await waitFor(async () => String((await server.get('/rehearsals/current')).run), /^2$/);
  await shows('clock-entry', /E\+1:30/);
  assert.equal((await server.get('/runs/2')).state, 'paused');
  await shows('what-if', /run 2 goes on; end it first/);

  await control(server, { inject: { computer_reset: true } });
  await control(server, { pace: 0 });
  await control(server, { pause: false });
  await waitFor(async () => (await server.get('/runs/2')).state, /finished/);
  await page.getByTestId('compare').click();
  await shows('differences', /They part at E\+1:30\.0\. This run: hit the ground too fast; the other: touchdown/);
  await shows('differences-timepoints', /parachute_deploy\s+not in it\s+E\+4:/);
  await shows('differences-channels', /E\+\d:\d\d\.\d/);
  assert.deepEqual(await findings(page, 'dark'), []);

  // In the plots the run that it was forked from stands dashed, by its time from entry, and in a link.
  const plot = page.locator('.panel-plot-altitude .plot');
  const over = async () => Number(await plot.getAttribute('data-over'));
  assert.equal(await over(), 0);
  await page.getByTestId('over-plots').selectOption('1');
  await waitFor(over, (samples) => samples > 100);
  await waitFor(() => page.url(), /[?&]over=1\b/);
  const { page: other, problems: others } = await open(page.url(), { width: 1440, height: 790 });
  const again = other.locator('.panel-plot-altitude .plot');
  await waitFor(
    async () => Number(await again.getAttribute('data-over')),
    (samples) => samples > 100,
  );
  assert.deepEqual(others, []);
  await other.close();
  await page.getByTestId('over-plots').selectOption('0');
  await waitFor(over, (samples) => samples === 0);

  const form = page.getByTestId('forecast');
  await form.getByTestId('what-if-at').fill('E+6:00');
  await form.locator('input.seed').first().fill('2');
  await page.getByTestId('forecast-breaks').check();
  await page.getByTestId('forecast-go').click();
  await shows('what-if', /E\+360\.0 s is after the record of run 2 ends/);
  await form.getByTestId('what-if-at').fill('E+1:00');
  await page.getByTestId('forecast-from').selectOption('telemetry');
  await page.getByTestId('forecast-go').click();
  await waitFor(async () => (await server.get('/runs/2/forecasts/2')).state, /ready/);
  await page.getByTestId('forecasts').getByRole('button', { name: 'show' }).click();
  await shows('forecast-result', /from what ground heard, last at E\+0:\d\d\.\d; assumed: radar A silent/);
  await page.getByTestId('forecast-from').selectOption('truth');
  await page.getByTestId('forecast-go').click();
  await waitFor(async () => (await server.get('/runs/2/forecasts/1')).state, /ready/);
  const byTruth = page.getByTestId('forecasts').getByRole('row').filter({ hasText: 'the truth' });
  await byTruth.getByRole('button', { name: 'show' }).click();
  await shows(
    'forecast-result',
    /from the truth; assumed: radar A silent[^]*landed within limits \(99 % confidence\)\s+2 of 2 \(\d+ … 100 %\)/,
  );
  assert.deepEqual(await findings(page, 'dark'), []);
  assert.deepEqual(
    problems.filter((problem) => !/422 [^]*\/runs\/2\/forecasts/.test(problem)), // the instant that was refused
    [],
  );
  await page.close();
});
