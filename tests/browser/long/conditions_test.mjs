// SPDX-License-Identifier: Apache-2.0
// A console under adverse conditions: a second browser, a slow connection, a wrong clock, a huge dictionary with
// hostile names, a run that is gone.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import { standIn } from '../stand_in.mjs';
import { control, flyTo, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

const through = async (text) => Number((await text('complete-through')).replace(/\D/g, ''));
/** The table’s cells for each channel, without ages; rows out of sight have no innerText. */
const values = (page) =>
  page.locator('[data-testid="channel-table"] tbody tr').evaluateAll((rows) =>
    rows.map((row) =>
      [...row.cells]
        .slice(0, 4)
        .map((cell) => cell.textContent)
        .join(' | '),
    ),
  );

test('two browsers agree on every value at the same sequence number, and one whose clock is days off shows the same times', async (t) => {
  const server = await serve(t, 'two', ['--scenario', 'nominal_auto', '--pace', '50']);
  await control(server, { pause: true });
  const one = await open(server.address);
  await flyTo(server, -900);
  await waitFor(
    () => through(one.text),
    (items) => items > 1000,
  ); // the other console joins late
  const other = await open(server.address, { width: 1600, height: 900 }, () => {
    const Real = Date;
    globalThis.Date = class extends Real {
      constructor(...of) {
        super(...(of.length > 0 ? of : [Real.now() + 3 * 86_400_000]));
      }
      static now() {
        return Real.now() + 3 * 86_400_000;
      }
    };
  });
  await other.shows('stream-state', /connected/);
  await flyTo(server, -500); // navigation has begun
  await one.shows('badge', /paused/);
  await waitFor(
    () => one.text('timepoints-fired'),
    (fired) => Number.parseInt(fired, 10) >= 3,
  );
  let before;
  let [seen, seenToo] = [[], []];
  // Rows out of sight take turns, so a row that differs now may agree later. Rows that never agree are reported below.
  await waitFor(
    async () => {
      const now = [
        await through(one.text),
        await through(other.text),
        Number((await server.get('/runs')).runs[0].last_seq),
      ];
      const settled = new Set(now).size === 1 && now[0] === before;
      before = now[0];
      [seen, seenToo] = [await values(one.page), await values(other.page)];
      return settled && isDeepStrictEqual(seenToo, seen);
    },
    (agree) => agree === true,
  ).catch(() => undefined);
  assert.equal(await through(other.text), await through(one.text));
  assert.ok(seen.length > 100 && seen.some((row) => /altitude_m \| \d/.test(row)), `${seen.length} rows`);
  assert.deepEqual(seenToo, seen);
  for (const id of ['clock-entry', 'clock-ert', 'clock-scet', 'clock-sclk', 'timepoints-fired', 'phases', 'tone-title'])
    assert.equal(await other.text(id), await one.text(id), id);
  const events = (page) => page.locator('[data-event]').evaluateAll((rows) => rows.map((row) => row.innerText));
  assert.deepEqual(await events(other.page), await events(one.page));
  assert.deepEqual([...one.problems, ...other.problems], []);
  await one.page.close();
  await other.page.close();
});

test('over a slow way it comes up, follows, and has in the end what the server has', async (t) => {
  const server = await serve(t, 'slow', ['--scenario', 'nominal_auto', '--pace', '20']);
  await flyTo(server, -1100);
  const { page, problems, text, shows } = await open('about:blank');
  const cdp = await page.context().newCDPSession(page);
  await cdp.send('Network.enable');
  await cdp.send('Network.emulateNetworkConditions', {
    offline: false,
    latency: 400,
    downloadThroughput: 60_000,
    uploadThroughput: 20_000,
  });
  await page.goto(server.address);
  await shows('badge', /REHEARSAL|ENDED/);
  await shows('stream-state', /connected/);
  const before = await waitFor(() => text('clock-entry'), /E[−+]\d+:\d\d/);
  await control(server, { pace: 20 });
  await control(server, { pause: false });
  await waitFor(
    () => text('clock-entry'),
    (now) => now !== before,
  );
  await control(server, { pause: true });
  await shows('badge', /paused/);
  await waitFor(
    async () => (await through(text)) === Number((await server.get('/runs')).runs[0].last_seq),
    (same) => same === true,
  );
  assert.doesNotMatch(await text('stream-state'), /gaps/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a dictionary of 20 000 channels with hostile names is searched at once, and nothing of it is taken for markup', async (t) => {
  const server = await serve(t, 'many', ['--scenario', 'nominal_auto', '--pace', '1']);
  const words = await server.get('/dictionary');
  const hostile = '<img src=x onerror="window.hit=1">';
  const channels = [...words.channels];
  for (let id = 50_000; channels.length < 20_000; ++id)
    channels.push({
      id,
      name: id % 1000 === 0 ? `${hostile}${id}` : `made_${id}`,
      alias: '',
      unit: '<b>m</b>',
      text: hostile,
      labels: [],
      limits: [],
      packet: `P${id >> 5}`,
      expected_rate_hz: 1,
    });
  const commands = words.commands.map((each, i) => (i === 0 ? { ...each, text: hostile } : each));
  const way = await standIn(server.address, { 'GET /dictionary': () => [200, { ...words, channels, commands }] });
  t.after(() => way.close());
  const { page, problems, text, shows } = await open(way.address);
  await shows('stream-state', /connected/);
  await waitFor(() => text('clock-entry'), /E/);
  // Processor time of the page's main thread: the clock would judge how busy the machine is.
  const cdp = await page.context().newCDPSession(page);
  await cdp.send('Performance.enable');
  const spent_s = async () =>
    (await cdp.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'ThreadTime').value;
  const began_s = await spent_s();
  await page.getByTestId('channel-filter').fill('made_69');
  await waitFor(
    () => page.locator('[data-testid="channel-made_69001"]').count(),
    (rows) => rows === 1,
  );
  const took_s = (await spent_s()) - began_s;
  assert.ok(took_s > 0 && took_s < 2, `${took_s} s`);
  await page.getByTestId('channel-filter').fill('onerror');
  await waitFor(
    () => page.locator('[data-testid="channel-table"] tbody tr').count(),
    (rows) => rows >= 10,
  );
  await page.keyboard.press('Escape');
  await page.keyboard.press('/');
  await page.keyboard.type('no op');
  await page.keyboard.press('Enter');
  await shows('dry-run', /It would be sent/);
  assert.equal(await page.evaluate(() => window.hit), undefined);
  assert.equal(await page.locator('img').count(), 0);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a run that is not there, and one that vanishes with its server, are said to be gone', async (t) => {
  const first = await serve(t, 'vanishing', ['--scenario', 'nominal_auto', '--pace', '100']);
  const { page, problems, text, shows } = await open(`${first.address}/?run=77`);
  await shows('notices', /Run 77 is not in this archive/);
  await shows('badge', /run 1/);
  await waitFor(() => text('timepoints-fired'), /^[1-9]/);
  await first.kill();
  await shows('stream-state', /NO CONNECTION/);
  assert.match(await text('timepoints-fired'), /^[1-9]/, 'what was seen stays to be read');
  const without = await serve(t, 'without_a_run', [], { port: first.port });
  await shows('notices', /The server has another archive now: run 1, nominal_auto, which was shown here, is not in it/);
  await shows('badge', /NO RUN/);
  await shows('stream-state', /connected/);
  assert.equal(await page.getByTestId('pace-bar').count(), 0, 'there is nothing whose pace could be changed');
  assert.ok(await page.getByTestId('command-line').isDisabled());
  await without.kill();
  assert.deepEqual(problems, []);
  await page.close();
});

for (const [which, address] of [
  ['followed', ''],
  ['chosen by its number', '?run=1'],
]) {
  test(`a run that is ${which} is not taken for another archive’s run of its number, and nothing is sent to that`, async (t) => {
    const first = await serve(t, `before${address.length}`, ['--scenario', 'nominal_auto', '--pace', '100']);
    const { page, problems, text, shows } = await open(`${first.address}/${address}`);
    await waitFor(() => text('timepoints-fired'), /^[1-9]/);
    await page.keyboard.press('/');
    await page.keyboard.type('no op');
    await page.keyboard.press('Enter');
    await first.kill();
    // A command under way when the first server died could reach the second, and no page can take it back; so this
    // begins once the loss is known.
    await shows('stream-state', /NO CONNECTION/);
    const asked = [];
    const note = (request) => /\/runs\/1\//.test(request.url()) && asked.push(request.url());
    page.on('request', note);
    page.once('framenavigated', () => page.off('request', note)); // after the reload the page asks about its new run
    const second = await serve(t, `after${address.length}`, ['--scenario', 'nominal'], { port: first.port });
    for (let i = 0; i < 20; ++i) {
      // a user who keeps pressing while the page reloads
      await page.keyboard.press('Enter').catch(() => undefined);
      await new Promise((done) => setTimeout(done, 50));
    }
    await shows(
      'notices',
      /The server has another archive now: run 1, nominal_auto, which was shown here, is not in it/,
    );
    assert.deepEqual(asked, [], 'asked of a server that is not known to have the run');
    await shows('badge', /^REHEARSAL\s+nominal · run 1/);
    await shows('stream-state', /connected/);
    await shows('timepoints-fired', /^0/);
    assert.equal(new URL(page.url()).search, '');
    assert.equal(await page.getByTestId('command-line').inputValue(), '', 'what was typed for one vehicle');
    assert.deepEqual((await second.get('/runs/1/commands')).commands ?? [], []);
    assert.equal((await second.get('/runs')).runs[0].pace, 1);
    await page.keyboard.press('/'); // it can be sent to this run
    await page.keyboard.type('no op');
    await page.keyboard.press('Enter');
    await waitFor(
      async () => {
        await page.keyboard.press('Enter');
        return (await second.get('/runs/1/commands')).commands?.map((each) => each.name) ?? [];
      },
      (names) => names.includes('NO_OP'),
    );
    assert.deepEqual(problems, []);
    await page.close();
  });
}
