// SPDX-License-Identifier: Apache-2.0
// A newcomer lands a spacecraft with the keyboard alone, reloads, and asks for a recorded range; a server that is
// killed in mid-landing loses nothing that was shown.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  breakable,
  focused,
  secondsFromEntry,
  setPace as pace,
  stageLook as stage,
  waitFor,
  workplace,
} from './support.mjs';

const { open, serve } = workplace();

test('two commands by keyboard land it; a reload has all of it; a range can be asked for', {
  timeout: 480_000,
}, async (t) => {
  const server = await serve(t, 'landing', ['--scenario', 'nominal']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('badge', /REHEARSAL.*nominal/s);
  await shows('waiting', /set edl parameters/);

  await page.keyboard.press('/');
  await page.keyboard.type('set edl parameters');
  await page.keyboard.press('Enter');
  await shows('command-review', /filled from ground/);
  await shows('dry-run', /✓ It would be sent as it stands here/);
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_SET_PARAMETERS is #1/);
  await waitFor(() => stage(page, 'EDL_SET_PARAMETERS', 'executed'), /ok/);
  await waitFor(() => stage(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/, 20_000); // flight reports what it holds every 8 s
  await shows('waiting', /type “do edl”/);
  await shows('command-history', /EDL_SET_PARAMETERS #1/);

  await waitFor(() => focused(page), /command-line/);
  await page.keyboard.type('do edl');
  await page.keyboard.press('Enter');
  await shows(
    'command-review',
    /✓ It would be sent[^]*arms it; nothing is sent yet[^]*✓ parameters_received == 1 is 1/,
  );
  await page.keyboard.press('Enter');
  await shows('command-armed', /ARMED/);
  await waitFor(() => focused(page), /command-confirmation/);
  await page.keyboard.press('Enter');
  await shows('command-message', /nothing was sent/);
  await page.keyboard.type('EDL_DO_EDL');
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_DO_EDL is #2/);
  await page.keyboard.press('Escape');

  await pace(page, 100);
  await shows('waiting', /Waiting for coolant vent/);
  await shows('timepoints-fired', /^[1-9]/);
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 130,
    150_000,
  );
  await pace(page, 20);
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 266,
    100_000,
  );
  await page.keyboard.press('p');
  await shows('badge', /paused/);
  await shows('pause', /go on/);
  await shows('phases', /Parachute/);
  assert.match(await text('tone-title'), /Tone \d+ · \S/);
  assert.match(await text('reading-altitude'), /\d/);
  await page.keyboard.press('p');
  await pace(page, 100);

  await waitFor(
    () => page.locator('[data-event="TOUCHDOWN"]').count(),
    (count) => count === 1,
    100_000,
  );
  await pace(page, 0).catch(() => undefined); // it may have ended by now
  await shows('waiting', /Landed/, 100_000);
  await shows('badge', /ENDED RUN.*touchdown/s);
  // The end of the run may be told before its last items: the page has all once it has what the server has, and
  // neither goes on.
  let before;
  await waitFor(
    async () => {
      const [{ last_seq: last }] = (await server.get('/runs')).runs;
      const through = (await text('complete-through')).replace(/\D/g, '');
      const settled = through === last && through === before;
      before = through;
      await new Promise((resolve) => setTimeout(resolve, 300));
      return settled;
    },
    (settled) => settled === true,
  );
  const seen = {
    fired: await text('timepoints-fired'),
    through: await text('complete-through'),
    tone: await text('tone-title'),
    stages: await stage(page, 'EDL_DO_EDL', 'executed'),
  };

  await page.reload();
  await shows('waiting', /Landed/);
  await waitFor(
    () => text('timepoints-fired'),
    (value) => value === seen.fired,
  );
  await waitFor(
    () => text('complete-through'),
    (value) => value === seen.through,
  );
  await waitFor(() => text('reading-altitude'), /\d/);
  await waitFor(
    () => text('tone-title'),
    (value) => value === seen.tone,
    3_000,
  ); // drawn with the next batch, not later
  assert.equal(await stage(page, 'EDL_DO_EDL', 'executed'), seen.stages);
  assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 1);

  await page.keyboard.press('r');
  await waitFor(() => focused(page), /range-from/);
  await page.keyboard.press('Control+A');
  await page.keyboard.type('E+4:10');
  await page.keyboard.press('Tab');
  await page.keyboard.type('E+5:00');
  await page.keyboard.press('Enter');
  await shows('range-message', /✓ [1-9]\d* samples of 4 channels/);
  await shows('badge', /PAST, NOT LIVE/);
  assert.match(await text('past-bar'), /Nothing here is live/);
  assert.match(await text('recording-summary'), /✓ Every live packet is in the recording/);
  assert.equal(await text('clock-entry'), 'E+00:05:00');
  assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 0, 'an event after the range is shown');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await shows('badge', /ENDED RUN/);
  assert.deepEqual(problems, []);
  await page.close();
});

/** Does what the guide says, key by key, and nothing else. */
async function obey(page) {
  const presses = await page
    .getByTestId('guide')
    .locator('li')
    .evaluateAll((items) =>
      items.map((item) => ({ type: item.textContent.startsWith('type'), key: item.querySelector('kbd')?.textContent })),
    );
  for (const { type, key } of presses) {
    if (type) await page.keyboard.type(key);
    else if (key) await page.keyboard.press(key === '−' ? '-' : key === 'Esc' ? 'Escape' : key);
    if (key === 'Enter') break; // what follows is another way
  }
}

test('whoever only does what the guide says lands it, and once put away the guide stays away', {
  timeout: 480_000,
}, async (t) => {
  const server = await serve(t, 'guide', ['--scenario', 'nominal']);
  const { page, problems, shows } = await open(server.address);
  await shows('guide', /Tell the vehicle where it is/);
  for (const title of [/Tell the vehicle where it is/, /read it/, /Let it begin/, /read it/, /EDL_DO_EDL/]) {
    await shows('guide', title);
    if (title.source === 'read it') await shows('dry-run', /✓ It would be sent/); // there is nothing to be read before
    await obey(page);
  }
  await shows('guide', /Nothing to do until entry/);
  await page.keyboard.press('Escape'); // leaves the command line
  await waitFor(
    async () => {
      await obey(page);
      await new Promise((resolve) => setTimeout(resolve, 300));
      return page.getByTestId('pace').inputValue();
    },
    (value) => Number(value) >= 20,
  );
  await pace(page, 100);
  await shows('guide', /Entry[^]*see it happen/, 150_000);
  await obey(page);
  await shows('guide', /You have landed it/, 90_000);
  await shows('badge', /touchdown/); // each panel takes its turn

  await page.keyboard.press('g');
  await waitFor(
    () => page.getByTestId('guide').count(),
    (count) => count === 0,
  );
  await page.reload();
  await shows('waiting', /Landed/);
  assert.equal(await page.getByTestId('guide').count(), 0);
  assert.deepEqual(problems, []);
  await page.close();
});

/** What each plot draws: how many holes its trace has, and its newest sample. */
const traces = (page) =>
  page
    .locator('.plot')
    .evaluateAll((plots) => plots.map(({ dataset }) => `${dataset.holes} holes to ${dataset.newest}`));

test('after kill -9 in mid-entry the run is there, interrupted, up to the last number that was shown, without a seam, and can be continued', {
  timeout: 180_000,
}, async (t) => {
  const first = await serve(t, 'killed', ['--scenario', 'nominal_auto', '--pace', '100']);
  const { page, text, shows } = await open(first.address);
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > -200,
    90_000,
  );
  await pace(page, 20); // entry goes on for as long as a slow machine needs to see it
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 120,
    90_000,
  );
  await shows('phase-now', /Entry/);
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
  // The trace that lived through it is that of a page which asks for all of it now: no hole but the blackout, no seam.
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

test('the latest run is the one that goes on for every route, also when it is an older one that is continued', {
  timeout: 120_000,
}, async (t) => {
  const first = await serve(t, 'latest', ['--scenario', 'nominal_auto', '--pace', '100']);
  const runs = async (server) => (await server.get('/runs')).runs;
  await waitFor(
    () => runs(first),
    ([run]) => Number(run?.last_seq) > 500,
    60_000,
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

test('cut off in mid-entry the page says so, says what it missed once it is back, and has all of it', {
  timeout: 180_000,
}, async (t) => {
  const server = await serve(t, 'cut', ['--scenario', 'nominal_auto', '--pace', '100']);
  const way = await breakable(server.port);
  t.after(() => way.close());
  const { page, problems, text, shows } = await open(way.address);
  await waitFor(
    () => text('clock-entry'),
    (value) => secondsFromEntry(value) > 120,
    90_000,
  );
  await pace(page, 10);
  await shows('stream-state', /connected/);
  way.cut();
  await shows('stream-state', /NO CONNECTION/);
  await shows('lost-bar', /everything here is old/);
  const [{ last_seq: last }] = (await server.get('/runs')).runs;
  await waitFor(
    async () => (await server.get('/runs')).runs[0],
    (run) => Number(run.last_seq) > Number(last) + 200,
  ); // the landing goes on
  way.mend();
  await shows(
    'notices',
    /The connection was lost at E\+0\d:\d\d and is back[^]*were filled in from the archive, none is missing/,
  );
  await shows('stream-state', /connected/);
  await pace(page, 100);
  await shows('badge', /ENDED RUN.*touchdown/s, 90_000);
  // What came while it was away is there, once each: as many events as the archive has, and no hole in the trace.
  const { events } = await server.get('/runs/1/events?limit=10000');
  const names = (rows) => rows.reduce((count, name) => count.set(name, (count.get(name) ?? 0) + 1), new Map());
  const wanted = names(
    events
      .map((item) => item.event)
      .filter(({ level }) => !['DIAGNOSTIC', 'ACTIVITY_LO'].includes(level))
      .map(({ name }) => name),
  );
  await page.getByLabel('least level shown').selectOption('ACTIVITY_HI');
  await waitFor(
    async () =>
      names(
        await page.locator('[data-event]:not(.level-why)').evaluateAll((rows) => rows.map((row) => row.dataset.event)),
      ),
    (shown) => shown.size === wanted.size && [...wanted].every(([name, count]) => shown.get(name) === count),
    10_000,
  );
  assert.deepEqual(
    problems.filter((problem) => !/Failed to fetch|ERR_/.test(problem)),
    [],
  );
  await page.close();
});
