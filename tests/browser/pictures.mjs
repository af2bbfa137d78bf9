// SPDX-License-Identifier: Apache-2.0
// Renews the pictures of README and docs/user-guide.md from the real program: node tests/browser/pictures.mjs
import path from 'node:path';
import {
  browser,
  focused,
  open,
  root,
  secondsFromEntry,
  serve,
  setPace,
  stageLook,
  temporaryFolder,
  waitFor,
} from './support.mjs';

const pictures = path.join(root, 'docs/pictures');
const { folder, remove } = await temporaryFolder();
const chrome = await browser();
const server = await serve({ archive: path.join(folder, 'pictures.db'), more: ['--scenario', 'nominal'] });

/** Waits until the page is complete: connected, with data, a named phase, and no request under way. */
const settled = async (shown) => {
  const words = (id) => shown.getByTestId(id).innerText();
  await waitFor(() => words('stream-state'), /connected[^]*complete through [1-9]/, 60_000);
  await waitFor(() => words('phases'), /▶|✓ Touchdown/, 60_000);
  await waitFor(
    () => shown.locator('body').innerText(),
    (all) => !/asking…|has not answered|connecting/.test(all),
    60_000,
  );
  await shown.waitForTimeout(500); // for the history and a draw after it
};

try {
  const { page, text, shows } = await open(chrome, server.address, { width: 1600, height: 900 });
  const take = async (name, what = page) => {
    await settled(page);
    await what.screenshot({ path: path.join(pictures, name), animations: 'disabled' });
  };
  const panel = (name) => page.getByTestId(name);

  await shows('guide', /Tell the vehicle where it is/);
  await shows('waiting', /set edl parameters/);
  await shows('phases', /▶\s*Cruise/);
  await take('tour_begin.png');

  await page.setViewportSize({ width: 1600, height: 1440 }); // a whole review fits
  await page.keyboard.press('/');
  await page.keyboard.type('set edl parameters');
  await page.keyboard.press('Enter');
  await shows('dry-run', /✓ It would be sent/);
  await take('tour_dry_run.png', panel('panel-commands'));
  await page.setViewportSize({ width: 1600, height: 1160 });
  await page.getByTestId('controller').fill('Ada'); // the review does not judge unsigned actions
  await shows('dry-run', /✓ It would be sent/);
  await page.getByTestId('controller').press('Enter');
  await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/, 30_000);
  await shows('guide', /Let it begin/);
  await waitFor(() => focused(page), /command-line/);
  await page.keyboard.type('do edl');
  await page.keyboard.press('Enter');
  await shows('dry-run', /✓ It would be sent once it is armed/);
  await page.keyboard.press('Enter');
  await shows('command-armed', /ARMED/);
  await page.keyboard.type('EDL_DO');
  await take('tour_armed.png', panel('panel-commands'));
  await page.keyboard.type('_EDL');
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_DO_EDL is #2/);
  await page.keyboard.press('Escape');
  await page.setViewportSize({ width: 1600, height: 900 });

  await setPace(page, 100);
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 130,
    180_000,
  );
  await setPace(page, 10);
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 266,
    180_000,
  );
  await page.keyboard.press('p');
  await shows('badge', /paused/);
  await page.setViewportSize({ width: 1920, height: 1080 });
  await page.waitForTimeout(500);
  await take('console_mid_entry.png');
  await page.setViewportSize({ width: 1600, height: 900 });
  const post = (path, body) => fetch(`${server.address}/api/v1${path}`, { method: 'POST', body: JSON.stringify(body) });
  await post('/rehearsals/current', {
    inject: {
      device_fault: {
        device: 'DEVICE_RADAR',
        unit: 'REDUNDANT_UNIT_B',
        kind: 'DEVICE_FAULT_KIND_SILENT',
        duration_s: 20,
      },
    },
  });
  await post('/rehearsals/current', { note: { by: 'Ida', text: 'The spare radar is silent. Who sees it first?' } });
  await page.keyboard.press('p');
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 290,
    180_000,
  );
  await post('/runs/latest/notes', { by: 'Bob', text: 'Radar B does not answer; A is in use.' });
  await post('/rehearsals/current', { note: { by: 'Ida', text: 'Bob, in his own table; nobody said it aloud.' } });
  await setPace(page, 100);
  await waitFor(
    () => page.locator('[data-event="TOUCHDOWN"]').count(),
    (count) => count === 1,
    180_000,
  );
  await shows('waiting', /Touchdown (reported|confirmed)/, 180_000);
  await page.keyboard.press('v');
  await shows('verdict-sentence', /bit for bit/, 30_000);
  await shows('verdict-count', /^none$/);
  await take('tour_landed.png');

  await page.goto(`${server.address}/?panel=rehearsal`);
  await waitFor(
    () => page.getByTestId('review').count(),
    (reviews) => reviews === 1,
    180_000,
  );
  await page.locator('[data-testid="review"] > summary').click();
  await shows('review-score', /of 100/, 60_000);
  await shows('review-facts', /km from the target/, 60_000);
  await take('review.png', page.locator('main > .panel'));

  await page.goto(`${server.address}/?panel=packets`);
  await shows('phases', /✓\s*Touchdown/, 60_000);
  await page.setViewportSize({ width: 1600, height: 760 });
  await page.getByRole('button', { name: 'GncNavigation', exact: true }).click();
  await page.keyboard.press('ArrowDown');
  await shows('packet', /packet \d/);
  await page.getByTestId('packet-fields').focus();
  for (let field = 0; field < 9; ++field) await page.keyboard.press('ArrowDown');
  await take('tour_packet.png');
  await page.goto(`${server.address}/?panel=campaigns`);
  await page.getByTestId('campaign-cases').fill('100');
  await page.getByTestId('campaign-cases').press('Enter');
  await waitFor(
    async () => Number(/(\d+) of 100/.exec(await text('campaign-state'))?.[1]),
    (kept) => kept >= 60,
    400_000,
  );
  await take('tour_campaign.png', page.locator('main > .panel'));
  await page.close();

  const others = await serve({
    archive: path.join(folder, 'users.db'),
    more: ['--scenario', 'nominal', '--accounts', path.join(folder, 'accounts.json')],
  });
  try {
    const { page: admin } = await open(chrome, others.address, { width: 1600, height: 900 });
    await waitFor(async () => others.said(), /administrator with \S+/);
    const given = /administrator with (\S+)/.exec(others.said())[1];
    await admin.getByTestId('log-in-user').fill('administrator');
    await admin.getByTestId('log-in-password').fill(given);
    await admin.keyboard.press('Enter');
    for (const [field, value] of [
      ['given', given],
      ['chosen', 'an own long password'],
      ['again', 'an own long password'],
    ])
      await admin.getByTestId(`password-${field}`).fill(value);
    await admin.keyboard.press('Enter');
    await admin.getByTestId('who').waitFor();
    await admin.goto(`${others.address}/?panel=users`);
    for (const [user, role] of [
      ['ada', 'director'],
      ['carl', 'controller'],
      ['eve', 'observer'],
    ]) {
      await admin.getByLabel('name of the new user').fill(user);
      await admin.getByLabel('password of the new user').fill('given by another');
      await admin.getByLabel('role of the new user').selectOption(role);
      await admin.keyboard.press('Enter');
      await admin.locator(`[data-user="${user}"]`).waitFor();
    }
    await admin.setViewportSize({ width: 1600, height: 720 });
    await admin.reload();
    await waitFor(() => admin.getByTestId('audit').innerText(), /eve/);
    await settled(admin);
    await admin.screenshot({ path: path.join(pictures, 'users.png'), animations: 'disabled' });
  } finally {
    await others.stop();
  }
  console.log(`renewed in ${path.relative(root, pictures)}: look at them before you commit them`);
} finally {
  await server.stop();
  await chrome.close();
  await remove();
}
