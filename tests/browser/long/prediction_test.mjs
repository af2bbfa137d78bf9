// SPDX-License-Identifier: Apache-2.0
// What is predicted, beside a run that is live, one that is over, and a past of it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { comesToRest, findings, flyTo, waitFor, workplace } from '../support.mjs';
import { keepWhatIsWritten } from '../texts.mjs';

const { open, serve } = workplace();

/** In the page: where a plot says of its hollow dot that it is predicted, and whether its title is whole. */
function wordsOfPlot(plot) {
  const panel = document.querySelector(plot);
  const title = panel.querySelector('h2');
  return {
    head: panel.querySelector('.plot-difference i').checkVisibility(),
    dot: window.writtenOn(panel.querySelector('canvas')).some(({ words }) => words === 'predicted'),
    title: title.innerText,
    whole: title.scrollWidth <= title.clientWidth,
  };
}

test('the nominal flight stands faint under a live run, ahead of it, and beside what was observed; after landing too', async (t) => {
  const server = await serve(t, 'prediction', ['--scenario', 'nominal_auto', '--pace', '20']);
  const { page, problems, text, shows } = await open(server.address, { width: 1920, height: 950 }, keepWhatIsWritten);
  await flyTo(server, 60); // in the plasma blackout
  await waitFor(() => server.get('/runs/1/prediction').then(({ state }) => state), /ready/);
  const plot = page.locator('.panel-plot-altitude .plot');
  const ahead = async () => Number(await plot.getAttribute('data-predicted'));
  await waitFor(ahead, (samples) => samples > 300); // the whole landing, at 1 Hz
  assert.match(await text('stale-altitude'), /◌ 1\d s/);

  // The hollow dot has its word: in the plot's head, or where that is too narrow beside the dot.
  for (const [width, height] of [
    [1920, 950],
    [1440, 790],
    [1366, 650],
    [1280, 585],
  ]) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    const named = () => page.evaluate(wordsOfPlot, '.panel-plot-altitude');
    await waitFor(named, ({ head, dot }) => head !== dot); // by one of the two
    const { title, whole } = await named();
    assert.ok(whole, `${width}: the title is cut off, ${title}`);
  }
  await page.setViewportSize({ width: 1920, height: 950 });
  await comesToRest(page);

  const observe = async (part) => {
    const box = await plot.locator('.u-over').boundingBox();
    await page.mouse.move(box.x + box.width * part, box.y + box.height / 2);
  };
  await observe(0.1);
  await shows('tip-altitude', /^observed\s*\d+\.\d\d\s*predicted\s*\d+\.\d\d\s*difference\s*[+-]?\d+\.\d\d$/);
  await observe(0.9);
  await shows('tip-altitude', /^predicted\s*\d+\.\d\d$/);
  await page.mouse.move(5, 5);

  const button = page.locator('.panel-plot-altitude .plot-difference');
  await page.keyboard.press('Escape'); // out of the command line
  await page.keyboard.press('j');
  await waitFor(() => button.getAttribute('aria-pressed'), /true/);
  await waitFor(ahead, (samples) => samples < 20); // a difference has nothing ahead
  await shows('reading-altitude', /^[+-]?\d\.\d\d$/);
  for (const theme of ['dark', 'light']) {
    await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
    assert.deepEqual(await findings(page, theme), []);
  }
  await button.click();
  await waitFor(() => button.getAttribute('aria-pressed'), /false/);

  const control = (body) =>
    fetch(`${server.address}/api/v1/rehearsals/current`, { method: 'POST', body: JSON.stringify(body) });
  await control({ pace: 0 });
  await control({ pause: false });
  await waitFor(() => server.get('/runs/1').then(({ state }) => state), /finished/);
  await page.reload();
  await shows('touchdown-figures', /against predicted\s*[+−]\d+\.\d s/);
  const { events } = await server.get('/runs/1/prediction');
  const at = events.find(({ name }) => name === 'touchdown').e_s;
  const predicted = `E+${Math.floor(at / 60)}:${(at % 60).toFixed(1).padStart(4, '0')}`;
  assert.equal(await page.locator(`[title*="of ${predicted} in the nominal flight"]`).count(), 1, predicted);
  await page.keyboard.press('y'); // a past of it
  await shows('reading-of-past', /As it was heard then/);
  await waitFor(ahead, (samples) => samples > 100);
  assert.deepEqual(problems, []);
  await page.close();
});
