// SPDX-License-Identifier: Apache-2.0
// The display of silences: a landing heard by tones only, a next timepoint that can no longer be reached, a connection
// that dies.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { breakable, control, findings, flyTo, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

test('with tones alone the next moment, the phase, the count and the details go on, and each says that it is by tone', async (t) => {
  const server = await serve(t, 'tones_only', ['--scenario', 'tones_only']);
  const { page, problems, text, shows } = await open(server.address);
  await flyTo(server, -60);
  await shows('waiting', /Next: entry interface[^]*■ by tone, the last that was heard of: wait for guidance/);
  await flyTo(server, 258);
  await shows('phase-now', /Entry[^]*■ by tone/);
  await waitFor(
    () => text('waiting'),
    /Waiting for parachute deploy[^]*by tone, the last that was heard of: (entry guidance|straighten up|balance)/,
  );
  await flyTo(server, 290);
  await shows('phase-now', /Parachute[^]*■ by tone/);
  await shows('badge', /paused/);
  assert.match(await text('waiting'), /Waiting for (heatshield separation|radar processing|engine priming)/);
  const [, all, toned] = /(\d+) of \d+ timepoints fired, ■ (\d+) by tone/.exec(await text('timepoints-fired'));
  // What fired before X-band went over to tones was told by its telemetry.
  assert.ok(Number(toned) > 12 && Number(all) > Number(toned), await text('timepoints-fired'));
  await page.keyboard.press('.');
  await shows('timepoint-detail', /next|waiting for reply/);
  const opened = async () => (await text('timepoint-detail')).split('\n')[0];
  for (let steps = 0, now = await opened(); steps < 12 && !/^parachute deploy /.test(now); ++steps) {
    await page.keyboard.press(',');
    const before = now;
    now = await waitFor(opened, (title) => title !== before);
  }
  await shows(
    'timepoint-detail',
    /^parachute deploy\s+fired, ■ by tone[^]*heard by tone\s+its beginning E\+4:\d\d[^]*posterior/,
  );
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('Escape');
  if (process.env.AEOLIS_SHOTS) await page.screenshot({ path: `${process.env.AEOLIS_SHOTS}/tones_only.png` });
  assert.deepEqual(problems, []);
  await page.close();
});

test('the latest instant to send is that of the next timepoint one can reach, by name, also after the first has fired', async (t) => {
  const server = await serve(t, 'latest', ['--scenario', 'nominal_auto']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('latest-send', /before “pyros armed vent”\s+E−13:48, in/);
  await flyTo(server, -700);
  await shows('latest-send', /before “entry antenna”\s+E−10:40, in/);
  assert.match(await text('timepoints-fired'), /^[3-9] of/, 'timepoints have fired by then');
  assert.deepEqual(problems, []);
  await page.close();
});

test('a connection that dies without a word is lost within seconds, and comes back where there is a way', async (t) => {
  const server = await serve(t, 'frozen', ['--scenario', 'nominal_auto', '--pace', '10']);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, problems, text, shows } = await open(way.address);
  const goesOn = async () => {
    await shows('stream-state', /● connected/);
    const before = await text('clock-entry');
    await waitFor(
      () => text('clock-entry'),
      (now) => now !== before,
    );
  };
  await goesOn();
  way.freeze();
  await shows('situation-sentence', /NO CONNECTION: everything here is old/);
  assert.match(await text('stream-state'), /✖ NO CONNECTION/);
  way.thaw();
  await goesOn();
  // The old connection is dead, new ones pass: only the socket can tell.
  way.freeze();
  way.thaw();
  await shows('stream-state', /NO CONNECTION/);
  await goesOn();
  await control(server, { pause: true });
  await shows('badge', /paused/);
  await page.waitForTimeout(12_000); // a paused run is silent, and its connection is not lost
  assert.match(await text('stream-state'), /● connected/);
  assert.deepEqual(problems, []);
  await page.close();
});
