// SPDX-License-Identifier: Apache-2.0
// A newcomer lands a spacecraft by the guide alone.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { setPace as pace, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

/** Follows the guide key by key. */
async function obey(page) {
  const presses = await page
    .getByTestId('guide')
    .locator('li')
    .evaluateAll((items) =>
      items.map((item) => ({ type: item.textContent.startsWith('type'), key: item.querySelector('kbd')?.textContent })),
    );
  for (const { type, key } of presses) {
    if (type) await page.keyboard.type(key);
    else if (key) await page.keyboard.press(key === '−' ? '-' : key === 'Esc' ? 'Escape' : key);
    if (key === 'Enter') break; // the rest of the words is an alternative
  }
}

test('whoever only does what the guide says lands it, and once put away the guide stays away', async (t) => {
  const server = await serve(t, 'guide', ['--scenario', 'nominal']);
  const { page, problems, shows } = await open(server.address);
  await shows('guide', /Tell the vehicle where it is/);
  for (const title of [/Tell the vehicle where it is/, /read it/, /Let it begin/, /read it/, /EDL_DO_EDL/]) {
    await shows('guide', title);
    if (title.source === 'read it') await shows('dry-run', /✓ It would be sent/); // there is nothing to read before
    await obey(page);
  }
  await shows('guide', /Nothing to do until entry/);
  await page.keyboard.press('Escape'); // leaves the command line
  await waitFor(
    async () => {
      await obey(page);
      await new Promise((resolve) => setTimeout(resolve, 300));
      return page.getByTestId('pace').inputValue();
    },
    (value) => Number(value) >= 20,
  );
  await pace(page, 100);
  await shows('guide', /Entry[^]*see it happen/);
  await obey(page);
  await shows('guide', /You have landed it/);
  await shows('badge', /touchdown/); // the panels take turns

  await page.keyboard.press('g');
  await waitFor(
    () => page.getByTestId('guide').count(),
    (count) => count === 0,
  );
  await page.reload();
  await shows('waiting', /Touchdown (reported|confirmed)/);
  assert.equal(await page.getByTestId('guide').count(), 0);
  assert.deepEqual(problems, []);
  await page.close();
});
