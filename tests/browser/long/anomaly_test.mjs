// SPDX-License-Identifier: Apache-2.0
// An anomaly report by one key, in a rehearsal with a fault: it takes what is on the screen, is sent with a cause, and
// stands in the shift log. In a past view it is of that past.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { comesToRest, control, findings, flyTo, focused, waitFor, workplace } from '../support.mjs';
import { keepWhatIsWritten, notWhole } from '../texts.mjs';

const { open, serve } = workplace();
const SIZES = [
  [1280, 585],
  [1920, 1080],
  [390, 700],
];
const FAULT = {
  device: 'DEVICE_IMU',
  unit: 'REDUNDANT_UNIT_A',
  kind: 'DEVICE_FAULT_KIND_SILENT',
  duration_s: 300,
};

/** What of the open report cannot be read, at each size in both themes. */
async function flawsOf(page) {
  const flaws = [];
  for (const theme of ['dark', 'light']) {
    await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
    for (const [width, height] of SIZES) {
      await page.setViewportSize({ width, height });
      await comesToRest(page);
      const found = [...(await page.evaluate(notWhole)), ...(await findings(page, theme))];
      flaws.push(...found.map((words) => `${theme}, ${width} × ${height}: ${words}`));
      const box = await page.getByTestId('report').boundingBox();
      const banner = await page.getByTestId('situation').boundingBox();
      if (box.y < banner.y + banner.height) flaws.push(`${theme}, ${width} × ${height}: it covers the banner`);
      if (process.env.AEOLIS_SHOTS)
        await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/anomaly_${theme}_${width}.png` });
    }
  }
  await page.evaluate(() => (document.documentElement.dataset.theme = 'dark'));
  await page.setViewportSize({ width: 1280, height: 585 });
  return flaws;
}

test('a report of a silent inertial unit has the alarms, links and values of its instant, and stands in the shift log', async (t) => {
  const server = await serve(t, 'anomaly', ['--scenario', 'nominal_auto', '--pace', '10']);
  await flyTo(server, 20);
  await control(server, { inject: { device_fault: FAULT } });
  await flyTo(server, 110);
  const alarms = async () => (await server.get('/runs/latest/alarms?state=current')).alarms ?? [];
  const raised = await waitFor(alarms, (all) => all.length > 0);
  const { clocks } = (await server.get('/runs')).runs[0];

  const { page, problems, text, shows } = await open(server.address, { width: 1280, height: 585 }, keepWhatIsWritten);
  await shows('stream-state', /connected/);
  await shows('alarms-waiting', new RegExp(`^${raised.length} to acknowledge`)); // the ground's list has come
  await shows('channel-altitude_m', /\d/);
  await shows('channel-descent_rate_mps', /\d/);
  await page.keyboard.press('!');
  await waitFor(() => focused(page), /report-cause/);

  const lines = (await page.getByTestId('report-text').inputValue()).split('\n');
  const all = lines.join('\n');
  assert.equal(
    lines[0],
    `At ${await text('report').then((of) => /E\+1:5\d\.\d/.exec(of)[0])}, on Earth (ERT) ${clocks.ert.slice(0, 19)}, SCLK ${clocks.seen_sclk.toFixed(3)}`,
  );
  assert.match(lines[1], /^REHEARSAL: nominal_auto · run 1 · paused$/);
  assert.ok(lines[2].startsWith(`Banner: ${await text('situation-sentence')}`), lines[2]);
  assert.match(lines[2], /\(evidence: .*E\+\d:\d\d\)$/);
  for (const { name, limit } of raised)
    assert.ok(
      lines.some((line) => line.startsWith(`- ${name}: `) && line.includes(limit) && /not acknowledged$/.test(line)),
      `${name}, ${limit}: ${all}`,
    );
  assert.match(all, /\n- UHF: up since E\+\d:\d\d\n/);
  const told = (await page.getByTestId('channel-altitude_m').locator('td.value').innerText()).trim();
  assert.match(all, new RegExp(`\n- altitude_m: ${told} m, `));

  await page.keyboard.type('is unit A silent? n, ! and m');
  await shows('report-first', /^Anomaly report: is unit A silent\? n, ! and m$/);
  assert.equal(await page.getByTestId('notes').count(), 0, 'no letter was a shortcut');
  assert.deepEqual(await flawsOf(page), []);

  await page.keyboard.press('Control+Enter');
  await shows('report-problem', /A name is wanted/);
  await waitFor(() => focused(page), /signature/);
  await page.keyboard.type('Ann');
  await page.keyboard.press('Control+Enter');
  await shows('report-kept', /✓ The anomaly report is in the shift log/);
  const { notes } = await server.get('/runs/latest/notes');
  assert.equal(notes.length, 1);
  assert.equal(notes[0].note.by, 'Ann');
  assert.equal(notes[0].note.sclk, clocks.seen_sclk);
  assert.equal(notes[0].note.text, `Anomaly report: is unit A silent? n, ! and m\n${all}`);

  await page.keyboard.press('n');
  await shows('note-list', /Ann on E\+1:5\d\s+▸?\s*Anomaly report: is unit A silent\? n, ! and m \+\d+ lines\s*$/);
  await page.locator('[data-testid="note-list"] summary').click();
  await shows('note-list', /\+\d+ lines\s+At E\+1:5\d\.\d/);
  assert.deepEqual(await findings(page, 'dark'), []);
  if (process.env.AEOLIS_SHOTS) await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/anomaly_notes.png` });

  // a past: from before the fault, when none of its alarms was raised
  await page.goto(`${server.address}/?past=-60,0&with=recording`);
  await shows('badge', /PAST, NOT LIVE/);
  await shows('stream-state', /connected/);
  await shows('channel-altitude_m', /\d/);
  await page.keyboard.press('!');
  await shows('report-first', /^Anomaly report: cause not known \(PAST, NOT LIVE: E[+−]0:00\.0, with the recording\)$/);
  const past = await page.getByTestId('report-text').inputValue();
  assert.match(
    past,
    /^At E[+−]0:00\.0, [^]*\nAlarms: none is raised\n[^]*\n- UHF: [^]*\nValues in view: [1-9][^]*\n- altitude_m: \d/,
  );
  for (const { name } of raised) assert.doesNotMatch(past, new RegExp(`- ${name}: (?!.* old)`));
  if (process.env.AEOLIS_SHOTS) await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/anomaly_past.png` });
  await page.keyboard.press('Escape');
  assert.equal(await page.getByTestId('report').count(), 0, 'nothing was typed: nothing is asked');
  await shows('badge', /PAST, NOT LIVE/);
  assert.deepEqual(
    problems.filter((problem) => !/status of 422/.test(problem)),
    [],
  );
  await page.close();
});
