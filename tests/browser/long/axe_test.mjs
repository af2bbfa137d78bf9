// SPDX-License-Identifier: Apache-2.0
// Axe finds nothing: on every panel, on the whole console in every mode and at every width, live and ended, in both
// themes.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { madeUpCampaign } from '../made_up_campaign.mjs';
import { PANELS } from '../panels.mjs';
import { breakable, comesToRest, findings, landed, workplace } from '../support.mjs';

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
});

test('axe finds nothing on any panel in both themes, and each panel says its mode', async () => {
  const found = [];
  const { page, problems, shows } = await open(server.address);
  await madeUpCampaign(page);
  for (const name of ['dark', 'light']) {
    await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), name);
    for (const panel of [...PANELS, undefined]) {
      await page.goto(panel === undefined ? server.address : `${server.address}/?panel=${panel}`);
      await shows('badge', /ENDED RUN/);
      if (panel === 'verdicts') await shows('verdict-sentence', /bit for bit/);
      if (panel === 'flown') await shows('flown-summary', /timepoints fired/);
      if (panel === 'campaigns') await shows('campaign-ellipse', /azimuth/);
      if (panel !== 'phases')
        assert.match(
          (await page.getByTestId('mode-mark').allInnerTexts()).join(),
          /ended, rehearsal/,
          `${panel} does not say its mode`,
        );
      found.push(...(await findings(page, name)).map((line) => `${panel ?? 'console'}, ${name}: ${line}`));
    }
    for (const [panel, reach] of [
      [
        'packets',
        async () => {
          await shows('packet-table', /UHF/);
          await page.getByTestId('packet-rows').focus();
          await page.keyboard.press('ArrowDown');
          await shows('packet', /packet \d/);
        },
      ],
      [
        'commands',
        async () => {
          await page
            .getByRole('button', { name: /EDL_SET_PARAMETERS #/ })
            .first()
            .click();
          await shows('read-back', /held as sent/);
        },
      ],
    ]) {
      await page.goto(`${server.address}/?panel=${panel}`);
      await shows('badge', /ENDED RUN/);
      await reach();
      found.push(...(await findings(page, name)).map((line) => `${panel} opened, ${name}: ${line}`));
    }
    await page.goto(server.address);
    await shows('badge', /ENDED RUN/);
    for (const [key, title] of [
      ['y', /REPLAY, NOT LIVE/],
      ['r', /ENDED RUN/],
      ['?', /ENDED RUN/],
    ]) {
      await page.keyboard.press(key);
      await shows('badge', title);
      found.push(...(await findings(page, name)).map((line) => `console after ${key}, ${name}: ${line}`));
      await page.keyboard.press('Escape');
      await page.keyboard.press('Escape');
    }
  }
  assert.deepEqual(found, []);
  assert.deepEqual(problems, []);
  await page.close();
});

test('at every width axe finds nothing, live and ended, in both themes', async (t) => {
  const going = await serve(t, 'widths', ['--scenario', 'nominal']);
  const found = [];
  for (const address of [going.address, server.address]) {
    const { page, shows } = await open(address);
    for (const theme of ['dark', 'light']) {
      await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), theme);
      await page.goto(address);
      await shows('complete-through', /complete through [1-9]/);
      for (const [width, height] of [
        [320, 640],
        [1024, 768],
        [1280, 720],
        [1366, 768],
      ]) {
        await page.setViewportSize({ width, height });
        await comesToRest(page);
        found.push(
          ...(await findings(page, theme)).map(
            (line) => `${address === server.address ? 'ended' : 'live'}, ${width}, ${theme}: ${line}`,
          ),
        );
      }
    }
    await page.close();
  }
  assert.deepEqual(found, []);
});

test('with a command that is refused, with one that is armed and without connection axe finds nothing, in both themes', async (t) => {
  const going = await serve(t, 'states', ['--scenario', 'nominal']);
  const way = await breakable(going.port);
  t.after(() => way.close());
  const { page, problems, shows } = await open(way.address, { width: 1440, height: 790 });
  await shows('waiting', /set edl parameters/);
  const found = [];
  const review = async (words) => {
    await page.getByTestId('command-line').fill(words);
    await page.getByTestId('command-line').press('Enter');
  };
  for (const [state, reach] of [
    [
      'refused',
      async () => {
        await review('do edl');
        await shows('dry-run', /✖ It would be refused/);
      },
    ],
    [
      'armed',
      async () => {
        await page.keyboard.press('Escape');
        await review('select_prime computer=b');
        await shows('dry-run', /✓ It would be sent once it is armed/);
        await page.keyboard.press('Enter');
        await shows('command-armed', /ARMED/);
      },
    ],
    [
      'lost',
      async () => {
        way.cut();
        await shows('situation-sentence', /NO CONNECTION/);
      },
    ],
  ]) {
    await reach();
    for (const theme of ['dark', 'light']) {
      await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
      found.push(...(await findings(page, theme)).map((line) => `${state}, ${theme}: ${line}`));
    }
  }
  assert.deepEqual(found, []);
  assert.deepEqual(
    problems.filter((problem) => !/Failed to fetch|ERR_/.test(problem)),
    [],
  );
  await page.close();
});
