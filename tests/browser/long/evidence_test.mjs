// SPDX-License-Identifier: Apache-2.0
// The evidence behind a value: live against recorded octet by octet, the fields of a packet, the state at an instant.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { standIn } from '../stand_in.mjs';
import { findings, focused, landed, secondsFromEntry, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
});

test('live is proven against the recording, by packet and by link, and a packet that differs has its octets marked', async () => {
  const { page, problems, text, shows } = await open(server.address);
  await shows('badge', /ENDED RUN/);
  await page.keyboard.press('v');
  const { streams, tones } = await server.get('/runs/latest/proof');
  const live = streams.reduce((sum, row) => sum + Number(row.realtime), 0);
  await waitFor(
    async () => (await text('verdict-sentence')).replaceAll(/\D/g, ''),
    (digits) => digits === String(live),
  );
  assert.match(await text('verdict-sentence'), /✓ All .* bit for bit/);
  const shown = await page.locator('[data-testid="verdicts-by-packet"] tbody tr').count();
  assert.equal(shown, streams.length + 1);
  const identical = tones.filter((tone) => tone.verdict === 'identical').length;
  assert.match(await text('tone-verdicts'), new RegExp(`\\b${identical} identical`));
  await shows('verdict-count', /^none$/);

  // No landing of ours has a packet that differs, so the server's answer is altered on its way.
  await page.route('**/packets?verdict=never_seen_live*', async (route) => {
    const answer = await (await route.fetch()).json();
    const [packet] = answer.packets;
    packet.verdict = 'differs';
    packet.other_hex = packet.hex.slice(0, -2) + (packet.hex.endsWith('00') ? 'ff' : '00');
    await route.fulfill({ json: answer });
  });
  await page.getByTestId('verdict-choice').selectOption('never_seen_live');
  await page.getByTestId('verdict-packets').getByRole('button').first().click();
  await shows('difference', /1 of \d+ octets differ/);
  assert.equal(await page.getByTestId('difference').locator('mark').count(), 2, 'the octet is marked on both sides');
  await page.keyboard.press('Escape');

  await page.getByTestId('tab-links').click();
  await waitFor(() => page.getByTestId('link-row-uhf_live').innerText(), /UHF[^]*%/);
  assert.deepEqual(
    problems.filter((problem) => !/favicon/.test(problem)),
    [],
  );
  await page.close();
});

test('a packet is read by keyboard: its fields light their octets, an octet lights its fields, and a packet can be chosen alone', async () => {
  const { page, problems, text, shows } = await open(`${server.address}/?panel=packets`);
  await shows('badge', /ENDED RUN/);
  const { streams } = await server.get('/runs/latest/proof');
  const live = streams
    .filter((row) => Number(row.realtime) > 0)
    .map((row) => row.name)
    .sort();
  // What the ground measures itself (APID 0x7e0 to 0x7ef) is shown too, and there is nothing to prove it by.
  const ofTheVehicle = page.locator('[data-testid="packet-streams"] tbody tr').filter({ hasNotText: /^0x7e/ });
  await waitFor(
    async () => (await ofTheVehicle.locator('button').allInnerTexts()).sort().join(),
    (names) => names === live.join(),
  );
  await page.getByRole('button', { name: 'GncNavigation', exact: true }).focus();
  await page.keyboard.press('Enter');
  await waitFor(
    async () => new Set(await page.locator('[data-testid="packet-table"] tbody tr td:nth-child(4)').allInnerTexts()),
    (names) => names.size === 1 && names.has('GncNavigation'),
  );
  await waitFor(
    () => focused(page),
    (id) => id === 'packet-rows',
  );
  await page.keyboard.press('ArrowDown');
  await shows('packet', /GncNavigation over [^]*octets/);
  const first = await text('packet');
  await page.keyboard.press('ArrowDown');
  await waitFor(
    () => text('packet'),
    (now) => now !== first,
  );

  const unit = /packet (\d+)/.exec(await text('packet'))[1];
  const { packets } = await server.get(`/runs/latest/packets?name=GncNavigation&limit=1000`);
  const packet = packets.find((each) => each.unit.unit === unit);
  const shown = (await page.locator('[data-octet]').allInnerTexts()).join('');
  if (packet) assert.equal(shown, packet.hex);
  const litOctets = () =>
    page.locator('[data-octet].lit').evaluateAll((all) => all.map((each) => Number(each.dataset.octet)));
  const litFields = () => page.locator('[data-field].lit').evaluateAll((all) => all.map((each) => each.dataset.field));

  await page.getByTestId('packet-fields').focus();
  for (let field = 0; field < 4; ++field) await page.keyboard.press('ArrowDown');
  const [name] = await litFields();
  const octets = await litOctets();
  assert.ok(octets.length > 0, `${name} lights no octet`);
  await shows('packet-place', new RegExp(`${name}: (bits? [^]* of )?octets? ${octets[0]}`));
  await page.locator(`[data-octet="${octets[0]}"]`).hover();
  await waitFor(litFields, (fields) => fields.includes(name));
  await page.getByTestId('packet-fields').focus();
  await page.keyboard.press('Escape');
  await waitFor(
    () => page.getByTestId('packet').count(),
    (count) => count === 0,
  );
  await waitFor(
    () => focused(page),
    (id) => id === 'packet-rows',
  );
  assert.deepEqual(problems, []);
  await page.close();
});

test('the cursor goes by key through plots, tones and timeline, and says what there was; a symbol of tones and the anchors are reached by key', async () => {
  const { page, problems, text, shows } = await open(server.address);
  await shows('badge', /ENDED RUN/);
  await shows('reading-altitude', /\d/);
  await waitFor(
    () => page.locator('.plot[data-newest]').count(),
    (count) => count === 4,
  );
  const now = await text('reading-altitude');
  assert.equal(await page.locator('.plot-cursor:visible').count(), 0);
  for (let presses = 0; presses < 60; ++presses) await page.keyboard.press('Shift+ArrowLeft');
  await shows('cursor-altitude', /E\+\d+:\d\d\.\d\s[◆▣]/);
  await waitFor(
    () => page.locator('.plot-cursor:visible').count(),
    (count) => count === 4,
  );
  const at_e_s = secondsFromEntry((await text('cursor-altitude')).replace(/E(.)(\d+:\d+)\.\d.*/, 'E$100:$2'));
  assert.ok(at_e_s > 60 && at_e_s < 300, `${at_e_s}`);
  assert.notEqual(await text('reading-altitude'), now);
  await page.keyboard.press('Shift+ArrowRight');
  await waitFor(
    () => text('cursor-altitude'),
    (words) => secondsFromEntry(words.replace(/E(.)(\d+:\d+)\.\d[^]*/, 'E$100:$2')) > at_e_s,
  );
  await page.keyboard.press('Escape');
  await waitFor(
    () => page.locator('.plot-cursor:visible').count(),
    (count) => count === 0,
  );
  assert.equal(await text('reading-altitude'), now);

  const newest = await text('tone-title');
  await page.keyboard.press('o');
  await waitFor(
    () => focused(page),
    (id) => id === 'tone-symbols',
  );
  for (let presses = 0; presses < 12; ++presses) await page.keyboard.press('ArrowLeft');
  await shows('tone-evidence', /^at E\+\d+:\d\d · likelihood/);
  assert.notEqual(await text('tone-title'), newest);
  await page.keyboard.press('Escape');
  await waitFor(
    () => text('tone-title'),
    (title) => title === newest,
  );

  await page.keyboard.press('h');
  await waitFor(
    () => focused(page),
    (id) => id === 'anchors',
  );
  await shows('anchors', /root[^]*entry[^]*pre edl end[^]*-14400 s[^]*defined: offset from entry[^]*touchdown/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('Escape');
  assert.equal(await page.getByTestId('anchors').count(), 0);
  assert.deepEqual(problems, []);
  await page.close();
});

test('of a dictionary with more than 512 channels all that came is shown in an ended run, and before it was asked for each says so', async (t) => {
  const real = await server.get('/dictionary');
  const last = real.channels.find(({ name }) => name === 'mach'); // received, but not plotted
  const many = Array.from({ length: 700 }, (_, i) => ({
    ...last,
    id: 10_000 + i,
    name: `made_up_${i}`,
    alias: `MADE-${i}`,
    packet: 'MadeUp',
  }));
  const way = await standIn(server.address, {
    'GET /dictionary': () => [
      200,
      { ...real, channels: [...real.channels.filter((channel) => channel !== last), ...many, last] },
    ],
  });
  t.after(() => way.close());
  const { page } = await open(way.address);
  const held = [];
  await page.route('**/runs/*/channels?names=*', async (route) => {
    const url = new URL(route.request().url());
    const names = url.searchParams.get('names').split(',');
    const known = names.filter((name) => !name.startsWith('made_up_'));
    if (names.includes(last.name)) await new Promise((resolve) => held.push(resolve));
    url.searchParams.set('names', known.length > 0 ? known.join() : 'altitude_m');
    await route.continue({ url: url.href });
  });
  await page.goto(`${way.address}/?panel=channels`);
  await page.getByTestId('channel-filter').fill(last.name);
  const row = page.getByTestId(`channel-${last.name}`);
  const state = () => row.locator('.shape').getAttribute('aria-label');
  await waitFor(
    async () => held.length,
    (count) => count > 0,
  );
  assert.equal(await state(), 'not asked for yet');
  for (const go of held) go();
  await waitFor(state, (word) => word === 'stale');
  await page.getByTestId('channel-filter').fill('made_up_699');
  await waitFor(
    () => page.getByTestId('channel-made_up_699').locator('.shape').getAttribute('aria-label'),
    (word) => word === 'not received',
  );
  await page.close();
});
