// SPDX-License-Identifier: Apache-2.0
// A newcomer types the words that stand in quotes, without a key before them: they go where they belong, and nothing
// opens by accident.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { focused, stageLook, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();
const SLOWLY_MS = 450; // a newcomer who looks for each key

test('words typed without “/” go into the command line, fire no shortcut, and a refused preview is not sent by Enter', async (t) => {
  const server = await serve(t, 'first_keys', ['--scenario', 'nominal']);
  const { page, problems, text, shows } = await open(server.address);
  const line = () => page.getByTestId('command-line').inputValue();
  const nothingOpened = async () => {
    assert.equal(await page.locator('.tabs [aria-selected=true]').getAttribute('data-testid'), 'tab-channels');
    assert.equal(await page.getByTestId('help').count(), 0);
    assert.equal(await page.getByTestId('guide').count(), 1);
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
    assert.doesNotMatch(await text('badge'), /paused/);
  };
  await shows('waiting', /Type “set edl parameters”/);
  await waitFor(() => focused(page), /command-line/);
  assert.doesNotMatch(await text('waiting'), /Open the command line/, 'what is done is not asked for');

  // What comes too early says why in words, and asks for no key that would be refused.
  await page.keyboard.type('do edl');
  await page.keyboard.press('Enter');
  await shows('dry-run', /✖ It would be refused: [^]*parameters received: must be yes, is no/);
  for (const part of ['dry-run', 'guide']) assert.doesNotMatch(await text(part), /\bEnter\b/, part);
  await page.keyboard.press('Escape');
  await page.keyboard.press('Control+A');

  // Typed with the quotes that stand around them, without a key before.
  await page.keyboard.type('"set edl parameters"', { delay: SLOWLY_MS });
  assert.equal(await line(), '"set edl parameters"');
  await nothingOpened();
  await page.keyboard.press('Enter');
  await shows('waiting', /Read it, then press Enter/);
  await shows('dry-run', /✓ It would be sent/);

  await page.getByTestId('release-at').fill('2011-001T00:00:00');
  await shows('dry-run', /✖ It would be refused/);
  await page.getByTestId('release-at').press('Enter');
  await shows('command-message', /nothing was sent: release_at/);
  assert.deepEqual((await server.get('/runs/latest/commands')).commands ?? [], []);
  await page.getByTestId('release-at').fill('');
  await shows('dry-run', /✓ It would be sent/);
  await page.getByTestId('release-at').press('Enter');
  await shows('command-message', /EDL_SET_PARAMETERS is #1/);
  await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/);
  await shows('waiting', /Type “do edl”/);
  await page.keyboard.type('do edl', { delay: SLOWLY_MS });
  await page.keyboard.press('Enter');
  await shows('dry-run', /✓ It would be sent once it is armed/);
  await page.keyboard.press('Enter');
  await shows('waiting', /Type EDL_DO_EDL and press Enter/);
  await page.keyboard.type('EDL_DO_EDL', { delay: 50 });
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_DO_EDL is #2/);

  // Elsewhere on the page: a word goes into the line, a letter that stays alone acts.
  await page.keyboard.press('Escape');
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.type('landing', { delay: 150 });
  assert.equal(await line(), 'landing');
  await nothingOpened();
  await page.keyboard.press('Escape');
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('l');
  await waitFor(() => page.getByTestId('tab-links').getAttribute('aria-selected'), /true/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('timepoints are given by name, and a number is shown with its name', async (t) => {
  const server = await serve(t, 'names', ['--scenario', 'nominal_light_time']);
  const { page, problems, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);
  const { timepoints } = await server.get('/runs/latest/timepoints');
  const { id } = timepoints.find((row) => row.name === 'heatshield_separation');
  await page.keyboard.press('/');
  await page.keyboard.type(`edl_set_timepoint_offset timepoint=${id} desired_offset_s=12 minimum_offset_s=0`);
  await page.keyboard.press('Enter');
  await shows('command-review', /heatshield separation/);
  await page.keyboard.press('/');
  await page.keyboard.press('Control+A');
  await page.keyboard.type('edl_set_timepoint_offset timepoint=heatsh');
  await shows('argument-offers', /timepoint=heatshield_separation/);
  await page.keyboard.press('Tab');
  await page.keyboard.type(' desired_offset_s=12 minimum_offset_s=0');
  await page.keyboard.press('Enter');
  await shows('effect', /It would move \d+ timepoints, by at most 12\.0 s/);
  assert.deepEqual(problems, []);
  await page.close();
});
