// SPDX-License-Identifier: Apache-2.0
// An instructor injects a fault into a rehearsal and writes a note. Afterwards the review has both, with facts, and a
// score that is the sum of its terms.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { control, findings, flyTo, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

test('an instructor’s fault and note are folded away while a rehearsal goes on, and stand in its review with a score that can be checked', async (t) => {
  const server = await serve(t, 'rehearsal', ['--scenario', 'nominal_auto', '--pace', '10']);
  await flyTo(server, -1150); // the scenario has sent its own two commands
  await control(server, { pace: 1 });
  await control(server, { pause: false });
  const { page, problems, text, shows } = await open(server.address, { width: 1600, height: 900 });
  await waitFor(() => text('stream-state'), /connected/);
  await page.keyboard.press('s');
  await shows('instructor', /Instructor: break something/);
  assert.equal(await page.getByTestId('faults').count(), 0, 'folded away');
  await page.locator('[data-testid="instructor"] > summary').click();
  await shows('instructor', /no accounts: whoever opens this fold can read it/);

  await page.getByTestId('fault-what').selectOption('DEVICE_RADAR');
  await page.getByTestId('fault-unit').selectOption('B'); // a unit not in use, so that the landing does not fail
  await page.getByTestId('fault-inject').click();
  await shows('instructor-message', /injected/);
  await page.getByTestId('signature').fill('Ida');
  await page.getByTestId('instructor-note').fill('do they see <b>it</b>?');
  await page.keyboard.press('Enter');
  await shows('instructor-message', /kept for the review/);
  await shows(
    'interventions',
    /E−\d+:\d\d\.\d ▲ radar B silent, for 10 s\s+E−\d+:\d\d\.\d Ida do they see <b>it<\/b>\?/,
  );
  assert.deepEqual(await findings(page, 'dark'), []);
  assert.deepEqual((await server.get('/runs/latest/notes')).notes, [], 'not in the shift log');

  await fetch(`${server.address}/api/v1/runs/latest/notes`, {
    method: 'POST',
    body: JSON.stringify({ text: 'radar B?', by: 'Bob' }),
  });
  assert.equal(
    (
      await fetch(`${server.address}/api/v1/runs/latest/commands`, {
        method: 'POST',
        body: JSON.stringify({ command: 'NO_OP', controller: 'Bob' }),
      })
    ).status,
    202,
  );
  await control(server, { pace: 0 });
  await shows('review', /Review of run 1/);
  await page.locator('[data-testid="review"] > summary').click();
  await shows('review-facts', /landing\s+E\+7:\d\d\.\d\s+touchdown/);
  const facts = await text('review-facts');
  assert.match(facts, /Touchdown: descending \d\.\d m\/s/);
  assert.match(facts, /\d+\.\d km from the target, by the vehicle's own navigation/);
  const timepoints = [...facts.matchAll(/(\d+) of (\d+)/g)].map(([, fired, all]) => [Number(fired), Number(all)]);
  assert.ok(
    timepoints.some(([fired, all]) => all > 45 && all - fired <= 1),
    facts,
  );
  assert.match(facts, /packets heard live: 0 missing in the recording, 0 differ/);
  assert.match(facts, /radar B silent, for 10 s; nothing that was received showed it/); // it is not in use
  assert.match(
    facts,
    /1 command of people: 1 carried out, 0 failed, 0 cancelled, 0 not known\s+2 commands of the scenario's script: 2 carried out/,
  );
  assert.match(await text('review-terms'), /landing\s+30\.0 of 30/);
  assert.match(await text('review-terms'), /after touchdown: writes of “touchdown” or “landed”[^]*nobody did/);
  assert.match(await text('review'), /The instructor wrote\s+E−\d+:\d\d\.\d Ida do they see <b>it<\/b>\?/);

  const terms = (await page.locator('[data-testid="review-terms"] .number').allInnerTexts()).map((each) =>
    each.split(' of ').map(Number),
  );
  const [earned, most] = terms.reduce(([a, b], [c, d]) => [a + c, b + d], [0, 0]);
  const said = Number(/(\d+) of 100/.exec(await text('review-score'))[1]);
  assert.ok(terms.length >= 2 && Math.abs(said - (100 * earned) / most) <= 1, `${said} of ${JSON.stringify(terms)}`);

  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.getByTestId('review-copy').click();
  await shows('review', /✓ copied/);
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.match(
    copied,
    /^Aeolis, review of run 1: nominal_auto, seed 1[^]*instructor's note: E−\d+:\d\d\.\d Ida: do they see <b>it<\/b>\?[^]*score: \d+ of 100/,
  );
  for (const theme of ['dark', 'light']) {
    await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
    await waitFor(
      () => findings(page, theme),
      (found) => found.length === 0,
    );
  }
  assert.deepEqual(problems, []);
});
