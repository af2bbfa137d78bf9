// SPDX-License-Identifier: Apache-2.0
// A campaign from the console by keyboard: started, watched, cancelled, continued; and its effect on a running landing.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { findings, focused, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

const BUSY_MS = 600_000; // cases fly with the processor time that is left

test('a campaign is started by keyboard, its dots come one after the other, it is cancelled and gone on with', async (t) => {
  const server = await serve(t, 'campaigns', ['--scenario', 'nominal']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('badge', /REHEARSAL/);
  await waitFor(() => focused(page), /command-line/); // of a run that waits for its first command
  await page.keyboard.press('Escape');
  await page.keyboard.press('d');
  await waitFor(() => focused(page), /campaign-scenario/);
  await page.getByTestId('campaign-scenario').selectOption('gnc_alone');
  await page.keyboard.press('Tab');
  await page.keyboard.press('Control+a');
  await page.keyboard.type('10001');
  await shows('campaigns', /✖ cases: a whole number from 1 to 10000/);
  assert.ok(await page.getByTestId('campaign-start').isDisabled());
  await page.keyboard.press('Control+a');
  await page.keyboard.type('5000');
  await page.keyboard.press('Enter');
  await shows('campaign-message', /gnc_alone-1 has begun/);
  const kept = async () => Number(/(\d+) of 5000/.exec(await text('campaign-state'))?.[1]);
  const drawn = async () =>
    Number(/^(\d+) touchdowns/.exec(await page.getByTestId('campaign-picture').getAttribute('aria-label'))[1]);
  await waitFor(kept, (count) => count >= 2, BUSY_MS);
  const before = await drawn();
  await waitFor(drawn, (count) => count > before && count >= 3, BUSY_MS);
  await shows('campaign-ellipse', /km, major axis at azimuth/);
  await shows('campaign-state', /▶ \d+ of 5000 cases, [\d.]+ a second, .* remain/);
  assert.deepEqual(await findings(page, 'dark'), []);

  // The landing goes on beside it.
  await shows('stream-state', /connected/);
  const clock = await text('clock-entry');
  await waitFor(
    () => text('clock-entry'),
    (now) => now !== clock,
  );

  await page.getByTestId('campaign-cancel').focus();
  await page.keyboard.press('Enter');
  await page.keyboard.press('Enter'); // a second press must not request it again
  await shows('campaign-message', /cancelled: \d+ cases of gnc_alone-1 are kept/);
  await shows('campaign-state', /not complete; starting it again goes on/);
  const left = await kept();
  await waitFor(drawn, (count) => count === left); // each kept case is drawn once
  const { state } = await server.get('/campaigns/gnc_alone-1');
  assert.equal(state.kept, left);

  await page.getByTestId('campaign-cases').fill(String(left + 3));
  await page.getByTestId('campaign-cases').press('Enter');
  await shows('campaign-message', new RegExp(`goes on; ${left} cases had been kept`));
  await shows('campaign-state', new RegExp(`all ${left + 3} cases are kept`), BUSY_MS);
  await waitFor(drawn, (count) => count === left + 3);
  assert.deepEqual(problems, []);
  await page.close();
});
