// SPDX-License-Identifier: Apache-2.0
// A newcomer lands a spacecraft with the keyboard alone, reloads, and asks for a recorded range.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { comesToRest, flyTo, focused, setPace as pace, stageLook as stage, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

/** In the page of an ended run: rows of the header, ways on that are beyond their card, and how its map is drawn. */
function endOnLaptop() {
  const tops = ['badge', 'stream-state'].map((id) =>
    document.querySelector(`[data-testid="${id}"]`).getBoundingClientRect(),
  );
  const card = document.querySelector('.touchdown-box').getBoundingClientRect();
  const beyond = [...document.querySelectorAll('.touchdown-links > *')]
    .filter((each) => each.getBoundingClientRect().bottom > card.bottom + 1)
    .map((each) => each.innerText);
  const map = document.querySelector('.touchdown-map');
  return {
    rows: tops[1].top < tops[0].bottom ? 1 : 2,
    beyond,
    filled: getComputedStyle(map.querySelector('[data-testid="ellipse"]')).fill,
    target: getComputedStyle(map.querySelector('.path-target')).stroke !== 'none',
  };
}

test('two commands by keyboard land it; a reload has all of it; a range can be asked for', async (t) => {
  const server = await serve(t, 'landing', ['--scenario', 'nominal']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('badge', /REHEARSAL.*nominal/s);
  await shows('waiting', /set edl parameters/);

  await page.keyboard.press('/');
  await page.keyboard.type('set edl parameters');
  await page.keyboard.press('Enter');
  await shows('command-review', /filled from ground/);
  await shows('dry-run', /✓ It would be sent as it stands here/);
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_SET_PARAMETERS is #1/);
  await waitFor(() => stage(page, 'EDL_SET_PARAMETERS', 'executed'), /ok/);
  await waitFor(() => stage(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/); // flight reports its parameters every 8 s
  await shows('waiting', /ype “do edl”/);
  await shows('command-history', /EDL_SET_PARAMETERS #1/);
  await shows('tone-evidence', /tones have not begun: X-band sends telemetry until E−12:30/);
  await shows('link-X-band telemetry', /●/);

  await waitFor(() => focused(page), /command-line/);
  await page.keyboard.type('do edl');
  await page.keyboard.press('Enter');
  await shows(
    'command-review',
    /✓ It would be sent[^]*arms it; nothing is sent yet[^]*✓ parameters received: yes, as it must be/,
  );
  await page.keyboard.press('Enter');
  await shows('command-armed', /ARMED/);
  await waitFor(() => focused(page), /command-confirmation/);
  await page.keyboard.press('Enter');
  await shows('command-message', /nothing was sent/);
  await page.keyboard.type('EDL_DO_EDL');
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_DO_EDL is #2/);
  await page.keyboard.press('Escape');

  await pace(page, 100);
  await shows('waiting', /Next: (pyros armed vent|coolant vent)/);
  // The sentence has the name already, so that both have room at the size that is read at 3 m.
  const countdown = page.getByTestId('situation-countdown');
  await waitFor(
    () => countdown.evaluate((each) => `${getComputedStyle(each).fontSize} ${each.innerText}`),
    /^54px (in ≈ \d|is due)/,
  );
  await shows('timepoints-fired', /^[1-9]/);
  await flyTo(server, 266);
  await shows('badge', /paused/);
  await shows('pause', /go on/);
  await shows('phases', /Parachute/);
  assert.match(await text('tone-title'), /Tone \d+ · \S/);
  assert.match(await text('reading-altitude'), /\d/);
  // Reported by the vehicle's word; confirmed once the rover's own IMU is still and UHF has come for ten seconds.
  await flyTo(server, 441);
  const verdict = () => page.getByTestId('touchdown').getAttribute('data-verdict');
  await waitFor(verdict, /^reported$/);
  await shows('touchdown', /Touchdown reported\s+E\+7:1\d\.\d, 1 of 3 signals/);
  await flyTo(server, 455);
  await waitFor(verdict, /^confirmed$/);
  await shows('touchdown', /Touchdown confirmed\s+E\+7:1\d\.\d, 3 of 3 signals/);
  await shows('touchdown-steps', /rover's own IMU still for 10 s/);
  await pace(page, 100); // before it goes on: what is left takes a second
  await page.keyboard.press('p');

  await waitFor(
    () => page.locator('[data-event="TOUCHDOWN"]').count(),
    (count) => count === 1,
  );
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await shows('badge', /ENDED RUN.*touchdown/s);
  // The end of the run may be reported before its last items: the page is complete once it has all items of the server
  // and neither count grows.
  let before;
  await waitFor(
    async () => {
      const [{ last_seq: last }] = (await server.get('/runs')).runs;
      const through = (await text('complete-through')).replace(/\D/g, '');
      const settled = through === last && through === before;
      before = through;
      await new Promise((resolve) => setTimeout(resolve, 300));
      return settled;
    },
    (settled) => settled === true,
  );
  // On a laptop the end has one row of the header, all of its card and the ways on in sight, and no phase goes on.
  await page.setViewportSize({ width: 1440, height: 790 });
  await comesToRest(page);
  assert.match(await text('phase-now'), /✓ Touchdown/);
  assert.deepEqual(await page.evaluate(endOnLaptop), { rows: 1, beyond: [], filled: 'none', target: true });
  await page.setViewportSize({ width: 1920, height: 1080 });
  const seen = {
    fired: await text('timepoints-fired'),
    through: await text('complete-through'),
    tone: await text('tone-title'),
    stages: await stage(page, 'EDL_DO_EDL', 'executed'),
  };

  await page.reload();
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await waitFor(
    () => text('timepoints-fired'),
    (value) => value === seen.fired,
  );
  await waitFor(
    () => text('complete-through'),
    (value) => value === seen.through,
  );
  await waitFor(() => text('reading-altitude'), /\d/);
  await waitFor(
    () => text('tone-title'),
    (value) => value === seen.tone,
  );
  assert.equal(await stage(page, 'EDL_DO_EDL', 'executed'), seen.stages);
  assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 1);

  await page.keyboard.press('r');
  await waitFor(() => focused(page), /range-from/);
  await page.keyboard.press('Control+A');
  await page.keyboard.type('E+4:10');
  await page.keyboard.press('Tab');
  await page.keyboard.type('E+5:00');
  await page.keyboard.press('Enter');
  await shows('range-message', /✓ [1-9]\d* samples of 4 channels/);
  await shows('badge', /PAST, NOT LIVE/);
  assert.match(await text('past-bar'), /Nothing here is live/);
  assert.match(await text('recording-summary'), /✓ Every live packet is in the recording/);
  assert.equal(await text('clock-entry'), 'E+5:00');
  assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 0, 'an event after the range is shown');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await shows('badge', /ENDED RUN/);
  assert.deepEqual(problems, []);
  await page.close();
});
