// SPDX-License-Identifier: Apache-2.0
// From any value to anything: its menu by mouse and by key, its bytes, a link that opens the same picture in another
// browser, and a layout kept by the server; on a landing that was flown.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { findings, landed, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
});

const menu = (page) => page.getByTestId('menu');
const titles = (page) => page.locator('.plots .panel-head h2').allInnerTexts();

test('a value leads to plots, limits, evidence and bytes, by mouse and by key alone', async () => {
  const { page, problems, text, shows } = await open(server.address, { width: 1440, height: 790 });
  await shows('stream-state', /connected/);
  await shows('channel-altitude_m', /altitude_m/);
  await page.getByTestId('channel-mach').click({ button: 'right' });
  await menu(page)
    .getByRole('menuitem', { name: /^Plot it over Speed/ })
    .click();
  await waitFor(
    () => titles(page),
    (all) => all.includes('Speed, mach'),
  );
  const row = page.getByTestId('channel-sensed_deceleration_g');
  await row.hover();
  await row.hover({ position: { x: 60, y: 8 } }); // after the table has scrolled to it
  await page.getByTestId('menu-button').click();
  await shows('menu', /sensed_deceleration_g/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await menu(page)
    .getByRole('menuitem', { name: /^Its alarm limits/ })
    .click();
  await shows('menu-sheet', /Alarm limits of sensed_deceleration_g, in g[^]*in parachute descent/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('Escape');
  assert.equal(await page.getByTestId('menu-sheet').count(), 0);

  // By key: to a value, its menu, the first item by its letter.
  await page.mouse.move(0, 0);
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press('i');
  const value = () => page.evaluate(() => document.activeElement?.dataset.menu ?? '');
  await waitFor(value, /./);
  for (let i = 0; i < 12 && (await value()) !== 'panel data'; ++i) await page.keyboard.press('ArrowRight');
  for (let i = 0; i < 12 && (await value()) !== 'channel speed_mps'; ++i) await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await shows('menu', /speed_mps/);
  await page.keyboard.press('w');
  await page.keyboard.press('Enter');
  await shows('menu-sheet', /Why: speed_mps[^]*m\/s[^]*packet\s+GncNavigation, packet \d+[^]*octets \d+ to \d+/);
  await page.keyboard.press('Escape');
  assert.equal(await value(), 'channel speed_mps', 'the focus is where it was');
  await page.keyboard.press('Enter');
  await page.getByRole('menuitem', { name: 'Its bytes' }).press('Enter');
  await shows('packet', /GncNavigation/);
  await shows('packet-place', /^speed_mps: octets \d+ to \d+, 32 bits/);
  assert.match(await text('packet-table'), /GncNavigation/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a link opens the same picture in a browser that has never been here, and says what of it cannot be', async () => {
  const { page, problems, shows } = await open(server.address, { width: 1440, height: 790 });
  await shows('stream-state', /connected/);
  await page.keyboard.press('r');
  await page.getByTestId('range-from').fill('E+3:50');
  await page.getByTestId('range-to').fill('E+5:00');
  await page.getByTestId('range-query').click();
  await shows('past-bar', /E\+3:50 to E\+5:00/);
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press(']');
  await page.locator('.panel-descent .panel-head').click({ button: 'right' });
  await menu(page).getByRole('menuitem', { name: 'Links here' }).click();
  await page.locator('.plots [data-menu="channel altitude_m"]').click({ button: 'right' });
  await menu(page)
    .getByRole('menuitem', { name: /^Plot it over Bank/ })
    .click();
  await page.keyboard.press('Shift+ArrowLeft');
  await page.keyboard.press('q');
  const link = await page.getByTestId('link').inputValue();
  assert.match(link, /\?run=1&past=230,300&with=recording&span=[\d.,]+&at=[\d.]+&data=recorded&middle=links&channels=/);
  const picture = ({ page: of }) =>
    Promise.all([
      of.getByTestId('past-bar').innerText(),
      of.locator('.plots [data-testid^=cursor-]').allInnerTexts(),
      titles(of),
      of.locator('.middle > :first-child').getAttribute('data-testid'),
      of.locator('.tabs [aria-selected=true]').getAttribute('data-testid'),
    ]);
  const first = await picture({ page });
  const other = await open(link, { width: 1440, height: 790 });
  await waitFor(
    async () => JSON.stringify(await picture(other)),
    (now) => now === JSON.stringify(first),
  );
  assert.match(first[1].join(), /E\+4:/);
  assert.equal(await other.page.getByTestId('notices').count(), 0);
  assert.deepEqual([...problems, ...other.problems], []);
  await other.page.close();
  await page.close();

  const wrong = await open(`${server.address}/?run=7&past=-9000,-8000&data=links&channels=altitude_m,moon`);
  await wrong.shows('notices', /no channel moon in the dictionary/);
  await wrong.shows('notices', /Run 7 is not in this archive/);
  await wrong.shows('links', /UHF/);
  assert.deepEqual(await titles(wrong.page), ['Altitude']);
  await wrong.page.goto(`${server.address}/?run=1&past=-9000,-8000`);
  await wrong.shows('notices', /E−2:30:00 to E−2:13:20 is not shown: run 1 is known from E−/);
  assert.equal(await wrong.page.getByTestId('past-bar').count(), 0);
  await wrong.page.close();
});

test('a layout is saved, chosen in another browser and removed, by key alone; a panel has all the room and gives it back', async () => {
  const { page, problems, shows } = await open(`${server.address}/?data=links&low=events-are-not-for-here`, {
    width: 1280,
    height: 585,
  });
  await shows('notices', /there is no panel events-are-not-for-here to show there/);
  await page.keyboard.press('Escape');
  await page.locator('.panel-timeline').hover();
  await page.keyboard.press('z');
  await waitFor(
    () => page.locator('.left > *').count(),
    (count) => count === 1,
  );
  await page.keyboard.press('9');
  await shows('menu', /Layout: as the console comes/);
  await page.keyboard.press('End');
  await page.keyboard.press('Enter');
  await page.getByTestId('layout-name').fill('Timeline 1');
  await page.keyboard.press('Enter');
  await shows('layout-list', /Timeline 1/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.keyboard.press('Escape');
  await page.keyboard.press('z');
  await waitFor(
    () => page.locator('.left > *').count(),
    (count) => count === 3,
  );

  const other = await open(server.address, { width: 390, height: 700 });
  await other.shows('stream-state', /connected/);
  await other.page.keyboard.press('9');
  await waitFor(() => menu(other.page).innerText(), /Layout: Timeline 1/);
  await other.page.getByRole('menuitemradio', { name: 'Layout: Timeline 1' }).press('Enter');
  await waitFor(() => new URL(other.page.url()).search, /full=timeline&data=links/);
  assert.equal(await other.page.getByTestId('command-line').isVisible(), true);
  await other.page.keyboard.press('9');
  await other.page.getByRole('menuitem', { name: /^Save or remove/ }).press('Enter');
  await other.page.getByRole('button', { name: 'remove Timeline 1' }).press('Enter');
  await waitFor(
    async () => (await server.get('/layouts')).layouts,
    (all) => all.length === 0,
  );
  assert.deepEqual([...problems, ...other.problems], []);
  await other.page.close();
  await page.close();
});
