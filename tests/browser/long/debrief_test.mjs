// SPDX-License-Identifier: Apache-2.0
// A rehearsal by a plan, with a room that does some of what is expected, and a fork of it: the debrief has all of it,
// on each window and on paper, in both themes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { comesToRest, control, findings, flyTo, untilRun, waitFor, workplace } from '../support.mjs';
import { notWhole } from '../texts.mjs';

const { open, serve } = workplace();

test('a debrief has injects against reactions, missed steps, a fork and the score, on windows and paper', async (t) => {
  const server = await serve(t, 'debrief');
  const post = async (route, body) => {
    const answer = await fetch(`${server.address}/api/v1${route}`, { method: 'POST', body: JSON.stringify(body) });
    const text = await answer.text();
    assert.ok(answer.ok, `${route}: ${answer.status} ${text}`);
    return JSON.parse(text);
  };
  await post('/rehearsals', { scenario: 'nominal_auto', plan: 'station_and_pyro', pace: 1 });
  await flyTo(server, -300);
  await post('/runs/1/procedures', { procedure: 'uhf_lost', position: 'flight_director', by: 'Ann' });
  const act = (given) =>
    post('/runs/1/procedures/1/acts', { position: 'flight_director', by: 'Ann', reason: 'no time for it', ...given });
  await act({ kind: 'choose', step: 'reason', choice: 2 });
  await act({ kind: 'skip', step: 'tones' });
  await flyTo(server, -225);
  await waitFor(
    async () => (await server.get('/runs/1/alarms?state=current')).alarms.map((each) => each.name ?? each.alarm),
    (names) => names.length > 0,
  );
  for (const alarm of ['uhf_live', 'x_band'])
    await post('/runs/1/alarms', { channel: alarm, action: 'acknowledge', by: 'Carl' });
  await post('/runs/1/notes', { text: 'Both links ended at once: the station', by: 'Cleo' });
  await post('/rehearsals/current', { note: { text: 'they talk well', by: 'Ida' } });

  const { page, problems, shows } = await open(`${server.address}/?panel=debrief`, { width: 1440, height: 790 });
  await shows('debrief-not-over', /It has a debrief when it is over/);
  await control(server, { pause: false });
  await control(server, { pace: 0 });
  await untilRun(server, ({ state }) => state === 'finished');
  await post('/rehearsals', { fork: { run: 1, at: 'E-4:30' }, pace: 0 });
  await untilRun(server, ({ run, state }) => Number(run) === 2 && state === 'finished');

  // From the list of runs.
  await page.goto(`${server.address}/?data=rehearsal&run=1`);
  const [debrief] = await Promise.all([
    page.context().waitForEvent('page'),
    page.locator('[data-run="1"]').getByRole('link', { name: 'debrief' }).click(),
  ]);
  assert.equal(new URL(debrief.url()).search, '?panel=debrief&run=1');
  await debrief.close();

  await page.goto(`${server.address}/?panel=debrief&run=1`);
  await shows('debrief-faults', /The station's line fails before entry/);
  const known = (what) => page.locator(`[data-fault="line_down"] [data-known="${what}"]`).innerText();
  assert.match(await known('done'), /E−4:0\d/);
  assert.match(await known('first sign'), /uhf_live|x_band/);
  assert.match(await known('first act after it'), /Carl acknowledge|Cleo wrote/);
  await shows('debrief-timeline', /the instructor did/i);
  const sides = await page
    .locator('.debrief-timeline tbody tr')
    .evaluateAll((rows) => rows.map((row) => `${row.dataset.side}: ${row.innerText.replaceAll(/\s+/g, ' ')}`));
  for (const wanted of [
    /^instructor: .*The station's line fails/,
    /^instructor: .*Ida they talk well/,
    /^received: .*first sign of “The station's line fails/,
    /^room: .*Ann skipped tones of uhf_lost 1: no time for it/,
    /^room: .*Cleo wrote “Both links ended at once/,
  ])
    assert.ok(
      sides.some((row) => wanted.test(row)),
      `${wanted} in\n${sides.join('\n')}`,
    );
  await shows('debrief-procedures', /skipped[^]*tones[^]*no time for it/);
  await shows('debrief-procedures', /under way when the run ended/);
  await waitFor(() => page.locator('[data-fork="2"]').innerText(), /touchdown\s+\d+ of 100/);
  await shows('debrief-sum', /^\d+ of 100$/);

  for (const [width, height] of [
    [1280, 585],
    [1440, 790],
    [2560, 1300],
    [390, 700],
  ]) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    const flaws = (await page.evaluate(notWhole)).filter((line) => /^(debrief|the page is)/.test(line));
    assert.deepEqual(flaws, [], `${width} px wide`);
  }
  await page.setViewportSize({ width: 1440, height: 790 });
  await comesToRest(page);
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('t');
  await comesToRest(page);
  assert.deepEqual(await findings(page, 'light'), []);
  await page.keyboard.press('t');

  // On paper: as wide as A4, all of it, nothing to press.
  await page.setViewportSize({ width: 702, height: 1000 }); // A4 less its margins
  await page.emulateMedia({ media: 'print' });
  await comesToRest(page);
  const paper = await page.evaluate(() => {
    const box = document.querySelector('[data-testid=debrief] .table-scroll');
    return {
      wide: document.documentElement.scrollWidth,
      cut: box.scrollHeight - box.clientHeight,
      pressed: [...document.querySelectorAll('button, input, select')].filter((each) => each.checkVisibility()).length,
    };
  });
  assert.ok(paper.wide <= 702, `${paper.wide} px`);
  assert.ok(paper.cut <= 1, `${paper.cut} px are cut off`);
  assert.equal(paper.pressed, 0);
  const sheets = (await page.pdf({ format: 'A4' })).toString('latin1').match(/\/Type\s*\/Page\b/g).length;
  assert.ok(sheets >= 2, `${sheets} sheets`);
  assert.deepEqual(problems, []);
  await page.close();
});
