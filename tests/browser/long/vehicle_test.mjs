// SPDX-License-Identifier: Apache-2.0
// A landing as the panel of the vehicle shows it: the picture and the same facts as text at four moments, flat where
// there is no WebGL, as last heard in a silence, and the result in its place after touchdown.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import { after, test } from 'node:test';
import { browser, comesToRest, findings, flyTo, open as openIn, root, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
const pictures = path.join(root, 'build/test/vehicle'); // to look at
mkdirSync(pictures, { recursive: true });

const MOMENTS = [
  {
    name: 'entry',
    e_s: 40,
    scenery: 'entry',
    rows: /backshell, heatshield[^]*from the motion[^]*lift up to the right/,
  },
  { name: 'parachute', e_s: 320, scenery: 'parachute', rows: /parachute, backshell[^]*engines still inside/ },
  { name: 'powered', e_s: 395, scenery: 'descent', rows: /descent stage with the rover[^]*kN, 8 engines at \d+ %/ },
  { name: 'crane', e_s: 425, scenery: 'crane', rows: /the rover below it on its bridle[^]*kN, 4 engines at \d+ %/ },
];
const SETTLES_MS = 1500; // the picture eases to what is told, slowly where there is no graphics processor

/** Runs in the page: how many colours, of 32 shades each, the picture has. */
async function coloursOf(png) {
  const image = new Image();
  image.src = `data:image/png;base64,${png}`;
  await image.decode();
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext('2d');
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, image.width, image.height);
  const seen = new Set();
  for (let i = 0; i < data.length; i += 4)
    seen.add(((data[i] >> 3) << 10) | ((data[i + 1] >> 3) << 5) | (data[i + 2] >> 3));
  return seen.size;
}
const FEW = 60; // a panel with figures alone has fewer colours

async function looks(page, name) {
  let colours = 0;
  await waitFor(
    async () => {
      const png = await page.getByTestId('vehicle-stage').screenshot();
      colours = await page.evaluate(coloursOf, png.toString('base64'));
      return colours;
    },
    (count) => count > FEW,
  );
  await page.waitForTimeout(SETTLES_MS);
  await page.screenshot({ path: path.join(pictures, `${name}.png`) });
}

test('at four moments of a landing the picture and its text show what was told, in both themes, and nothing shifts', async (t) => {
  const server = await serve(t, 'vehicle', ['--scenario', 'nominal_auto', '--pace', '100']);
  const { page, problems, shows, text } = await open(server.address, { width: 1440, height: 790 }, () => {
    window.shifted = []; // what moved in the panel, and how
    new PerformanceObserver((list) => {
      for (const { node, previousRect: from, currentRect: to } of list.getEntries().flatMap((each) => each.sources))
        if (node?.parentElement?.closest('main'))
          window.shifted.push(
            `${node.className || node.textContent}: ${[from, to].map((r) => `${r.x},${r.y}`).join(' → ')}`,
          );
    }).observe({ type: 'layout-shift' });
  });
  await page.goto(`${server.address}/?panel=vehicle`);
  await shows('vehicle-said', /attitude not received yet/);
  await shows('vehicle-rows', /cruise stage, backshell, heatshield/);
  await shows('vehicle-renderer', /^3-D/);
  await comesToRest(page);
  await page.evaluate(() => (window.shifted = []));
  for (const { name, e_s, scenery, rows } of MOMENTS) {
    await flyTo(server, e_s);
    await waitFor(() => page.getByTestId('vehicle-stage').getAttribute('data-scenery'), new RegExp(`^${scenery}$`));
    await shows('vehicle-rows', rows);
    await waitFor(
      () => text('vehicle-said'),
      (said) => said.trim() === '',
    );
    await looks(page, name);
    assert.deepEqual(await findings(page, 'dark'), [], name);
    if (name === 'entry') {
      await flyTo(server, 70);
      await shows('vehicle-said', /as last heard, \d+ s ago/);
      await shows('vehicle-figures', /◌ \d+ s/);
      await looks(page, 'blackout');
    }
  }
  assert.deepEqual(await page.evaluate(() => window.shifted), []);
  await page.evaluate(() => (document.documentElement.dataset.theme = 'light'));
  await looks(page, 'crane_light');
  assert.deepEqual(await findings(page, 'light'), []);
  await flyTo(server, 455);
  await shows('touchdown', /Touchdown confirmed[^]*E\+7:1\d[^]*3 of 3 signals/);
  await shows('touchdown-steps', /rover's own IMU still for 10 s[^]*still since E\+7:[^]*rover_imu_rate_rps/);
  await shows('touchdown-figures', /0\.\d\d m\/s[^]*from the target[^]*\d+ m[^]*kg/);
  await page.screenshot({ path: path.join(pictures, 'touchdown_light.png') });
  await page.goto(server.address);
  await shows('touchdown', /Touchdown confirmed/);
  await page.getByTestId('descent-result').click();
  await page.getByTestId('descent-canvas').waitFor();
  await page.keyboard.press('b'); // the picture as a tab, of its result
  await waitFor(() => page.getByTestId('vehicle').innerText(), /the result/);
  assert.deepEqual(problems, []);
  await page.close();
});

let chrome;
after(() => chrome?.close());

test('without WebGL the picture is flat, says so, and shows the same', async (t) => {
  const server = await serve(t, 'flat', ['--scenario', 'nominal_auto', '--pace', '100']);
  await flyTo(server, -600);
  chrome = await browser({ more: ['--disable-software-rasterizer'] });
  const { page, shows } = await openIn(chrome, `${server.address}/?panel=vehicle`, { width: 1440, height: 790 });
  await shows('vehicle-renderer', /^flat: no 3-D here/);
  for (const { name, e_s, rows } of MOMENTS) {
    await flyTo(server, e_s);
    await shows('vehicle-rows', rows);
    await page.getByTestId('vehicle-flat').waitFor();
    await looks(page, `flat_${name}`);
  }
  assert.deepEqual(await findings(page, 'dark'), []);
  await page.close();
});
