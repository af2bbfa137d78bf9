// SPDX-License-Identifier: Apache-2.0
// Another mission is followed over a real downlink by its XTCE file alone. Nothing is invented, and nothing is offered
// that does not exist.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { once } from 'node:events';
import { createServer } from 'node:net';
import path from 'node:path';
import { test } from 'node:test';
import { findings, program, temporaryFolder, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

test('a real venue without commands offers none and has a dash for every clock that nobody knows, before a packet has come and after', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const xtce = path.join(folder, 'mission.xml');
  execFileSync(program, ['dictionary', 'export', '--out', xtce]);
  const rehearsal = await serve(t, 'packets', ['--scenario', 'nominal_auto', '--pace', '100']);
  const { packets } = await waitFor(
    () => rehearsal.get('/runs/latest/packets?limit=200'),
    (list) => list.packets?.length === 200,
  );
  await rehearsal.stop();

  const station = createServer();
  station.listen(0, '127.0.0.1');
  await once(station, 'listening');
  t.after(() => station.close());
  const followed = once(station, 'connection');
  const server = await serve(t, 'venue', ['--xtce', xtce, '--downlink', `tcp://127.0.0.1:${station.address().port}`]);
  const [link] = await followed;
  link.on('error', () => undefined);
  t.after(() => link.destroy());
  const { page, problems, text, shows } = await open(server.address);
  await shows('badge', /^LIVE/);
  await shows('waiting', /Nothing has come yet\s+This venue has no commands here\./);
  const clocks = () => Promise.all(['entry', 'scet', 'ert', 'sclk', 'light-time'].map((id) => text(`clock-${id}`)));
  const onEarth = /^\d{4}-\d{3}T\d\d:\d\d:\d\d\.\d$/; // which the ground knows by its own clock
  await shows('clock-ert', onEarth);
  const before = await clocks();
  assert.match(before.splice(2, 1)[0], onEarth);
  assert.deepEqual(before, ['E —', '—', '—', '—']);
  const nothingToSend = async () => {
    await page.keyboard.press('/');
    assert.equal(
      await page
        .locator(
          '[data-testid="command-line"], [data-testid="latest-send"], [data-testid="waiting"] button, [data-testid="guide"]',
        )
        .count(),
      0,
    );
    assert.match(await text('no-commands'), /This venue has no commands here/);
  };
  await nothingToSend();

  for (const { hex } of packets) link.write(Buffer.from(hex, 'hex'));
  await shows('waiting', /Listening\s+This venue has no commands here\./);
  await shows('clock-sclk', /^\d{9}\.\d{3}$/);
  const [entry, ...others] = await clocks();
  assert.match(others[1], onEarth);
  assert.deepEqual([entry, others[0], others[3]], ['E —', '—', '—']);
  assert.doesNotMatch(await text('phases'), /E[+−]\d|predicted/, 'nobody knows when this vehicle enters');
  await nothingToSend();
  for (const theme of ['dark', 'light']) {
    await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
    await waitFor(
      () => findings(page, theme),
      (found) => found.length === 0,
    );
  }
  assert.deepEqual(problems, []);
  await page.close();
});
