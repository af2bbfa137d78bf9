// SPDX-License-Identifier: Apache-2.0
// A procedure of the shipped library is carried out by keyboard alone, and what was done is seen by others, afterwards
// and in a replay.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { control, findings, focused, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

/** The panel by its key, with what can be done now in focus. */
async function panel(page) {
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('8');
  // the focus moves with the next frame; until then it may still be where the last act left it
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  await waitFor(
    () => page.evaluate(() => document.activeElement?.closest('.procedures') !== null),
    (isIn) => isIn,
  );
}

/** By arrows, then Tab, to the control that fits. */
async function goTo(page, fits, key) {
  for (let presses = 0; presses < 40; ++presses) {
    if (await page.evaluate(fits)) return;
    await page.keyboard.press(key);
  }
  assert.fail(
    `${key} never came to ${fits}; last: ${await page.evaluate(() => document.activeElement?.outerHTML.slice(0, 200))}`,
  );
}

/** Takes another position: in a rehearsal of one. */
async function become(page, words) {
  await panel(page);
  await goTo(page, () => document.activeElement?.closest('.table-tools, .room') !== null, 'ArrowUp');
  await goTo(page, () => document.activeElement?.dataset.testid === 'position-change', 'Tab');
  await page.keyboard.press('Enter');
  await waitFor(() => focused(page), /^position$/);
  await page.keyboard.type(words);
  await page.keyboard.press('Enter');
  await waitFor(() => page.getByTestId('position-change').innerText(), new RegExp(words));
}

/** Presses the act of a step: the panel's key focuses the first that can be done. */
async function does(page, kind, step) {
  await panel(page);
  await goTo(page, `document.activeElement?.matches('[data-step="${step}"] [data-act="${kind}"]')`, 'Tab');
  await page.keyboard.press('Enter');
}

const state = (page, step) => page.locator(`[data-step="${step}"]`).first().getAttribute('data-state');

test('a procedure is begun, its steps check themselves, are signed, released and ticked by key, and its command is sent from its step', async (t) => {
  const server = await serve(t, 'procedures', ['--scenario', 'nominal', '--pace', '10']);
  const { page, problems, text, shows } = await open(server.address, { width: 1440, height: 790 });
  await shows('waiting', /set edl parameters/);
  await waitFor(() => focused(page), /command-line/);
  await page.keyboard.press('8'); // no command begins with a figure: it acts in the empty command line, too
  await waitFor(() => focused(page), /^position$/);
  await page.keyboard.type('Flight');
  await page.keyboard.press('Tab');
  await page.keyboard.type('Ann');
  await page.keyboard.press('Enter');
  await waitFor(() => text('position-change'), /I am Flight director, Ann/);
  await panel(page);
  await goTo(page, () => document.activeElement?.closest('[data-procedure="start"]') !== null, 'ArrowDown');
  await page.keyboard.press('Enter');
  await shows('procedure-head', /under way[^]*begun .* by Ann/);
  await waitFor(() => state(page, 'computer'), /checked/);
  await waitFor(() => state(page, 'not_begun'), /checked/);
  assert.equal(await state(page, 'solution'), 'active', 'a signature is nobody’s but the navigator’s');

  await become(page, 'Navigation');
  await does(page, 'sign', 'solution');
  await waitFor(() => state(page, 'send_parameters'), /held/);
  await become(page, 'Flight director');
  await does(page, 'release', 'send_parameters');
  await waitFor(() => state(page, 'send_parameters'), /active/);
  await shows('under-way', /send parameters: Command/);

  await become(page, 'Command');
  await does(page, 'sent', 'send_parameters');
  await shows('command-purpose', /For step send parameters of Start of entry, descent and landing/);
  await shows('dry-run', /✓ It would be sent as it stands here/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_SET_PARAMETERS is #1/);
  await waitFor(() => state(page, 'send_parameters'), /checked/);

  await become(page, 'GNC');
  await does(page, 'sign', 'held_on_board');
  await waitFor(() => state(page, 'held_on_board'), /checked/);
  await waitFor(() => state(page, 'late_cruise'), /checked/);
  await control(server, { pause: true });
  await page.getByTestId('procedure-history').locator('summary').click();
  await shows('procedure-history', /begin[^]*sign solution[^]*release send parameters[^]*sent send parameters as #1/);
  await page.keyboard.press('Escape');

  // What one does everybody sees, and the past has it as it stood: without what came later, and with nothing to press.
  const { clocks } = (await server.get('/runs')).runs[0];
  const { acts } = await server.get('/runs/1/procedures/1/acts');
  const signed_us = acts.find(({ procedure_act: { kind } }) => kind === 'sign').ert_us;
  const before_e_s = clocks.e_s - (clocks.ert_us - signed_us) / 1e6 - 0.5;
  const other = await open(`${server.address}/?panel=procedures`);
  await waitFor(() => state(other.page, 'late_cruise'), /checked/);
  assert.deepEqual(await findings(other.page, 'dark'), []);
  await other.page.getByTestId('procedures-library').click();
  await other.shows('procedure-library', /UHF lost/);
  assert.deepEqual(await findings(other.page, 'dark'), []);
  await other.page.goto(`${server.address}/?panel=procedures&run=1&past=-1200,${before_e_s}`);
  await other.shows('procedures', /As they stood then; nothing can be done in the past/);
  await waitFor(() => state(other.page, 'solution'), /active/);
  assert.deepEqual(
    [await state(other.page, 'send_parameters'), await other.page.locator('[data-act]').count()],
    ['waiting', 0],
  );

  // Against its conditions a step is ticked with a reason alone: nothing has touched down yet.
  await other.page.goto(`${server.address}/?panel=procedures`);
  await waitFor(() => state(other.page, 'late_cruise'), /checked/);
  await become(page, 'Flight director');
  await panel(page);
  await goTo(page, () => document.activeElement?.closest('.table-tools, .room') !== null, 'ArrowUp');
  await goTo(page, () => document.activeElement?.dataset.testid === 'procedures-library', 'Tab');
  await page.keyboard.press('Enter');
  await page.locator('[data-procedure="day_after"]').waitFor();
  await panel(page);
  await goTo(page, () => document.activeElement?.closest('[data-procedure="day_after"]') !== null, 'ArrowDown');
  await page.keyboard.press('Enter');
  await waitFor(() => state(page, 'touchdown'), /active/);
  await does(page, 'tick', 'touchdown');
  await page.getByTestId('procedure-reason').waitFor();
  await page.keyboard.type('told on the loop');
  await page.keyboard.press('Enter');
  await waitFor(() => state(page, 'touchdown'), /ticked/);
  // the stream brings it to a page that shows another procedure, and asked for them before
  await other.page.getByTestId('procedure-2').click();
  await waitFor(() => state(other.page, 'touchdown'), /ticked/);
  await other.page.locator('[data-step="touchdown"] .step-name').click();
  await other.shows('procedure', /ticked by Ann \(flight director\)[^]*told on the loop/);
  assert.deepEqual(other.problems, []);
  await other.page.close();
  assert.deepEqual(problems, []);
  await page.close();
});
