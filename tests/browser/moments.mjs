// SPDX-License-Identifier: Apache-2.0
// Renews the pictures of the twelve moments that a console is judged by, at two sizes of a browser's window, from the
// real program: node tests/browser/moments.mjs [MOMENT]...
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import { browser, flyTo, open, root, serve, temporaryFolder, waitFor } from './support.mjs';

const pictures = path.join(root, 'docs/pictures/moments');
const SIZES = [
  { width: 1440, height: 790 },
  { width: 1920, height: 950 },
];
mkdirSync(pictures, { recursive: true });
const wanted = new Set(process.argv.slice(2));
const { folder, remove } = await temporaryFolder();
const chrome = await browser();

let plays = 0;

/** A page on a server of its own, with what the moments need. */
async function play(scenario, moments) {
  if (wanted.size > 0 && !moments.some(([name]) => wanted.has(name))) return;
  plays += 1;
  const server = await serve({
    archive: path.join(folder, `${plays}.db`),
    more: ['--scenario', scenario, '--pace', '1'],
  });
  const { page, shows } = await open(chrome, server.address, SIZES[0]);
  const control = (body) =>
    fetch(`${server.address}/api/v1/rehearsals/current`, { method: 'POST', body: JSON.stringify(body) });
  try {
    await shows('stream-state', /connected[^]*complete through [1-9]/, 60_000);
    await waitFor(
      () => server.get('/runs/latest/prediction'),
      ({ state }) => state !== 'flying',
      120_000,
    );
    for (const [name, bring] of moments) {
      await bring({ server, page, shows, control });
      if (wanted.size > 0 && !wanted.has(name)) continue;
      for (const size of SIZES) {
        await page.setViewportSize(size);
        await waitFor(
          () => page.locator('body').innerText(),
          (all) => !/asking…|has not answered|connecting/.test(all),
          60_000,
        );
        // what is predicted of the time ahead, where there is any
        const isThere = () => Number(document.querySelector('.plot')?.dataset.predicted) > 0;
        await page.waitForFunction(isThere, undefined, { timeout: 8000 }).catch(() => undefined);
        await page.waitForTimeout(1500); // for what is asked after a resize, and a draw after it
        await page.screenshot({ path: path.join(pictures, `${name}_${size.width}.png`) });
      }
      await page.setViewportSize(SIZES[0]);
      console.log(name);
    }
  } finally {
    await page.close();
    await server.stop();
  }
}

/** To `e_s` and on at the pace of real time, for what is to be seen live. */
const on =
  (e_s) =>
  async ({ server, control }) => {
    await flyTo(server, e_s);
    await control({ pace: 1 });
    await control({ pause: false });
  };

try {
  await play('nominal', [
    ['first_open', ({ shows }) => shows('guide', /Tell the vehicle where it is/)],
    [
      'armed',
      async ({ page, shows }) => {
        const send = async (words) => {
          await page.keyboard.press('/');
          await page.keyboard.type(words);
          await page.keyboard.press('Enter');
          await shows('dry-run', /✓ It would be sent/);
          await page.keyboard.press('Enter');
        };
        await send('set edl parameters');
        await shows('waiting', /do edl/, 60_000);
        await shows('waiting', /verified/, 60_000);
        await send('do edl');
        await shows('command-armed', /ARMED/);
      },
    ],
  ]);
  await play('nominal_auto', [
    ['cruise', on(-700)],
    ['blackout', on(70)],
    ['parachute', on(264)],
    ['powered_descent', on(385)],
    ['touchdown', on(441)],
    [
      'recording_comes_down',
      async ({ server, page }) => {
        await flyTo(server, 480);
        await page.waitForTimeout(500);
      },
    ],
    [
      'day_after',
      async ({ server, page, control }) => {
        await control({ pace: 100 });
        await control({ pause: false });
        await waitFor(
          async () => (await server.get('/runs')).runs[0]?.state,
          (state) => state === 'finished',
          180_000,
        );
        await page.waitForTimeout(2000);
      },
    ],
    [
      'replay',
      async ({ page, shows }) => {
        await page.keyboard.press('y'); // from the beginning of the landing's timeline
        await shows('badge', /REPLAY, NOT LIVE/);
        await page.waitForTimeout(20_000);
        await page.keyboard.press('p');
      },
    ],
  ]);
  await play('second_chance', [['backup_took_over', on(118)]]);
  await play('nominal_auto', [
    [
      'station_lost',
      async ({ server, control }) => {
        await flyTo(server, 180);
        await control({ inject: { station_outage: { duration_s: 60 } } });
        await control({ pace: 1 });
        await control({ pause: false });
        await new Promise((resolve) => setTimeout(resolve, 8000));
      },
    ],
  ]);
  console.log(`renewed in ${path.relative(root, pictures)}: look at them before you commit them`);
} finally {
  await chrome.close();
  await remove();
}
