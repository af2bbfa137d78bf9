// SPDX-License-Identifier: Apache-2.0
// The display of silences: a replay of the past as heard, and a lost connection.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { breakable, findings, landed, secondsFromEntry, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

test('a replay shows what had been heard then; with the recording it shows what happened; without a connection neither is taken for live', async (t) => {
  const server = await landed(serve, t);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, text, shows } = await open(way.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await shows('stream-state', /connected/);
  await shows('link-Relay', /recording complete/);
  await page.keyboard.press('y');
  await shows('reading-of-past', /As it was heard then/); // and 0.3 s, or two letters are a word
  await page.keyboard.press('p');
  await shows('replay-play', /play/);
  const seek = async (e_s) => {
    await page.getByLabel('where the replay is').evaluate((input, to) => {
      input.value = to;
      input.dispatchEvent(new Event('input', { bubbles: true }));
    }, String(e_s));
    await waitFor(
      async () => secondsFromEntry(await text('clock-entry')),
      (at) => at === e_s,
    );
  };
  // It stands, and says of which stretch it shows which instant.
  await shows('replay-bar', /REPLAY held\. Nothing here is live\./);
  await shows('replay-bar', /at E.\d+:\d\d\s+E−20:00\s+E\+8:\d\d\s+leave/);
  // In the plasma blackout UHF brought nothing after E+0:43; the recording has all of it.
  await seek(80);
  const altitude = () => page.getByTestId('channel-altitude_m').innerText();
  await waitFor(altitude, /stale, 3\d\.\d s/);
  assert.equal(await page.getByTestId('link-Relay').count(), 0, 'nobody had heard of it by then');
  await waitFor(() => page.getByTestId('channel-descent_rate_mps').innerText(), /\b3\d\.\d s/); // from the same packet
  const heard = Number.parseInt(await text('timepoints-fired'), 10);
  assert.equal(await page.locator('[data-event="PEAK_DECELERATION"]').count(), 0, 'only the recording told it');
  await page.keyboard.press('w');
  await shows('reading-of-past', /With the recording/);
  assert.doesNotMatch(await altitude(), /stale/);
  await waitFor(
    () => page.locator('[data-event="BANK_REVERSAL"]').count(),
    (count) => count > 0,
  );
  assert.ok(Number.parseInt(await text('timepoints-fired'), 10) >= heard);
  await page.keyboard.press('w');
  await waitFor(
    () => page.locator('[data-event="BANK_REVERSAL"]').count(),
    (count) => count === 0,
  );

  way.cut();
  await shows('situation-sentence', /NO CONNECTION: nothing new comes/);
  await shows('replay-bar', /REPLAY/);
  assert.deepEqual(await findings(page, 'dark'), []);
  if (process.env.AEOLIS_SHOTS) await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/replay_lost.png` });
  await page.close();
});

test('while nothing comes no link is green and no channel up to date', async (t) => {
  const server = await serve(t, 'silent', ['--scenario', 'nominal_auto', '--pace', '10']);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, text, shows } = await open(way.address);
  await shows('link-X-band', /●/);
  await waitFor(
    () => page.locator('[data-testid="channel-table"] tr.look-good').count(),
    (rows) => rows > 10,
  );
  way.cut();
  await shows('stream-state', /NO CONNECTION/);
  for (const link of ['link-UHF', 'link-X-band']) assert.match(await text(link), /\?[^]*not known/);
  await waitFor(
    () => page.locator('[data-testid="channel-table"] tr.look-good').count(),
    (rows) => rows === 0,
  );
  await page.close();
});
