// SPDX-License-Identifier: Apache-2.0
// The content in sight on screens of each size: a laptop's whole page, large figures on a wall, details beside the
// timeline and not over it.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { SIZES, STATES, measured, measuredTabs } from '../sizes.mjs';
import { comesToRest, landed, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
const withScrollbars = workplace({ scrollbars: true });
const post = (server, body) =>
  fetch(`${server.address}/api/v1/rehearsals/current`, { method: 'POST', body: JSON.stringify(body) });
const held = async (t, scenario, e_s) => {
  const server = await serve(t, scenario, ['--scenario', scenario, '--pace', '100']);
  const passes = (wanted) =>
    waitFor(
      async () => (await server.get('/runs')).runs[0]?.clocks?.e_s,
      (now) => now > wanted,
    );
  await passes(e_s - 90);
  await post(server, { pace: 10 });
  await passes(e_s);
  await post(server, { pause: true });
  return server;
};
let blackout;

before(async () => {
  blackout = await held(undefined, 'nominal_auto', 60); // UHF is silent, with a reason
});

/** In the page: whether it scrolls, and the visible part of the command line. */
function sight() {
  const [line, column] = [document.querySelector('.command-line input'), document.querySelector('.right')].map((each) =>
    each.getBoundingClientRect(),
  );
  return {
    scrolls: document.documentElement.scrollHeight > innerHeight,
    line: line.top >= column.top && line.bottom <= Math.min(column.bottom, innerHeight),
  };
}

test('a laptop shows all of the page and all of the command line: before it begins, when it is too late to, and in flight', async (t) => {
  const late = await held(t, 'nominal', -820);
  const early = await serve(t, 'early', ['--scenario', 'nominal']);
  for (const [state, { address }, title] of [
    ['early', early, /Press \//],
    ['late', late, /Too late for this run/],
    ['flying', blackout, /peak deceleration/],
  ]) {
    const { page, problems, shows } = await open(address);
    await shows('waiting', title);
    for (const [width, height] of [
      [1366, 768],
      [1440, 900],
      [1600, 900],
      [1920, 1080],
    ]) {
      await page.setViewportSize({ width, height });
      await comesToRest(page);
      assert.deepEqual(await page.evaluate(sight), { scrolls: false, line: true }, `${state}, ${width} × ${height}`);
    }
    assert.deepEqual(problems, []);
    await page.close();
  }
});

test('alone on a large screen what is waited for, the lanes of the timeline and the figures of the descent are read from afar', async () => {
  const { page } = await open(blackout.address);
  const px = (selector) =>
    page
      .locator(selector)
      .first()
      .evaluate((each) => parseFloat(getComputedStyle(each).fontSize) * each.currentCSSZoom);
  await page.goto(`${blackout.address}/?panel=waiting`);
  await waitFor(
    () => px('.waiting h2'),
    (size) => size >= 50,
  );
  await waitFor(
    () => px('.waiting li'),
    (size) => size >= 36,
  );
  await page.goto(`${blackout.address}/?panel=descent`);
  await waitFor(
    () => px('[data-testid=altitude]'),
    (size) => size >= 100,
  );
  await page.addInitScript(() => {
    window.lanes = {};
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function (words, x, y) {
      window.lanes[words] = this.getTransform().transformPoint({ x, y }).y;
      return fillText.call(this, words, x, y);
    };
  });
  await page.goto(`${blackout.address}/?panel=timeline`);
  await waitFor(
    () => page.evaluate(() => window.lanes['by tone'] - window.lanes.predicted),
    (apart) => apart >= 60,
  );
  await page.close();
});

test('what is opened stands beside the timeline, and a link’s reason takes no second row of the header', async () => {
  const { page, shows } = await open(blackout.address);
  await shows('link-UHF', /plasma/);
  assert.ok((await page.locator('.links').evaluate((links) => links.getBoundingClientRect().height)) < 45);
  for (const [key, opened] of [
    ['.', 'timepoint-detail'],
    ['h', 'anchors'],
  ]) {
    for (const [width, height] of [
      [1920, 1080],
      [1366, 768],
    ]) {
      await page.setViewportSize({ width, height });
      if ((await page.getByTestId(opened).count()) === 0) await page.keyboard.press(key);
      await page.getByTestId(opened).waitFor();
      await comesToRest(page);
      const [picture, beside] = await Promise.all([
        page.getByTestId('timeline-canvas').boundingBox(),
        page.getByTestId(opened).boundingBox(),
      ]);
      assert.ok(
        picture.x + picture.width <= beside.x && picture.width > 250,
        `${opened}, ${width}: ${picture.x + picture.width} > ${beside.x}`,
      );
    }
  }
  await page.close();
});

test('at each size that people have, in each state and both themes, all texts and controls are whole, and so are header, command line and what is armed', async (t) => {
  assert.deepEqual(await measured(withScrollbars, t, Object.keys(STATES), SIZES, ['dark', 'light']), []);
});

test('at each size the texts and controls of every tab are whole', async (t) => {
  assert.deepEqual(await measuredTabs(withScrollbars, t, SIZES), []);
});

test('at 3 m the clock from entry and news are read: 15 mm on a screen of 24 inches from 1920 × 950 on', async () => {
  const { page, shows } = await open((await landed(serve)).address);
  await shows('situation-sentence', /Touchdown|recording is complete/);
  for (const [width, height] of [
    [1920, 950],
    [2560, 1300],
    [3840, 2000],
  ]) {
    await page.setViewportSize({ width, height });
    for (const selector of ['[data-testid=clock-entry]', '[data-testid=situation-sentence]']) {
      const px = await page
        .locator(selector)
        .evaluate((each) => parseFloat(getComputedStyle(each).fontSize) * each.currentCSSZoom);
      assert.ok(px >= 54, `${selector}, ${width} × ${height}: ${px} px`);
    }
  }
  await page.close();
});

test('type that comes late moves next to nothing: a local face of its width stands in', async () => {
  const { page, shows } = await open(blackout.address, { width: 1440, height: 790 }, () => {
    window.shifts = [];
    new PerformanceObserver((list) => {
      for (const { startTime, value } of list.getEntries()) window.shifts.push({ startTime, value });
    }).observe({ type: 'layout-shift', buffered: true });
  });
  const held = [];
  await page.route('**/*.woff2', (route) => held.push(route));
  await page.reload({ waitUntil: 'commit' }); // its loading ends with the type
  await shows('phases', /▶/);
  await shows('waiting', /peak deceleration/);
  await comesToRest(page);
  await page.waitForTimeout(500);
  const before = await page.evaluate(() => performance.now());
  for (const route of held) await route.continue();
  await waitFor(
    () =>
      page.evaluate(() =>
        [...document.fonts].filter((face) => !/stand-in/.test(face.family)).every((face) => face.status === 'loaded'),
      ),
    (loaded) => loaded,
  );
  await comesToRest(page);
  const moved = await page.evaluate(
    (since) => window.shifts.filter((each) => each.startTime > since).reduce((sum, each) => sum + each.value, 0),
    before,
  );
  assert.equal(held.length, 2);
  assert.ok(moved < 0.002, `layout shift ${moved}`);
  await page.close();
});

test('on paper a report is as wide as the paper, without what could be pressed', async () => {
  const { page } = await open(`${blackout.address}/?panel=flown`, { width: 702, height: 1000 }); // A4 less its margins
  await waitFor(
    () => page.locator('[data-testid=flown-table] tbody tr').count(),
    (rows) => rows > 20,
  );
  await page.emulateMedia({ media: 'print' });
  const { wide, seen } = await page.evaluate(() => ({
    wide: document.documentElement.scrollWidth,
    // the head of a column is a button, and words on paper
    seen: [...document.querySelectorAll('button:not(th > *), input, select')].filter((each) => each.checkVisibility())
      .length,
  }));
  assert.ok(wide <= 702, `${wide} px`);
  assert.equal(seen, 0);
  // The table of channels is whole, with the rows that are out of sight on a screen.
  await page.emulateMedia({ media: 'screen' });
  await page.goto(`${blackout.address}/?panel=channels`);
  const last = page.locator('.channels tbody tr').last();
  await last.waitFor({ state: 'attached' });
  const isRendered = () => last.evaluate((row) => row.checkVisibility({ contentVisibilityAuto: true }));
  assert.equal(await isRendered(), false, 'on a screen they are left out');
  await page.emulateMedia({ media: 'print' });
  assert.equal(await isRendered(), true);
  await page.close();
});
