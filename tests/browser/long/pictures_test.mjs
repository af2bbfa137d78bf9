// SPDX-License-Identifier: Apache-2.0
// Every panel alone and the whole console, in both themes and in the most important states, against stored pictures.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { madeUpCampaign } from '../made_up_campaign.mjs';
import { PANELS } from '../panels.mjs';
import { comesToLook, comparePicture } from '../picture.mjs';
import { breakable, landed, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
  // no page asks while the nominal flight is still flown
  await waitFor(async () => (await server.get('/runs/1/prediction')).state, /ready/);
});

/** In the page: the second plot without its trace. */
function loseATrace() {
  const canvas = document.querySelectorAll('.plot canvas')[1];
  const rgb = parseInt(getComputedStyle(document.documentElement).getPropertyValue('--by-uhf').trim().slice(1), 16);
  const context = canvas.getContext('2d');
  const picture = context.getImageData(0, 0, canvas.width, canvas.height);
  for (let at = 0; at < picture.data.length; at += 4) {
    // as near as what is counted as the trace's colour
    const [red, green, blue] = [rgb >> 16, (rgb >> 8) & 255, rgb & 255].map((part, i) =>
      Math.abs(picture.data[at + i] - part),
    );
    if (red + green + blue < 24) picture.data[at + 3] = 0;
  }
  context.putImageData(picture, 0, 0);
}

/** In the page: the panel without its content. */
function blank() {
  for (const body of document.querySelectorAll('main .panel-body, main .waiting'))
    for (const child of body.children) child.style.visibility = 'hidden';
  for (const hidden of document.querySelectorAll('.strip *, main .panel-body *, main .waiting *'))
    hidden.style.visibility = 'hidden';
}

test('each panel comes to look as its stored picture does, within a tolerance, and one that is blank does not; so does the console in mid-entry, in the past and without connection', async (t) => {
  const { page, problems, shows } = await open(server.address, { width: 1000, height: 640 });
  await madeUpCampaign(page);
  const different = [];
  const compare = async (name, what) => different.push(...(await comesToLook(page, name, what)));
  for (const [theme, panels] of [
    ['dark', PANELS],
    ['light', ['timeline', 'phases', 'plots', 'commands', 'campaigns']],
  ]) {
    await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), theme);
    for (const panel of panels) {
      await page.goto(`${server.address}/?panel=${panel}`);
      await shows('badge', /ENDED RUN/);
      await shows('stream-state', /connected/);
      if (panel === 'descent' || panel === 'vehicle') await shows('touchdown-figures', /in the nominal flight/);
      if (panel === 'verdicts') await shows('verdict-sentence', /bit for bit/);
      if (panel === 'flown') await shows('flown-summary', /timepoints fired/);
      if (panel === 'campaigns') await shows('campaign-ellipse', /azimuth/);
      if (panel === 'channels') await waitFor(() => page.getByTestId('channel-altitude_m').innerText(), /\d/);
      const what = page.locator(panel === 'phases' ? '.strip' : 'main');
      await waitFor(
        () => what.innerText(),
        (all) => !/asking…/.test(all),
      );
      await compare(`${panel}_${theme}`, what);
      if (process.env.AEOLIS_RENEW_PICTURES) continue;
      // A late update may draw the removed part again, once.
      const found = async (taken) => {
        await page.evaluate(taken);
        return comparePicture(page, `${panel}_${theme}`, await what.screenshot({ animations: 'disabled' }));
      };
      if (panel === 'plots') {
        // no other trace; the tiles may show it too
        const isLost = ([lost, ...more]) =>
          /canvas 1 has by-uhf in 0 columns/.test(lost) && more.every((line) => /tiles with content/.test(line));
        await waitFor(() => found(loseATrace), isLost); // a lost trace is noticed
      }
      // an empty panel does not pass
      await waitFor(async () => (await found(blank)).join(), /tiles with content differ/);
    }
  }
  // The result of the touchdown has the descent picture's place until that is asked for.
  await page.evaluate(() => localStorage.setItem('aeolis-theme', 'dark'));
  await page.goto(`${server.address}/?panel=descent`);
  await page.getByTestId('descent-result').click();
  await page.getByTestId('descent-canvas').waitFor();
  await compare('descent_picture_dark', page.locator('main'));
  await page.setViewportSize({ width: 1600, height: 900 });
  for (const theme of ['dark', 'light']) {
    await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), theme);
    await page.goto(server.address);
    await shows('waiting', /Touchdown (reported|confirmed)/);
    await shows('stream-state', /connected/);
    await shows('touchdown-figures', /from the target\s+\d/);
    await compare(`console_${theme}`, page);
  }

  // The most important states: mid-entry, as a replay shows it, the past, no connection.
  await page.evaluate(() => localStorage.setItem('aeolis-theme', 'dark'));
  const way = await breakable(server.port);
  t.after(() => way.close());
  await page.goto(way.address);
  await page.evaluate(() => localStorage.setItem('aeolis-theme', 'dark'));
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await shows('complete-through', /[1-9]/);
  await page.keyboard.press('y');
  await shows('badge', /REPLAY/); // two letters in a row are a word
  await page.keyboard.press('p');
  await shows('replay-play', /play/); // it is held
  await page.getByTestId('replay-bar').locator('input').fill('265');
  await shows('clock-entry', /E\+4:25/);
  await page.evaluate(() => document.activeElement.blur());
  await compare('console_mid_entry_dark', page);
  const themeByKey = async (wanted) => {
    await page.keyboard.press('t'); // acts when no other letter follows at once
    await waitFor(
      () => page.evaluate(() => document.documentElement.dataset.theme),
      (theme) => theme === wanted,
    );
  };
  await themeByKey('light');
  await compare('console_mid_entry_light', page);
  await themeByKey('dark');
  await page.keyboard.press('Escape');
  await shows('badge', /ENDED RUN/);
  await page.keyboard.press('r');
  await page.getByTestId('range-from').fill('E+0:30');
  await page.getByTestId('range-to').fill('E+4:30');
  await page.keyboard.press('Enter');
  await shows('range-message', /✓/);
  await page.evaluate(() => document.activeElement.blur());
  await compare('console_past_dark', page);
  await page.keyboard.press('Escape');
  await page.keyboard.press('c');
  await page.evaluate(() => document.activeElement.blur());
  way.cut();
  await shows('situation-sentence', /NO CONNECTION/);
  await compare('console_lost_dark', page);
  assert.deepEqual(different, []);
  assert.deepEqual(
    problems.filter((problem) => !/Failed to fetch|ERR_/.test(problem)),
    [],
  );
  await page.close();
});
