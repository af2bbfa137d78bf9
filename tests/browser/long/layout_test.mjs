// SPDX-License-Identifier: Apache-2.0
// From 320 px to 4K, in every mode: nothing is wider than the screen, cut off or over another element, and nothing
// moves that should stay.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { standIn } from '../stand_in.mjs';
import { comesToRest, flyTo, landed, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
});

/** Pairs of texts that overlap: by more than a pixel across, and by more than `least_px` in height. */
const overlapping = (texts, least_px) =>
  texts.flatMap((one, i) =>
    texts
      .slice(i + 1)
      .filter(
        (other) =>
          Math.min(one.right, other.right) - Math.max(one.left, other.left) > 1 &&
          Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top) > least_px,
      )
      .map((other) => [one, other]),
  );

test('from 320 px to 4K nothing is wider than the screen', async () => {
  const { page, shows } = await open(server.address);
  await shows('badge', /ENDED RUN/);
  for (const [width, height] of [
    [320, 640],
    [768, 1024],
    [1024, 768],
    [1366, 768],
    [1920, 1080],
    [3840, 2160],
  ]) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${wide} px wide on ${width}`);
  }
  await page.close();
});

/**
 * Runs before the page: records the words that each canvas has drawn since it was cleared, with their boxes, by the
 * canvas's test name.
 */
function keepWhatIsWritten() {
  const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
  window.written = {};
  const name = (context) => context.canvas.dataset?.testid ?? '';
  CanvasRenderingContext2D.prototype.clearRect = function (...box) {
    window.written[name(this)] = [];
    return clearRect.apply(this, box);
  };
  CanvasRenderingContext2D.prototype.fillText = function (words, x, y, ...more) {
    const {
      actualBoundingBoxLeft: left,
      actualBoundingBoxRight: right,
      actualBoundingBoxAscent: up,
      actualBoundingBoxDescent: down,
    } = this.measureText(words);
    const canvas = name(this);
    window.written[canvas] ??= [];
    window.written[canvas].push({
      words,
      x,
      left: x - left,
      right: x + right,
      top: y - up,
      bottom: y + down,
    });
    return fillText.call(this, words, x, y, ...more);
  };
}

test('now at Mars and now as seen on Earth stand a light time apart on the timeline', async (t) => {
  const far = await serve(t, 'far', ['--scenario', 'nominal_light_time']);
  const { page, problems, shows } = await open(far.address, undefined, keepWhatIsWritten);
  await shows('badge', /REHEARSAL/);
  const written = () => page.evaluate(() => window.written['timeline-canvas'] ?? []);
  const both = (each) =>
    Array.isArray(each) && ['at Mars', 'seen on Earth'].every((words) => each.some((one) => one.words === words));
  await waitFor(written, both); // from the beginning
  await page.keyboard.press('ArrowLeft'); // away from the edge, where a flag would lean over its line
  const all = await waitFor(written, (each) => both(each) && each.find((one) => one.words === 'seen on Earth').x > 400);
  const ticks = all.flatMap(({ words, x }) => {
    const [, sign, hours, minutes, seconds] = /^E([+−])(?:(\d+):)?(\d+):(\d+)$/.exec(words) ?? [];
    return sign === undefined
      ? []
      : [{ x, e_s: (sign === '−' ? -1 : 1) * (Number(hours ?? 0) * 3600 + Number(minutes) * 60 + Number(seconds)) }];
  });
  assert.ok(ticks.length >= 2, `${ticks.length} ticks`);
  const second_px = (ticks.at(-1).x - ticks[0].x) / (ticks.at(-1).e_s - ticks[0].e_s);
  const [mars, earth] = ['at Mars', 'seen on Earth'].map((words) => all.find((each) => each.words === words).x);
  assert.ok(Math.abs((mars - earth) / second_px - 828) < 20, `${(mars - earth) / second_px} s apart`);
  assert.deepEqual(problems, []);
  await page.close();
});

test('after landing height and speed say whose they are, and no word of the descent picture lies over another', async () => {
  const { page, problems, shows } = await open(server.address, undefined, keepWhatIsWritten);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  for (const whose of ['whose-altitude', 'whose-speed']) {
    await shows(whose, /^(descent )?stage/); // a narrow head has one word of it, and all under the mouse
    assert.equal(await page.getByTestId(whose).getAttribute('title'), 'descent stage');
    await page.setViewportSize({ width: 3840, height: 2160 });
    await shows(whose, /^descent stage/);
    await page.setViewportSize({ width: 1920, height: 1080 });
  }
  await page.getByTestId('descent-result').click(); // from the result back to the picture
  await shows('descent-whose', /descent stage, the rover hangs below it/);
  await shows('channel-altitude_m', /altitude_m, descent stage/);
  const found = [];
  for (const [width, height] of [
    [1366, 768],
    [1600, 900],
    [1920, 1080],
    [3840, 2160],
  ]) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    // The words of the canvas and the figures over it.
    const written = await page.evaluate(() => {
      const element = document.querySelector('[data-testid="descent-canvas"]');
      const [canvas, grown] = [element.getBoundingClientRect(), element.currentCSSZoom ?? 1];
      const figures = [...document.querySelectorAll('.descent-now dd')].map((each) => {
        const { right, top, bottom } = each.getBoundingClientRect();
        const range = document.createRange();
        range.selectNodeContents(each);
        return {
          words: each.innerText,
          left: (range.getBoundingClientRect().left - canvas.left) / grown,
          right: (right - canvas.left) / grown,
          top: (top - canvas.top) / grown,
          bottom: (bottom - canvas.top) / grown,
        };
      });
      return [...window.written['descent-canvas'], ...figures];
    });
    assert.ok(written.some((each) => /rover hangs below/.test(each.words)));
    assert.ok(
      ['Parachute', 'touchdown', 'powered approach', 'parachute deploy'].filter((words) =>
        written.some((each) => each.words === words),
      ).length >= 3,
      written.map((each) => each.words).join(),
    );
    for (const [one, other] of overlapping(written, 1))
      found.push(`${width}: “${one.words}” lies over “${other.words}”`);
  }
  assert.deepEqual(found, []);
  assert.deepEqual(problems, []);
  await page.close();
});

/** In the page: the legible texts of the header with their boxes, without the parts that are cut off. */
function textsOfHeader() {
  const all = [];
  const walk = document.createTreeWalker(document.querySelector('[data-testid="header"]'), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const range = document.createRange();
    range.selectNodeContents(walk.currentNode);
    const words = walk.currentNode.data.trim();
    let { left, top, right, bottom } = range.getBoundingClientRect();
    let cut = false;
    for (let box = walk.currentNode.parentElement; box && box.dataset.testid !== 'header'; box = box.parentElement) {
      if (getComputedStyle(box).overflowX === 'visible') continue;
      const around = box.getBoundingClientRect();
      cut ||= around.right < right - 1;
      [left, right] = [Math.max(left, around.left), Math.min(right, around.right)];
    }
    if (words !== '' && right > left) all.push({ words, left, top, right, bottom, cut });
  }
  return all;
}

test('nothing in the header lies over another or is cut off, with alarms standing, from 320 px to 4K; and what is complete is there', async () => {
  const { page, problems, shows } = await open(server.address);
  await page.route('**/alarms?state=current', (route) =>
    route.fulfill({
      json: {
        alarms: [1, 2].map((n) => ({
          name: `made_up_${n}`,
          kind: 'limit',
          state: 'unacknowledged',
          severity: 'warning',
          worst: 'warning',
        })),
      },
    }),
  );
  await page.goto(server.address);
  await shows('alarms-waiting', /2 to acknowledge/);
  await shows('complete-through', /complete through [1-9]/);
  const found = [];
  for (const [width, height] of [
    [320, 640],
    [768, 1024],
    [1024, 768],
    [1301, 768],
    [1366, 768],
    [1501, 900],
    [1600, 900],
    [1751, 1000],
    [1920, 1080],
    [3840, 2160],
  ]) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    const texts = await page.evaluate(textsOfHeader);
    assert.ok(texts.length > 15, `${texts.length} texts`);
    const whole = texts
      .filter((text) => !text.cut)
      .map((text) => text.words)
      .join(' ');
    for (const words of [/connected/, /complete through/, /2 to acknowledge/, /E\+\d:/])
      if (!words.test(whole)) found.push(`${width}: ${words} is cut off`);
    for (const [one, other] of overlapping(texts, 4)) found.push(`${width}: “${one.words}” lies over “${other.words}”`);
    for (const text of texts) if (text.right > width) found.push(`${width}: “${text.words}” is beyond the edge`);
  }
  assert.deepEqual(found, []);
  assert.deepEqual(problems, []);
  await page.close();
});

test('the strip of phases is as high before a phase is known as after, so that nothing below it moves', async () => {
  const { page, shows } = await open(server.address);
  await shows('phases', /✓\s*Touchdown/);
  for (const [width, height] of [
    [1366, 768],
    [1600, 900],
    [1920, 1080],
  ]) {
    await page.setViewportSize({ width, height });
    const [known, unknown] = await page.getByTestId('phases').evaluate((strip) => {
      const [before, phase] = [strip.getBoundingClientRect().height, strip.querySelector('.phase-now')];
      phase.classList.remove('phase-now');
      const after = strip.getBoundingClientRect().height;
      phase.classList.add('phase-now');
      return [before, after];
    });
    assert.ok(
      Math.abs(known - unknown) < 1,
      `at ${width} px ${known} px high, and ${unknown} px before a phase is known`,
    );
  }
  await page.close();
});

/**
 * In the page: the visible events, the illegible conditions of the waiting panel, and elements cut off or under a mark.
 */
function whatIsInSight() {
  const box = (element) => element.getBoundingClientRect();
  const list = document.querySelector('[data-testid="event-list"]');
  const waiting = document.querySelector('[data-testid="waiting"]');
  const events = [...list.querySelectorAll('.event')].filter(
    (row) => box(row).top >= box(list).top - 1 && box(row).bottom <= Math.min(box(list).bottom, innerHeight) + 1,
  ).length;
  const unread = [...waiting.querySelectorAll('h2, li')].filter(
    (each) =>
      !each.checkVisibility() ||
      box(each).bottom > Math.min(box(waiting).bottom, innerHeight) + 1 ||
      each.scrollWidth > each.clientWidth + 1,
  );
  const cut = [];
  for (const panel of document.querySelectorAll('.panel')) {
    const name = panel.dataset.testid;
    for (const each of panel.querySelectorAll(
      '.panel-head :is(h2, button, output, select, input, .reading, .panel-extra > span)',
    )) {
      if (!each.checkVisibility() || box(each).width === 0) continue;
      if (box(each).right > box(panel).right + 1 || box(each).left < box(panel).left - 1)
        cut.push(`${name}: “${each.textContent.trim()}” ends outside`);
      if (each.localName === 'h2' && each.scrollWidth > each.clientWidth + 1)
        cut.push(`${name}: the title “${each.textContent}” is cut off`);
    }
    const [mark, title] = [panel.querySelector('.mode-mark'), panel.querySelector('h2')];
    if (!mark || !title) continue;
    const words = document.createRange();
    words.selectNodeContents(title);
    for (const one of words.getClientRects()) {
      if (
        Math.min(box(mark).right, one.right) - Math.max(box(mark).left, one.left) > 0 &&
        Math.min(box(mark).bottom, one.bottom) - Math.max(box(mark).top, one.top) > 1
      )
        cut.push(`${name}: its mark lies over “${title.textContent}”`);
    }
  }
  return {
    events,
    unread: unread.map((each) => each.textContent),
    cut: [...new Set(cut)],
    letters_px: parseFloat(getComputedStyle(list).fontSize) * (list.currentCSSZoom ?? 1),
  };
}

test('live, reviewing, ended, in a replay and in the past at least four events (but on a small screen beside a review) and what is waited for are in sight, nothing is cut off or under a mark, and on a wall type grows', async (t) => {
  const going = await serve(t, 'sizes', ['--scenario', 'nominal_auto', '--pace', '100']);
  await flyTo(going, 150);
  const wrong = [];
  for (const [state, address, reach] of [
    ['live', going.address, async () => undefined],
    [
      'reviewing',
      going.address,
      async ({ page, shows }) => {
        await page.keyboard.press('/');
        await page.keyboard.type('set edl parameters');
        await page.keyboard.press('Enter');
        await shows('dry-run', /would/);
      },
    ],
    ['ended', server.address, async () => undefined],
    [
      'replay',
      server.address,
      async ({ page, shows }) => {
        await page.keyboard.press('y');
        await shows('badge', /REPLAY/); // two letters in a row are a word
        await page.keyboard.press('p');
        await shows('replay-play', /play/); // it is held
        await page.getByTestId('replay-bar').locator('input').fill('265');
        await shows('clock-entry', /E\+4:25/);
      },
    ],
    [
      'past',
      server.address,
      async ({ page, shows }) => {
        await page.keyboard.press('r');
        await page.getByTestId('range-from').fill('E+0:30');
        await page.getByTestId('range-to').fill('E+4:30');
        await page.keyboard.press('Enter');
        await shows('range-message', /✓/);
      },
    ],
  ]) {
    const opened = await open(address);
    await opened.shows('reading-altitude', /\d/);
    await waitFor(
      () => opened.page.locator('[data-event]').count(),
      (count) => count > 8,
    );
    await reach(opened);
    for (const [width, height] of [
      [320, 640],
      [1024, 768],
      [1280, 720],
      [1366, 768],
      [1600, 900],
      [1920, 1080],
      [3840, 2160],
    ]) {
      await opened.page.setViewportSize({ width, height });
      await comesToRest(opened.page);
      const { events, unread, cut, letters_px } = await opened.page.evaluate(whatIsInSight);
      const at = `${state}, ${width} × ${height}`;
      const roomForBoth = state !== 'reviewing' || height > 1000; // otherwise the reviewed command has priority
      // below 850 px of height the first events make room for what is to be typed, below 760 px the half of them gives way
      const least = height < 760 ? 2 : 4;
      if (width >= 1280 && roomForBoth && events < least) wrong.push(`${at}: ${events} events in sight`);
      if (width >= 1280) wrong.push(...unread.map((words) => `${at}: what is waited for cannot be read: ${words}`));
      if (width >= 3840 && letters_px < 18) wrong.push(`${at}: letters of ${letters_px} px`);
      wrong.push(...cut.map((words) => `${at}: ${words}`));
    }
    await opened.page.close();
  }
  assert.deepEqual(wrong, []);
});

test('the columns of the channels keep their places whatever stands in them', async () => {
  const { page, problems } = await open(server.address, { width: 1000, height: 640 });
  await page.goto(`${server.address}/?panel=channels`);
  await waitFor(() => page.getByTestId('channel-altitude_m').innerText(), /\d/);
  const places = () =>
    page
      .locator('[data-testid=channel-table] th')
      .evaluateAll((heads) => heads.map((head) => head.getBoundingClientRect().left));
  const before = await places();
  for (const filter of ['edl_phase', 'altitude_m', 'nothing is called so']) {
    await page.getByTestId('channel-filter').fill(filter);
    await waitFor(
      () => page.locator('[data-testid=channel-table] tbody tr').count(),
      (rows) => rows < 10,
    );
    assert.deepEqual(await places(), before, filter);
  }
  assert.deepEqual(problems, []);
  await page.close();
});

/** Two alarms that no run of this file has, one of a limit and one of a link, with all possible actions and words. */
const ALARMS = [
  {
    name: 'sky_crane_descent_rate_mps',
    kind: 'limit',
    state: 'latched',
    severity: 'none',
    worst: 'critical',
    latches: true,
    limit: '> 1.5 m/s in sky_crane',
    value: -1234.5678,
    sclk: 397501900,
  },
  {
    name: 'uhf_live',
    kind: 'link',
    state: 'shelved',
    severity: 'distress',
    worst: 'distress',
    shelved_until: '2012-219T05:20:47',
    by: 'Ada',
    note: 'the station is told',
    reason: 'unexplained: no frame since E+2:10, the orbiter is in view',
  },
];

for (const [panel, tables] of [
  ['packets', ['packet-streams', 'packet-table']],
  ['links', ['link-table']],
  ['alarms', ['alarm-table']],
]) {
  test(`the columns of the ${panel} keep their places whatever stands in them`, async (t) => {
    const way = await standIn(server.address, { 'GET /runs/1/alarms?state=current': () => [200, { alarms: ALARMS }] });
    t.after(() => way.close());
    const { page, problems } = await open(way.address, { width: 1000, height: 640 });
    await page.goto(`${way.address}/?panel=${panel}`);
    for (const table of tables) {
      const rows = page.locator(`[data-testid=${table}] tbody tr`);
      await waitFor(
        () => rows.count(),
        (count) => count > 1,
      );
      for (const [width, height] of [
        [1000, 640],
        [640, 640],
        [1920, 1080],
      ]) {
        await page.setViewportSize({ width, height });
        await comesToRest(page);
        const places = () =>
          page
            .locator(`[data-testid=${table}] th`)
            .evaluateAll((heads) => heads.map((head) => head.getBoundingClientRect().left));
        const before = await places();
        for (const words of ['', '8', '1234567890 '.repeat(8)]) {
          await rows.evaluateAll((all, filling) => {
            for (const cell of all.flatMap((row) => [...row.cells])) cell.textContent = filling;
          }, words);
          assert.deepEqual(await places(), before, `${table}, ${width} px, with '${words}'`);
        }
      }
    }
    assert.deepEqual(problems, []);
    await page.close();
  });
}
