// SPDX-License-Identifier: Apache-2.0
// Commands by keyboard: tried out before they are sent, refused in place, held, timed, cancelled; and the vehicle's
// parameters compared field by field.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { focused, setPace, stageLook, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

const count = async (server) => ((await server.get('/runs/latest/commands')).commands ?? []).length;

/** Moves the focus to the field of this name with the Tab key alone. */
async function tabTo(page, testId) {
  for (let presses = 0; presses < 60; ++presses) {
    if ((await focused(page)) === testId) return;
    await page.keyboard.press('Tab');
  }
  assert.fail(`Tab never came to ${testId}`);
}

async function review(page, words) {
  await page.keyboard.press('/');
  await page.keyboard.press('Control+A');
  await page.keyboard.type(words);
  await page.keyboard.press('Enter');
}

test('the ground says before it is sent what would become of a command, and refuses in place', async (t) => {
  const server = await serve(t, 'tried', ['--scenario', 'nominal_light_time']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);
  await review(page, 'set edl parameters');
  await shows('dry-run', /✓ It would be sent as it stands here/);
  const told = await (
    await fetch(`${server.address}/api/v1/runs/latest/commands`, {
      method: 'POST',
      body: JSON.stringify({ command: 'EDL_SET_PARAMETERS', from_solution: true, dry_run: true }),
    })
  ).json();
  assert.equal(told.accepted, true);
  const seconds = (answer) =>
    answer
      .replace(/^\d+-/, '')
      .split(/[T:]/)
      .reduce((sum, part) => sum * 60 + Number(part), 0);
  assert.ok(
    Math.abs(seconds(told.arrives) - seconds(/\d{4}-\d{3}T[\d:.]+/.exec(await text('arrives'))[0])) < 10,
    `${told.arrives}, shown: ${await text('arrives')}`,
  );
  assert.match(await text('station'), /from DSS-14, whose pass ends 2012-219T04:10:47\.400 ERT/);
  assert.match(await text('effect-seen'), /27 m 36 s after it leaves/); // 2 × 828 s
  assert.match(await text('send-by'), /leave by 2012-\d{3}T[\d:.]+ ERT to be there before .*to spare/);
  assert.ok((await text('dry-run')).replaceAll(/\s/g, '').includes(told.octets.slice(0, 8)), 'its octets are shown');
  assert.equal(await count(server), 0, 'a dry run takes no number');
  await page.setViewportSize({ width: 1366, height: 768 });
  await shows('send-by', /leave by/);
  const places = await page.evaluate(() => {
    const panel = document.querySelector('[data-testid="panel-commands"]').getBoundingClientRect();
    const top = (query) => document.querySelector(query).getBoundingClientRect().bottom - panel.top;
    return {
      panel: panel.height,
      order: ['.verdict', '[data-testid="effect"]', '[data-testid="send-by"]', '[data-testid="arrives"]'].map(top),
    };
  });
  assert.deepEqual(
    places.order,
    [...places.order].sort((one, other) => one - other),
    'verdict, effect, the latest time to leave and arrival stand in this order',
  );
  assert.ok(
    places.order[2] < places.panel,
    `the latest time to leave lies at ${places.order[2]} of ${places.panel} px`,
  );
  await page.setViewportSize({ width: 1920, height: 1080 });

  await tabTo(page, 'release-at');
  await page.keyboard.type('noon');
  await shows('dry-run', /“noon” is no time to leave/);
  await page.keyboard.press('Enter');
  await shows('command-message', /“noon” is no time to leave/);
  await page.keyboard.press('Control+A');
  await page.keyboard.type('2011-001T00:00:00');
  await shows('dry-run', /✖ It would be refused: release_at: 2011-001T00:00:00\.000 is past/);
  await page.keyboard.press('Control+A');
  await page.keyboard.type('2012-219T12:00:00');
  await shows(
    'dry-run',
    /✖ It would be refused: no station sees the vehicle at 2012-219T12:00:00\.000: the last pass, of DSS-43, ended 2012-219T11:10:47\.400; none comes after it/,
  );
  assert.equal(await count(server), 0);
  await page.keyboard.press('Escape');
  assert.deepEqual(problems, []);
  await page.close();
});

test('what a changed offset would move is named and drawn before it is sent, and is gone with the form', async (t) => {
  const server = await serve(t, 'moved', ['--scenario', 'nominal_light_time']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);
  const { timepoints } = await server.get('/runs/latest/timepoints');
  const shield = timepoints.find((row) => row.name === 'heatshield_separation').id;
  const picture = () => page.getByTestId('timeline-canvas').screenshot();
  await review(page, `edl_set_timepoint_offset timepoint=${shield} desired_offset_s=0 minimum_offset_s=0`);
  await shows('effect', /moves no timepoint/);
  const before = await picture();
  await review(page, `edl_set_timepoint_offset timepoint=${shield} desired_offset_s=12 minimum_offset_s=0`);
  await shows('effect', /^◌ It would move \d+ timepoints, by at most 12\.0 s$/);
  await page.getByTestId('effect').locator('summary').press('Enter');
  await shows('effect', /heatshield separation\s+E\+4:37\.4 → E\+4:49\.4, \+12\.0 s/);
  await waitFor(
    async () => !before.equals(await picture()),
    (differs) => differs,
  );
  assert.equal(await count(server), 0, 'nothing was sent');
  await page.keyboard.press('Escape');
  await waitFor(
    () => page.getByTestId('effect').count(),
    (shown) => shown === 0,
  );
  assert.match(await text('timepoints-fired'), /^0 of/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a held Enter chooses and goes no further, and nothing leaves before the ground has answered the review', async (t) => {
  const server = await serve(t, 'held', ['--scenario', 'nominal']);
  const { page, problems, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);
  await shows('stream-state', /connected/);
  await page.keyboard.press('/');
  await page.keyboard.type('no op');
  for (let repeats = 0; repeats < 40; ++repeats) {
    await page.keyboard.down('Enter'); // each after the first is a repeat
    await page.waitForTimeout(25);
  }
  await page.keyboard.up('Enter');
  await shows('dry-run', /✓ It would be sent as it stands here/);
  assert.equal(await count(server), 0, 'a held key sent it');
  await page.keyboard.press('Enter');
  await shows('command-message', /NO_OP is #1/);
  for (let repeats = 0; repeats < 10; ++repeats) await page.keyboard.down('Enter');
  await page.keyboard.up('Enter');
  assert.equal(await count(server), 1);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a failure of something else is a notice, and the command’s own answer is its answer', async (t) => {
  const server = await serve(t, 'refusals', ['--scenario', 'nominal']);
  const { page, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);
  await shows('stream-state', /connected/);
  await review(page, 'no op');
  await shows('dry-run', /✓ It would be sent as it stands here/);
  await page.evaluate(() => {
    // a pace that no user may have, followed at once by the command
    const select = document.querySelector('[data-testid="pace"]');
    select.add(new Option('-3', '-3'));
    select.value = '-3';
    select.dispatchEvent(new Event('change', { bubbles: true }));
  });
  await page.keyboard.press('Enter');
  await shows('command-message', /✓ NO_OP is #1/);
  await shows('notices', /pace/);
  assert.equal(await count(server), 1);
  await page.close();
});

test('a command that needs a second person is asked for in one browser and approved in another, by somebody else', async (t) => {
  const server = await serve(t, 'two_persons', ['--scenario', 'two_persons']);
  const [ann, bob] = [await open(server.address), await open(server.address)];
  await ann.shows('waiting', /set edl parameters/);
  await review(ann.page, 'set edl parameters');
  await tabTo(ann.page, 'controller');
  await ann.page.keyboard.type('ann');
  await ann.shows('dry-run', /✓ It would wait for the approval of a second controller/);
  await ann.page.keyboard.press('Enter');
  await ann.shows('command-message', /EDL_SET_PARAMETERS is #1/);
  await ann.shows('command-queue', /One command waits/);
  await tabTo(ann.page, 'approve'); // her own page knows her name
  await ann.page.keyboard.press('Enter');
  await ann.shows('command-message', /✖[^]*ann/);
  await ann.page.getByTestId('approver').fill('bob'); // nor under another name in her own browser
  await ann.page.getByTestId('approve').click();
  await ann.shows('command-message', /✖[^]*a second person approves it in a browser of their own/);
  assert.equal(await stageLook(ann.page, 'EDL_SET_PARAMETERS', 'radiated'), 'none', 'who asked cannot approve');

  await bob.shows('command-queue', /EDL_SET_PARAMETERS #1/);
  assert.ok(await bob.page.getByTestId('approve').isDisabled(), 'nobody approves without a name');
  await tabTo(bob.page, 'approver');
  assert.equal(await bob.page.getByTestId('approver').getAttribute('placeholder'), 'not ann');
  await bob.page.keyboard.type('bob');
  await bob.page.keyboard.press('Tab');
  await bob.page.keyboard.press('Enter');
  await bob.shows('command-message', /#1 approved/);
  for (const { page } of [ann, bob]) await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'executed'), /ok/);
  const row = ann.page.getByRole('button', { name: 'EDL_SET_PARAMETERS #1' });
  // What comes of the landing meanwhile may move it, too, but not each time at this instant.
  const moved = async () => {
    await ann.page.getByTestId('command-line').focus();
    let place;
    await waitFor(
      async () => {
        const before = JSON.stringify(place);
        place = await row.boundingBox();
        return JSON.stringify(place) === before;
      },
      (rests) => rests,
    );
    await ann.page.getByTestId('command-line').blur();
    return JSON.stringify(await row.boundingBox()) !== JSON.stringify(place);
  };
  assert.ok(
    !(await moved()) || !(await moved()) || !(await moved()),
    'the first press of a mouse would move what it is on',
  );
  await row.click();
  await ann.shows('command-details', /authorised[^]*bob/);
  assert.deepEqual([...ann.problems, ...bob.problems], []);
  await Promise.all([ann.page.close(), bob.page.close()]);
});

test('a command file is chosen, each of its commands looked at by the ground, and sent whole after one arming', async (t) => {
  const server = await serve(t, 'file', ['--scenario', 'nominal']);
  const { page, problems, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);
  await page.getByTestId('command-file').locator('summary').click();
  const file = (commands) => ({
    name: 'landing.json',
    mimeType: 'application/json',
    buffer: Buffer.from(JSON.stringify({ commands })),
  });
  await page
    .getByTestId('file-chosen')
    .setInputFiles(file([{ command: 'NO_OP' }, { command: 'NO_OP', service: 'CD' }]));
  await shows(
    'file-lines',
    /✖ None would go: commands\[1\]: unknown service[^]*1 NO_OP[^]*octets, at Mars 2012-[^]*to come before[^]*2 NO_OP[^]*✖ unknown service/,
  );
  assert.ok(await page.getByTestId('file-forward').isDisabled());

  await page.getByTestId('file-chosen').setInputFiles(
    file([
      { command: 'EDL_SET_PARAMETERS', from_solution: true },
      { command: 'EDL_DO_EDL', hold: true },
    ]),
  );
  await shows('file-lines', /✓ All would be taken[^]*solution_id=[^]*▲ EDL_DO_EDL/);
  assert.equal(await count(server), 0, 'a dry run takes no number');
  await page.getByTestId('file-forward').click();
  await shows('file-armed', /ARMED: 2 commands[^]*Type EDL_DO_EDL/);
  await page.keyboard.type('do it');
  await page.keyboard.press('Enter');
  await shows('file-message', /type EDL_DO_EDL to confirm; nothing was sent/);
  await page.keyboard.press('Control+A');
  await page.keyboard.type('edl_do_edl');
  await page.keyboard.press('Enter');
  await shows('file-message', /✓ all 2 taken: #1 to #2/);
  await shows('command-queue', /EDL_DO_EDL #2[^]*held until a controller releases it/);
  await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'executed'), /ok/);
  assert.equal(await page.getByTestId('file-text').inputValue(), '', 'another Enter sends nothing');
  // A refusal by the ground has a status that a browser logs by itself.
  assert.deepEqual(
    problems.filter((each) => !/status of (409|422)/.test(each)),
    [],
  );
  await page.close();
});

test('commands are held, released, timed and cancelled by keyboard, and what the vehicle holds is compared field by field', async (t) => {
  const server = await serve(t, 'queue', ['--scenario', 'nominal']);
  const { page, problems, text, shows } = await open(server.address);
  await shows('waiting', /set edl parameters/);

  // A hazardous command that would be refused is not armed.
  await review(page, 'do edl');
  await shows(
    'dry-run',
    /✖ It would be refused: EDL_DO_EDL must not be sent now: parameters received: must be yes, is no/,
  );
  await page.keyboard.press('Enter');
  await shows('command-message', /not armed: .*parameters received: must be yes, is no/);
  assert.equal(await page.getByTestId('command-armed').count(), 0);
  await page.keyboard.press('Escape');

  await review(page, 'set edl parameters');
  await shows('dry-run', /✓ It would be sent/);
  await tabTo(page, 'hold');
  await page.keyboard.press('Space');
  await shows('dry-run', /✓[^]*held until you release it/);
  await page.keyboard.press('Enter');
  await shows('command-message', /EDL_SET_PARAMETERS is #1.*held/);
  await shows('command-queue', /One command waits[^]*EDL_SET_PARAMETERS #1[^]*held until a controller releases it/);
  assert.equal(await stageLook(page, 'EDL_SET_PARAMETERS', 'released'), 'pending');
  assert.equal(await stageLook(page, 'EDL_SET_PARAMETERS', 'radiated'), 'none', 'it has not left');

  await review(page, 'no op');
  await tabTo(page, 'release-at');
  await page.keyboard.type('E-17:00');
  await tabTo(page, 'priority');
  await page.keyboard.type('3');
  await shows('dry-run', /✓ It would be sent[^]*leaves\s+2012-/);
  await page.keyboard.press('Enter');
  await shows('command-queue', /2 commands wait[^]*NO_OP #2[^]*leaves at 2012-\d{3}T[\d:.]+, priority 3/);
  await review(page, 'no op');
  await tabTo(page, 'hold');
  await page.keyboard.press('Space');
  await shows('dry-run', /✓[^]*held until you release it/);
  await page.keyboard.press('Enter');
  await shows('command-queue', /3 commands wait/);
  await page.locator('[data-waiting="3"]').getByRole('button', { name: 'cancel' }).focus();
  await page.keyboard.press('Enter');
  await shows('command-queue', /2 commands wait/);
  await waitFor(() => stageLook(page, 'NO_OP', 'released'), /failed/);
  await page.locator('[data-waiting="1"]').getByRole('button', { name: 'release' }).focus();
  await page.keyboard.press('Enter');
  await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/);

  await page.getByRole('button', { name: 'EDL_SET_PARAMETERS #1' }).focus();
  await page.keyboard.press('Enter');
  await shows('read-back', /✓ 17 of 17 are held as sent/);
  assert.equal(await page.getByTestId('read-back').locator('tbody tr').count(), 17);
  assert.match(
    await text('command-details'),
    /queued[^]*authorised[^]*released[^]*held until[^]*radiated[^]*executed[^]*verified[^]*17 of 17 arguments equal/,
  );
  const { commands } = await server.get('/runs/latest/commands');
  // The octets are asked for when the details are opened.
  await waitFor(
    async () => (await text('command-details')).replaceAll(/\s/g, ''),
    (shown) => shown.includes(commands.find((each) => each.command === '1').octets),
  );

  await page.keyboard.press('Escape');
  await setPace(page, 20);
  await waitFor(
    () => page.locator('[data-waiting="2"]').count(),
    (waiting) => waiting === 0,
  );
  await waitFor(
    async () =>
      (await server.get('/runs/latest/commands')).commands.find((each) => each.command === '2').stages.at(-1)
        .command_stage,
    (stage) => stage.stage === 'executed' && stage.status === 'ok',
  );
  assert.deepEqual(problems, []);
  await page.close();
});
