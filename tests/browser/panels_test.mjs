// SPDX-License-Identifier: Apache-2.0
// One pass over the panels of an ended run: each shows its content, five match stored pictures, and the script is as
// small as promised.
import assert from 'node:assert/strict';
import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import { before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { PANELS } from './panels.mjs';
import { comesToLook } from './picture.mjs';
import { findings, landed, root, waitFor, workplace } from './support.mjs';

const SCRIPT_KB = 150;
const TYPE_KB = 120;
/** A text in each panel that only this landing could produce. */
const SHOWN = {
  timeline: /(\d+) of \1 timepoints fired/,
  descent: /Touchdown confirmed[^]*3 of 3 signals/,
  phases: /✓ Cruise[^]*✓ Touchdown/,
  tones: /Last tone, E\+\d+:\d\d/,
  plots: /Altitude[^]*\d km[^]*Deceleration[^]*\d g/,
  events: /The EDL recording is closed/,
  waiting: /Outcome: touchdown\. The recording is complete\./,
  commands: /EDL_DO_EDL #2[^]*EDL_SET_PARAMETERS #1/,
  channels: /altitude_m, descent stage\s+-?\d/,
  alarms: /no alarm/, // a landing without a fault raises none
  procedures: /Commanding closed[^]*Start of entry, descent and landing[^]*UHF lost/,
  notes: /nothing is written down yet/,
  packets: /EdlStatus\s+\d/,
  verdicts: /✓ All .* bit for bit/,
  links: /UHF[^]*%[^]*X-band carrier[^]*lost since E\+\d:\d\d[^]*parachute seen by Doppler/,
  flown: /(\d+) of \1 timepoints fired[^]*descent_imu_power/,
  recorded: /A range of this run/,
  rehearsal: /Review of run 1/,
  campaigns: /No campaign lies beside this archive/,
  what_if: /Go on otherwise[^]*fork run 1[^]*What would come of it[^]*the truth[^]*there is no other run/,
  vehicle: /Touchdown confirmed[^]*from the target[^]*✓\s+touchdown told[^]*The recording is complete/,
  users: /This server runs without accounts/,
};

const { open, serve } = workplace();
let server;

before(async () => {
  server = await landed(serve);
});

test('each panel shows what it is for, and says that it is of an ended rehearsal', async () => {
  const { page, problems, shows } = await open(server.address);
  for (const panel of PANELS) {
    await page.goto(`${server.address}/?panel=${panel}`);
    await shows('badge', /ENDED RUN/);
    if (panel !== 'phases')
      await waitFor(
        () => page.getByTestId('mode-mark').allInnerTexts(),
        (marks) => marks.length > 0 && marks.every((mark) => /ended, rehearsal/.test(mark)),
      );
    const what = page.locator(panel === 'phases' ? '.strip' : 'main');
    await waitFor(() => what.innerText(), SHOWN[panel]);
  }
  await page.goto(server.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  assert.deepEqual(await findings(page, 'dark'), []);
  assert.deepEqual(problems, []);
  await page.close();
});

test('the table of channels has names, aliases, descriptions and units as msl.xml has them', async () => {
  const xml = await readFile(path.join(root, 'dictionaries/msl/msl.xml'), 'utf8');
  const units = new Map(
    [...xml.matchAll(/<\w+ParameterType name="(\w+)"[^>]*>\s*<UnitSet><Unit>([^<]*)<\/Unit><\/UnitSet>/g)].map(
      ([, type, unit]) => [type, unit],
    ),
  );
  const written = new Map(
    [
      ...xml.matchAll(
        /<Parameter name="(\w+)" parameterTypeRef="(\w+)" shortDescription="([^"]*)">\s*<AliasSet><Alias nameSpace="channel" alias="([\w-]+)"/g,
      ),
    ].map(([, name, type, description, alias]) => [name, { alias, description, unit: units.get(type) ?? '' }]),
  );
  const { page, problems, shows } = await open(server.address);
  await page.goto(`${server.address}/?panel=channels`);
  await shows('badge', /ENDED RUN/);
  for (const prefix of ['gnc-', 'ent-', 'par-', 'pyr-']) {
    await page.getByTestId('channel-filter').fill(prefix);
    await shows('channel-table', new RegExp(prefix, 'i'));
    const rows = await page.getByTestId('channel-table').evaluate((table) =>
      [...table.querySelectorAll('tbody tr')].map((row) => ({
        name: row.dataset.testid.replace('channel-', ''),
        alias: row.cells[1].querySelector('.alias').textContent,
        title: row.cells[1].title.split('\n')[0],
        unit: row.cells[3].textContent,
      })),
    );
    assert.ok(rows.length > 5, `${prefix}: ${rows.length} rows`);
    for (const { name, alias, title, unit } of rows) {
      const is = written.get(name);
      assert.ok(is, `msl.xml has no channel ${name}`);
      assert.deepEqual({ alias, title, unit }, { alias: is.alias, title: `${name}: ${is.description}`, unit: is.unit });
    }
  }
  assert.deepEqual(problems, []);
  await page.close();
});

test('a list of which more is below fades out at its foot, until its end is in sight', async () => {
  const { page, problems } = await open(server.address, { width: 1440, height: 790 });
  const list = page.getByTestId('event-list');
  const fades = () => list.evaluate((each) => getComputedStyle(each).maskImage !== 'none');
  const isTrue = (value) => value;
  const isFalse = (value) => !value;

  await waitFor(fades, isTrue);
  // Again and again: events that still come lengthen the list.
  await waitFor(async () => {
    await list.evaluate((each) => each.scrollTo(0, each.scrollHeight));
    return fades();
  }, isFalse);
  await list.evaluate((each) => each.scrollTo(0, 0));
  await waitFor(fades, isTrue);
  await page.getByTestId('event-search').fill('no event says this');
  await waitFor(fades, isFalse);

  assert.deepEqual(problems, []);
  await page.close();
});

test('the console, its timeline and plots, its channels and its command line come to look as stored', async () => {
  const { page, problems, shows } = await open(server.address, { width: 1000, height: 640 });
  const different = [];
  for (const panel of ['timeline', 'plots', 'channels', 'commands']) {
    await page.goto(`${server.address}/?panel=${panel}`);
    await shows('badge', /ENDED RUN/);
    different.push(...(await comesToLook(page, `${panel}_dark`, page.locator('main'))));
  }
  await page.setViewportSize({ width: 1600, height: 900 });
  await page.goto(server.address);
  await shows('waiting', /Touchdown (reported|confirmed)/);
  await shows('touchdown-figures', /from the target\s+\d/);
  different.push(...(await comesToLook(page, 'console_dark', page)));
  assert.deepEqual(different, []);
  assert.deepEqual(problems, []);
  await page.close();
});

test('the script of the first load is at most 150 kB, compressed', async () => {
  const assets = path.join(root, 'web/dist/assets');
  const html = await readFile(path.join(root, 'web/dist/index.html'), 'utf8');
  const scripts = (await readdir(assets)).filter(
    (name) => name.endsWith('.js') && (html.includes(name) || name.startsWith('worker-')),
  );
  const sizes = await Promise.all(
    scripts.map(async (name) => gzipSync(await readFile(path.join(assets, name))).length / 1000),
  );
  const sum = sizes.reduce((total, size) => total + size, 0);
  assert.ok(scripts.length >= 2 && sum > 1, 'no built scripts');
  assert.ok(sum <= SCRIPT_KB, `${sum.toFixed(1)} kB`);
});

test('the type of the console is at most 120 kB, and nothing else is loaded for it', async () => {
  const assets = path.join(root, 'web/dist/assets');
  const html = await readFile(path.join(root, 'web/dist/index.html'), 'utf8');
  const files = (await readdir(assets)).filter((name) => /\.(woff2?|ttf|otf)$/.test(name));
  assert.deepEqual(
    files.filter((name) => !html.includes(name)),
    [],
    'not preloaded',
  );
  const sizes = await Promise.all(files.map(async (name) => (await readFile(path.join(assets, name))).length / 1000));
  const sum = sizes.reduce((total, size) => total + size, 0);
  assert.ok(files.length === 2 && sum <= TYPE_KB, `${files.length} files, ${sum.toFixed(1)} kB`);
});
