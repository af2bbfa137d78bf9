// SPDX-License-Identifier: Apache-2.0
// Windows that people have: nothing is cut off, over another or broken inside a number, no control reaches out of its
// box; the longer list is long/sizes_test.mjs.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { measured } from './sizes.mjs';
import { breakable, comesToRest, flyTo, workplace } from './support.mjs';

const here = workplace({ scrollbars: true });
const { open, serve } = here;

test('on a low laptop, a laptop, a wall and a telephone all texts and controls are whole, and so are header, command line and what is armed', async (t) => {
  const sizes = [
    [1280, 585],
    [1440, 790],
    [1920, 950],
    [390, 700],
  ];
  assert.deepEqual(await measured(here, t, ['armed', 'mid entry', 'touchdown', 'poll'], sizes), []);
});

test('at the first open nothing on the right is scrolled for: what to type, the guide and the command line are whole', async (t) => {
  const server = await serve(t, 'first', ['--scenario', 'nominal']);
  const { page, problems, shows } = await open(server.address, { width: 1920, height: 950 });
  await shows('waiting', /Type “set edl parameters”/);
  await shows('panel-commands', /no command in this run yet/);
  for (const [width, height] of [
    [1920, 950],
    [1440, 790],
  ]) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    const scrolled = await page
      .locator('.right > .waiting, .right > .guide, .right .panel-commands .panel-body')
      .evaluateAll((all) =>
        all.filter((each) => each.scrollHeight > each.clientHeight + 1).map((each) => each.className),
      );
    assert.deepEqual(scrolled, [], `${width} × ${height}`);
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test('no panel moves for the header when the connection breaks, and nothing is counted down without one', async (t) => {
  const server = await serve(t, 'broken', ['--scenario', 'nominal_auto', '--pace', '100']);
  await flyTo(server, 110);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, shows } = await open(way.address, { width: 1440, height: 790 });
  await shows('phase-now', /parachute in ≈ /);
  await shows('waiting', /in ≈ /);
  const heights = async () => {
    const all = [];
    for (const width of [390, 900, 1280, 1440, 1920]) {
      await page.setViewportSize({ width, height: 790 });
      await comesToRest(page);
      all.push(`${width}: ${(await page.getByTestId('header').boundingBox()).height}`);
    }
    return all;
  };
  const before = await heights();
  way.cut();
  await shows('situation-sentence', /NO CONNECTION/);
  assert.deepEqual(await heights(), before);
  await shows('phase-now', /parachute predicted E\+/);
  assert.doesNotMatch(await page.locator('body').innerText(), /in ≈/);
  await page.close();
});
