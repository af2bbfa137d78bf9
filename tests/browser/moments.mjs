// SPDX-License-Identifier: Apache-2.0
// Renews the pictures of the twelve moments that a console is judged by, at two sizes of a browser's window, from the
// real program: node tests/browser/moments.mjs [MOMENT]... The rehearsal is held, so that both sizes show one instant.
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import {
  browser,
  comesToRest,
  control as order,
  flyTo,
  open,
  root,
  secondsFromEntry,
  serve,
  temporaryFolder,
  waitFor,
} from './support.mjs';

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
  const { page, shows, text } = await open(chrome, server.address, SIZES[0]);
  const control = (body) => order(server, body);
  try {
    await shows('stream-state', /connected[^]*complete through [1-9]/, 60_000);
    await waitFor(
      () => server.get('/runs/latest/prediction'),
      ({ state }) => state !== 'flying',
      120_000,
    );
    for (const [name, bring] of moments) {
      await bring({ server, page, shows, text, control });
      if (wanted.size > 0 && !wanted.has(name)) continue;
      for (const size of SIZES) {
        await page.setViewportSize(size);
        await waitFor(
          () => page.locator('body').innerText(),
          (all) => !/asking…|ground has not answered|connecting/.test(all),
          60_000,
        );
        // what is predicted of the time ahead, where there is any
        const isThere = () => Number(document.querySelector('.plot')?.dataset.predicted) > 0;
        await page.waitForFunction(isThere, undefined, { timeout: 8000 }).catch(() => undefined);
        await comesToRest(page);
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

/** To `e_s`, until the banner says it. */
const at =
  (e_s, says) =>
  async ({ server, shows }) => {
    await flyTo(server, e_s);
    await shows('badge', /paused/);
    await shows('situation-sentence', says);
  };

try {
  await play('nominal', [
    ['first_open', ({ shows }) => shows('guide', /Tell the vehicle where it is/)], // by itself: it goes on
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
    ['cruise', at(-700, /entry antenna/)],
    ['blackout', at(70, /plasma blackout/)],
    ['parachute', at(264, /Waiting for/)],
    ['powered_descent', at(385, /Waiting for/)],
    [
      'touchdown',
      async (of) => {
        await at(441, /Touchdown reported/)(of);
        await of.shows('touchdown', /Touchdown reported/);
      },
    ],
    [
      'recording_comes_down',
      async (of) => {
        await at(480, /The recording comes down/)(of);
        await of.shows('touchdown', /Touchdown confirmed/);
      },
    ],
    [
      'day_after',
      async ({ server, shows, control }) => {
        await control({ pace: 100 });
        await control({ pause: false });
        await waitFor(
          async () => (await server.get('/runs')).runs[0]?.state,
          (state) => state === 'finished',
          180_000,
        );
        await shows('situation-sentence', /The recording is complete/);
        await shows('guide', /You have landed it/);
      },
    ],
    [
      'replay',
      async ({ page, shows, text }) => {
        await page.keyboard.press('y'); // from the beginning of the landing's timeline
        await shows('badge', /REPLAY, NOT LIVE/);
        await waitFor(
          () => text('clock-entry'),
          (value) => secondsFromEntry(value) > 145,
        );
        await page.keyboard.press('p');
        await shows('replay-play', /play/);
      },
    ],
  ]);
  await play('second_chance', [['backup_took_over', at(118, /Flying on backup computer B/)]]);
  await play('nominal_auto', [
    [
      'station_lost',
      async ({ server, shows, control }) => {
        await flyTo(server, 180);
        await control({ inject: { station_outage: { duration_s: 60 } } });
        await flyTo(server, 188);
        await shows('situation-sentence', /A fault on the ground/);
      },
    ],
  ]);
  console.log(`renewed in ${path.relative(root, pictures)}: look at them before you commit them`);
} finally {
  await chrome.close();
  await remove();
}
