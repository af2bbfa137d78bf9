// SPDX-License-Identifier: Apache-2.0
// The past of a run: a replay and a fixed range show nothing later; a range is zoomed, exported and read packet by
// packet.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { before, test } from 'node:test';
import { landed, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
});

test('a replay shows nothing of what came later, in every panel, and the way back is one key', async () => {
  const { page, problems, text, shows } = await open(server.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await page.keyboard.press('y');
  await shows('badge', /REPLAY, NOT LIVE/);
  await page.keyboard.press('p');
  await shows('replay-play', /play/); // it is held
  const marks = await page.getByTestId('mode-mark').allInnerTexts();
  assert.ok(marks.length >= 10, `${marks.length} panels are marked`);
  for (const mark of marks) assert.match(mark, /replay, rehearsal/i);
  assert.doesNotMatch(await text('phases'), /✓\s*Entry/);
  assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 0, 'an event that came later is shown');
  assert.ok(await page.getByTestId('command-line').isDisabled());
  await page.keyboard.press('Escape');
  await shows('badge', /ENDED RUN/);
  await shows('phases', /✓\s*Touchdown/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('in a fixed range every panel says that it is the past, and none shows what came later', async () => {
  const { page, problems, shows } = await open(server.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await page.keyboard.press('r');
  await page.getByTestId('range-from').fill('E+0:30');
  await page.getByTestId('range-to').fill('E+4:30');
  await page.keyboard.press('Enter');
  await shows('range-message', /every panel now shows this range/);
  await shows('past-bar', /THE PAST: E\+0:30 to E\+4:30/);
  await page.evaluate(() => document.activeElement.blur());
  for (const [key, panel] of [
    ['c', 'channels'],
    ['a', 'alarms'],
    ['n', 'notes'],
    ['k', 'packets'],
    ['v', 'verdicts'],
    ['l', 'links'],
    ['f', 'flown'],
    ['r', 'recorded'],
    ['s', 'rehearsal'],
    ['d', 'campaigns'],
  ]) {
    await page.keyboard.press(key);
    await waitFor(
      () => page.getByTestId(`tab-${panel}`).getAttribute('aria-selected'),
      (selected) => selected === 'true',
    );
    const marks = await page.getByTestId('mode-mark').allInnerTexts();
    assert.equal(marks.length, await page.locator('.panel').count(), `${panel}: a panel without a mark`);
    assert.ok(marks.length >= 11, `${marks.length} panels`);
    for (const mark of marks) assert.match(mark, /past, rehearsal/i, panel);
    await page.evaluate(() => document.activeElement.blur());
  }
  await shows('clock-entry', /E\+4:30/);
  assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 0);
  assert.equal(await page.getByTestId('whose-altitude').count(), 0);
  assert.ok(await page.getByTestId('command-line').isDisabled());
  assert.deepEqual(problems, []);
  await page.close();
});

test('a fixed range is zoomed and panned within itself by key and by button, each time with the archive’s detail', async () => {
  const { page, problems, shows } = await open(server.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  const asked = [];
  page.on('request', (request) => {
    const query = new URL(request.url()).searchParams;
    if (/\/channels$/.test(new URL(request.url()).pathname) && query.has('from'))
      asked.push([Number(query.get('from')), Number(query.get('to'))]);
  });
  await page.keyboard.press('r');
  await page.getByTestId('range-from').fill('E+3:00');
  await page.getByTestId('range-to').fill('E+5:00');
  await page.keyboard.press('Enter');
  await shows('past-bar', /THE PAST: E\+3:00 to E\+5:00/);
  await page.evaluate(() => document.activeElement.blur());
  const { entry_sclk: entry } = (await server.get('/runs')).runs[0];
  const picture = () => page.getByTestId('timeline-canvas').evaluate((canvas) => canvas.toDataURL());
  for (const [how, stretch] of [
    [() => page.keyboard.press(']'), [210, 270]],
    [() => page.getByRole('button', { name: 'zoom in' }).click(), [225, 255]],
    [() => page.keyboard.press('ArrowRight'), [232.5, 262.5]],
    [() => page.getByRole('button', { name: 'zoom out' }).click(), [217.5, 277.5]],
    [() => page.keyboard.press('['), [180, 300]],
  ]) {
    const before = await picture();
    await how();
    await waitFor(
      async () => asked.at(-1)?.map((sclk) => Math.round((sclk - entry) * 10) / 10),
      (now) => now?.join() === stretch.join(),
    );
    await waitFor(picture, (now) => now !== before);
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test('an export tells how much has come, is cancelled where it was asked for and makes no file then; taken again it is whole', async () => {
  const { page, problems, shows } = await open(server.address);
  const files = [];
  page.on('download', (file) => files.push(file));
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await page.keyboard.press('r');
  await page.getByTestId('range-from').fill('E-1:00');
  await page.getByTestId('range-to').fill('E+7:00');
  await page.keyboard.press('Enter');
  const samples = Number(/(\d+) samples/.exec(await shows('range-message', /✓ \d+ samples/))[1]);
  const cdp = await page.context().newCDPSession(page);
  const download_Bps = (downloadThroughput) =>
    cdp.send('Network.emulateNetworkConditions', {
      offline: false,
      latency: 0,
      downloadThroughput,
      uploadThroughput: -1,
    });
  await cdp.send('Network.enable');
  await download_Bps(100_000);
  const button = (name) => page.getByTestId('range-export').getByRole('button', { name, exact: true });
  await button('long').press('Enter');
  await shows('range-export', /0\.[1-9]\d.*MB have come|[1-9]\.\d+.*MB have come|0\.0[1-9].*MB have come/);
  assert.equal(await page.getByTestId('range-export').locator('progress').count(), 1);
  await button('cancel').press('Enter');
  await shows('range-export', /take these samples as CSV/);
  await download_Bps(-1);
  await shows('range-message', /cancelled: no file was made/);
  assert.equal(files.length, 0, 'a cancelled export made a file');

  /** The lines of the file of this shape, which is the only one that came since. */
  const taken = async (shape) => {
    files.length = 0;
    await button(shape).press('Enter');
    await shows('range-message', new RegExp(`✓ nominal_auto_run-1_E-1m00s_E\\+7m00s_${shape}\\.csv`));
    await waitFor(
      async () => files.length,
      (count) => count === 1,
    );
    assert.equal(files[0].suggestedFilename(), `nominal_auto_run-1_E-1m00s_E+7m00s_${shape}.csv`);
    return (await readFile(await files[0].path(), 'utf8')).trimEnd().split(/\r?\n/);
  };
  const lines = await taken('long');
  assert.ok(lines.length > 1000 && lines.length >= samples / 4, `${lines.length} lines of ${samples} samples`);
  assert.equal(files.length, 1, 'the cancelled one came after all');
  const wide = await taken('wide');
  assert.match(wide[0], /altitude_m,/, 'a column a channel');
  assert.ok(wide.length > 100 && wide.length < lines.length, `${wide.length} lines`);
  assert.deepEqual(
    problems.filter((problem) => !/abort/i.test(problem)),
    [],
  );
  await page.close();
});

test('all packets of a range are come to page by page, and one packet is looked for in all of the range', async () => {
  const { page, problems, shows } = await open(server.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  const { entry_sclk: entry } = (await server.get('/runs')).runs[0];
  const all = (await server.get(`/runs/1/packets?from=${entry + 290}&to=${entry + 292}&limit=1000`)).packets;
  assert.ok(all.length > 100 && all.length < 1000, `${all.length} packets`);
  await page.keyboard.press('r');
  await page.getByTestId('range-from').fill('E+4:50');
  await page.getByTestId('range-to').fill('E+4:52');
  await page.keyboard.press('Enter');
  await shows('past-bar', /THE PAST/);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('k');
  await shows('packet-pages', /packets 1 to 100 of more than 100, oldest first/);
  const numbers = () => page.locator('[data-testid="packet-table"] tbody tr td:nth-child(2)').allInnerTexts();
  const through = async () => {
    const seen = [];
    for (;;) {
      await shows('packet-pages', /packets \d+ to \d+/);
      const now = await waitFor(numbers, (each) => each.length > 0 && each[0] !== seen.at(-100));
      seen.push(...now);
      const later = page.getByRole('button', { name: 'later ›' });
      if (await later.isDisabled()) return seen;
      await later.click();
      await waitFor(numbers, (each) => each[0] !== now[0]);
    }
  };
  assert.deepEqual(
    await through(),
    all.map(({ unit }) => unit.unit),
  );
  await shows('packet-pages', new RegExp(`to ${all.length} of ${all.length}, oldest first`));
  await page.getByRole('button', { name: '‹ earlier' }).click();
  await shows('packet-pages', /of more than/);
  const name = 'GncNavigation';
  const named = all.filter(({ unit }) => unit.name === name).map(({ unit }) => unit.unit);
  await page.getByRole('button', { name, exact: true }).click();
  await waitFor(numbers, (now) => now.join() === named.slice(0, 100).join());
  await shows(
    'packet-pages',
    new RegExp(
      named.length > 100 ? 'packets 1 to 100 of more than 100' : `packets 1 to ${named.length} of ${named.length}`,
    ),
  );
  assert.match(
    await page
      .locator('.panel')
      .filter({ has: page.getByTestId('packet-pages') })
      .innerText(),
    /only GncNavigation, of all of the range/,
  );
  assert.deepEqual(problems, []);
  await page.close();
});
