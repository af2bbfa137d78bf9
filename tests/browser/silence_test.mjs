// SPDX-License-Identifier: Apache-2.0
// What is said while something is not heard: a landing of which only tones come, a replay of what had been heard, a connection that is gone.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { breakable, findings, secondsFromEntry, setPace, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

test('with tones alone the next moment, the phase, the count and the details go on, and each says that it is by tone', {
  timeout: 240_000,
}, async (t) => {
  const server = await serve(t, 'tones_only', ['--scenario', 'tones_only', '--pace', '100']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('waiting', /Waiting for entry interface[^]*■ by tone, the last that was heard of: heartbeat/, 60_000);
  await setPace(page, 20);
  await shows('phase-now', /Entry[^]*■ by tone/, 60_000);
  await waitFor(
    () => text('waiting'),
    /Waiting for parachute deploy[^]*by tone, the last that was heard of: (heartbeat entry|straighten up)/,
    60_000,
  );
  await shows('phase-now', /Parachute[^]*■ by tone/, 60_000);
  await page.keyboard.press('p');
  await shows('badge', /paused/);
  assert.match(await text('waiting'), /Waiting for (heatshield separation|radar processing|engine priming)/);
  const [, all, toned] = /(\d+) of 71 timepoints fired, ■ (\d+) by tone/.exec(await text('timepoints-fired'));
  assert.ok(Number(all) > 20 && all === toned, await text('timepoints-fired'));
  await page.keyboard.press('.');
  await shows('timepoint-detail', /next|waiting for reply/);
  for (let steps = 0; steps < 12 && !/parachute deploy\s/.test(await text('timepoint-detail')); ++steps)
    await page.keyboard.press(',');
  assert.match(await text('timepoint-detail'), /parachute deploy\s+fired, ■ by tone[^]*its tone began\s+E\+04:\d\d/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('Escape');
  if (process.env.AEOLIS_SHOTS) await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/tones_only.png` });
  assert.deepEqual(problems, []);
  await page.close();
});

test('the latest instant to send is that of the next timepoint one can reach, by name, also after the first has fired', {
  timeout: 120_000,
}, async (t) => {
  const server = await serve(t, 'latest', ['--scenario', 'nominal_auto', '--pace', '20']); // each is the next for ten seconds and more
  const { page, problems, text, shows } = await open(server.address);
  await shows('latest-send', /before coolant vent\s+E−13:46, in/);
  await shows('latest-send', /before entry antenna\s+E−10:40, in/, 60_000);
  assert.match(await text('timepoints-fired'), /^[3-9] of/, 'timepoints have fired by then');
  assert.deepEqual(problems, []);
  await page.close();
});

test('a replay shows what had been heard then; with the recording it shows what happened; without a connection neither is taken for live', {
  timeout: 240_000,
}, async (t) => {
  const server = await serve(t, 'heard', ['--scenario', 'nominal_auto', '--pace', '0']);
  const way = await breakable(server.port);
  t.after(() => way.close());
  await waitFor(
    async () => (await server.get('/runs')).runs[0]?.state,
    (state) => state === 'finished',
    60_000,
  );
  const { page, text, shows } = await open(way.address);
  await shows('waiting', /Landed/);
  await shows('stream-state', /connected/);
  await page.keyboard.press('y');
  await page.keyboard.press('p');
  await shows('reading-of-past', /As it was heard then/);
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
  // In the middle of the plasma blackout nothing came by UHF since E+0:43; the recording has all of it.
  await seek(80);
  const altitude = () => page.getByTestId('channel-altitude_m').innerText();
  await waitFor(altitude, /stale, 3\d\.\d s/);
  await waitFor(() => page.getByTestId('channel-descent_rate_mps').innerText(), /\b3\d\.\d s/); // of the same packet
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
  await shows('lost-bar', /NO CONNECTION: nothing new comes/);
  await shows('replay-bar', /REPLAY/);
  assert.deepEqual(await findings(page, 'dark'), []);
  if (process.env.AEOLIS_SHOTS) await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/replay_lost.png` });
  await page.close();
});

test('while nothing comes no link is green and no channel up to date', { timeout: 60_000 }, async (t) => {
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
  for (const link of ['link-UHF live', 'link-X-band']) assert.match(await text(link), /\?[^]*no connection/);
  await waitFor(
    () => page.locator('[data-testid="channel-table"] tr.look-good').count(),
    (rows) => rows === 0,
  );
  await page.close();
});

test('a connection that dies without a word is lost within seconds, and comes back where there is a way', {
  timeout: 120_000,
}, async (t) => {
  const server = await serve(t, 'frozen', ['--scenario', 'nominal_auto', '--pace', '10']);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, problems, text, shows } = await open(way.address);
  const goesOn = async () => {
    await shows('stream-state', /● connected/, 30_000);
    const before = await text('clock-entry');
    await waitFor(
      () => text('clock-entry'),
      (now) => now !== before,
    );
  };
  await goesOn();
  way.freeze();
  await shows('lost-bar', /NO CONNECTION: everything here is old/, 15_000);
  assert.match(await text('stream-state'), /✖ NO CONNECTION/);
  way.thaw();
  await goesOn();
  // What stood is dead, what is new goes through: only the socket can tell.
  way.freeze();
  way.thaw();
  await shows('stream-state', /NO CONNECTION/, 30_000);
  await goesOn();
  await page.keyboard.press('p');
  await shows('badge', /paused/);
  await page.waitForTimeout(12_000); // a run that is paused is silent, and its connection is not lost
  assert.match(await text('stream-state'), /● connected/);
  assert.deepEqual(problems, []);
  await page.close();
});
