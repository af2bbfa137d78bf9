// SPDX-License-Identifier: Apache-2.0
// After a server is killed in mid-landing, nothing shown is lost; nor does a page lose data when it is cut off.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { breakable, flyTo, setPace as pace, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

/** For each plot, the number of holes in its trace and its newest sample. */
const traces = (page) =>
  page
    .locator('.plot')
    .evaluateAll((plots) => plots.map(({ dataset }) => `${dataset.holes} holes to ${dataset.newest}`));

test('after kill -9 in mid-entry the run is there, interrupted, up to the last number that was shown, without a seam, and can be continued', async (t) => {
  const first = await serve(t, 'killed', ['--scenario', 'nominal_auto', '--pace', '100']);
  const { page, text, shows } = await open(first.address);
  await flyTo(first, 120);
  await shows('phase-now', /Entry/);
  await shows('badge', /paused/);
  await page.keyboard.press('p');
  await pace(page, 1);
  await shows('stream-state', /connected/);
  await first.kill();
  await shows('stream-state', /NO CONNECTION/);
  const shown = Number((await text('complete-through')).replace(/\D/g, ''));
  const fired = Number.parseInt(await text('timepoints-fired'), 10);
  assert.ok(shown > 0);

  const second = await serve(t, 'killed', [], { port: first.port });
  await shows('stream-state', /connected/);
  await shows('badge', /INTERRUPTED RUN/);
  await shows('notices', /The server had stopped and was started again: this run was cut off at number \d+/);
  await shows('waiting', /Interrupted/);
  await waitFor(
    () => text('complete-through'),
    (value) => Number(value.replace(/\D/g, '')) >= shown,
  );
  assert.ok(Number.parseInt(await text('timepoints-fired'), 10) >= fired);
  const [run] = (await second.get('/runs')).runs;
  assert.equal(run.state, 'interrupted');
  // The surviving trace equals that of a page that requests everything now: no hole but the blackout, no seam.
  const other = await open(second.address);
  await other.shows('badge', /INTERRUPTED RUN/);
  await waitFor(
    async () => [await traces(page), await traces(other.page)],
    ([mine, theirs]) => mine.length === 4 && /^\d+ holes to \d/.test(mine[0]) && mine.join() === theirs.join(),
  );
  for (const trace of await traces(page))
    assert.match(trace, /^[12] holes/, 'nothing is drawn through the blackout, and nothing else is left out');
  await other.page.close();
  assert.ok(Number(run.last_seq) >= shown, `${run.last_seq} stored, ${shown} shown`);

  await page.reload();
  await shows('badge', /INTERRUPTED RUN/);
  await waitFor(
    () => text('complete-through'),
    (value) => Number(value.replace(/\D/g, '')) >= shown,
  );

  await page.getByTestId('tab-rehearsal').click();
  await page.getByTestId('continue-1').click();
  await waitFor(
    async () => (await second.get('/runs')).runs[0],
    (now) => now.state === 'running' && Number(now.last_seq) > Number(run.last_seq) + 50,
  );
  await shows('badge', /REHEARSAL/);
  await waitFor(
    () => text('complete-through'),
    (value) => Number(value.replace(/\D/g, '')) > Number(run.last_seq) + 50,
  );
  assert.ok(Number.parseInt(await text('timepoints-fired'), 10) >= fired);
  await page.close();
});

test('the latest run is the one that goes on for every route, also when it is an older one that is continued', async (t) => {
  const first = await serve(t, 'latest', ['--scenario', 'nominal_auto', '--pace', '100']);
  const runs = async (server) => (await server.get('/runs')).runs;
  await waitFor(
    () => runs(first),
    ([run]) => Number(run?.last_seq) > 500,
  );
  await first.kill();
  const second = await serve(t, 'latest', []);
  const send = async (route, body) =>
    (await fetch(`${second.address}/api/v1${route}`, { method: 'POST', body: JSON.stringify(body) })).status;
  assert.equal(await send('/rehearsals', { scenario: 'nominal', pace: 1 }), 201);
  assert.equal(await send('/rehearsals/current', { stop: true }), 202);
  await waitFor(
    () => runs(second),
    ([newest]) => newest.run === '2' && newest.state === 'finished',
  );
  assert.equal((await second.get('/runs/latest')).run, '2');
  assert.equal(await send('/rehearsals', { continue_run: 1 }), 201);
  await waitFor(
    () => second.get('/runs/latest'),
    ({ run, state }) => run === '1' && state === 'running',
  );
  assert.equal(await send('/runs/latest/notes', { text: 'for the run that goes on', by: 'Ada' }), 201);
  const notes = async (run) => ((await second.get(`/runs/${run}/notes`)).notes ?? []).length;
  assert.deepEqual([await notes(1), await notes(2), await notes('latest')], [1, 0, 1]);
  assert.deepEqual(await second.get('/runs/latest/commands'), await second.get('/runs/1/commands'));
});

test('cut off in mid-entry the page says so, says what it missed once it is back, and has all of it', async (t) => {
  const server = await serve(t, 'cut', ['--scenario', 'nominal_auto', '--pace', '100']);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, problems, shows } = await open(way.address);
  await flyTo(server, 120);
  await shows('badge', /paused/);
  await page.keyboard.press('Escape'); // out of the command line, which a run that waits for commands has in focus
  await page.keyboard.press('p');
  await pace(page, 10);
  await shows('stream-state', /connected/);
  way.cut();
  await shows('stream-state', /NO CONNECTION/);
  await shows('situation-sentence', /everything here is old/);
  const [{ last_seq: last }] = (await server.get('/runs')).runs;
  await waitFor(
    async () => (await server.get('/runs')).runs[0],
    (run) => Number(run.last_seq) > Number(last) + 200,
  ); // the landing goes on
  way.mend();
  await shows(
    'notices',
    /The connection was lost at E\+\d:\d\d and is back[^]*were filled in from the archive, none is missing/,
  );
  await shows('stream-state', /connected/);
  await pace(page, 100);
  await shows('badge', /ENDED RUN.*touchdown/s);
  // The items of the absence are there, once each: as many events as in the archive, and no hole in the trace.
  const { events } = await server.get('/runs/1/events?limit=10000');
  const names = (rows) => rows.reduce((count, name) => count.set(name, (count.get(name) ?? 0) + 1), new Map());
  const wanted = names(
    events
      .map((item) => item.event)
      .filter(({ level }) => !['DIAGNOSTIC', 'ACTIVITY_LO'].includes(level))
      .map(({ name }) => name),
  );
  await page.getByLabel('this level and above').selectOption('ACTIVITY_HI');
  await waitFor(
    async () =>
      names(
        await page.locator('[data-event]:not(.level-why)').evaluateAll((rows) => rows.map((row) => row.dataset.event)),
      ),
    (shown) => shown.size === wanted.size && [...wanted].every(([name, count]) => shown.get(name) === count),
  );
  assert.deepEqual(
    problems.filter((problem) => !/Failed to fetch|ERR_/.test(problem)),
    [],
  );
  await page.close();
});
