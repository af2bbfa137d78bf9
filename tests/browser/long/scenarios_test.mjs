// SPDX-License-Identifier: Apache-2.0
// Every shipped scenario at every size of a window in both themes, at one instant of its landing: nothing is cut off,
// and it looks as stored. AEOLIS_RENEW_PICTURES=1 stores new pictures.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { COARSE, comesToLook } from '../picture.mjs';
import { SIZES } from '../sizes.mjs';
import { comesToRest, program, root, temporaryFolder, waitFor, workplace } from '../support.mjs';
import { keepWhatIsWritten, notWhole } from '../texts.mjs';

const { open, serve } = workplace({ scrollbars: true });
const UNTIL_E_S = 105; // soon after the blackout; in second_chance the backup has just taken over

const SCENARIOS = readdirSync(path.join(root, 'simulation/scenarios'))
  .filter((file) => file.endsWith('.textproto'))
  .map((file) => path.basename(file, '.textproto'));

for (const scenario of SCENARIOS)
  test(`${scenario} is whole and looks as stored at every size in both themes`, async (t) => {
    const { folder, remove } = await temporaryFolder();
    t.after(remove);
    const archive = path.join(folder, 'flown.db');
    const flown = spawnSync(program, ['rehearse', '--scenario', scenario, '--archive', archive], { encoding: 'utf8' });
    assert.ok([0, 1].includes(flown.status) && existsSync(archive), flown.stderr); // 1: it did not land
    const server = await serve(t, 'flown', [], { archive });
    // the first pictures were without what is predicted, the later ones with it
    await waitFor(async () => (await server.get('/runs/1/prediction')).state, /^(?!flying)./);
    const { page, problems, shows } = await open(
      `${server.address}/?run=1&past=-60,${UNTIL_E_S}`,
      { width: 1440, height: 790 },
      keepWhatIsWritten,
    );
    await shows('past-bar', /E/);
    await waitFor(
      () => page.locator('body').innerText(),
      (all) => !/asking…|has not answered|connecting|Loading …/.test(all),
    );
    const found = [];
    for (const theme of ['dark', 'light']) {
      await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
      for (const [width, height] of SIZES) {
        await page.setViewportSize({ width, height });
        await comesToRest(page);
        found.push(...(await page.evaluate(notWhole)).map((words) => `${theme}, ${width} × ${height}: ${words}`));
        found.push(...(await comesToLook(page, `scenarios/${scenario}_${width}_${theme}`, page, COARSE)));
      }
    }
    assert.deepEqual([...found, ...problems], []);
    await page.close();
  });
