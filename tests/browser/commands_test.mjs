// Commands by keyboard: tried out before they are sent, refused in place, held, timed, cancelled; and what the vehicle holds compared field by field.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { focused, setPace, stageLook, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

const count = async (server) => ((await server.get('/runs/latest/commands')).commands ?? []).length;

/** Into the field of this name with the Tab key alone. */
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

test('the ground says before it is sent what would become of a command, and refuses in place', { timeout: 60_000 }, async (t) => {
    const server = await serve(t, 'tried', ['--scenario', 'nominal_light_time']);
    const { page, problems, text, shows } = await open(server.address);
    await shows('waiting', /set edl parameters/);
    await review(page, 'set edl parameters');
    await shows('dry-run', /✓ It would be sent as it stands here/);
    const told = await (await fetch(`${server.address}/api/v1/runs/latest/commands`, {
        method: 'POST', body: JSON.stringify({ command: 'EDL_SET_PARAMETERS', from_solution: true, dry_run: true }),
    })).json();
    assert.equal(told.accepted, true);
    const seconds = (answer) => answer.replace(/^\d+-/, '').split(/[T:]/).reduce((sum, part) => sum * 60 + Number(part), 0);
    assert.ok(Math.abs(seconds(told.arrives) - seconds(/\d{4}-\d{3}T[\d:.]+/.exec(await text('arrives'))[0])) < 10, `${told.arrives}, shown: ${await text('arrives')}`);
    assert.match(await text('station'), /from DSS-14, whose pass ends 2012-219T04:10:47\.400 ERT/);
    assert.match(await text('effect-seen'), /27 m 36 s after it leaves/); // twice 828 s
    assert.match(await text('send-by'), /leave by 2012-\d{3}T[\d:.]+ ERT to be there before .*to spare/);
    assert.ok((await text('dry-run')).replaceAll(/\s/g, '').includes(told.octets.slice(0, 8)), 'its octets are shown');
    assert.equal(await count(server), 0, 'a dry run takes no number');

    await tabTo(page, 'release-at');
    await page.keyboard.type('noon');
    await shows('dry-run', /“noon” is no time to leave/);
    await page.keyboard.press('Enter');
    await shows('command-message', /“noon” is no time to leave/);
    await page.keyboard.press('Control+A');
    await page.keyboard.type('2011-001T00:00:00');
    await shows('dry-run', /✖ It would be refused: release_at: 2011-001T00:00:00 is past/);
    await page.keyboard.press('Control+A');
    await page.keyboard.type('2012-219T12:00:00');
    await shows('dry-run', /✖ It would be refused: no station sees the vehicle at 2012-219T12:00:00\.000: the last pass, of DSS-43, ended 2012-219T11:10:47\.400; none comes after it/);
    assert.equal(await count(server), 0);
    await page.keyboard.press('Escape');
    assert.deepEqual(problems, []);
    await page.close();
});

test('what a changed offset would move is named and drawn before it is sent, and is gone with the form', { timeout: 60_000 }, async (t) => {
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
    await shows('effect', /It would move \d+ timepoints, by at most 12\.0 s[^]*heatshield separation\s+E\+04:37\.4 → E\+04:49\.4, \+12\.0 s/);
    await waitFor(async () => !before.equals(await picture()), (differs) => differs);
    assert.equal(await count(server), 0, 'nothing was sent');
    await page.keyboard.press('Escape');
    await waitFor(() => page.getByTestId('effect').count(), (shown) => shown === 0);
    assert.match(await text('timepoints-fired'), /^0 of/);
    assert.deepEqual(problems, []);
    await page.close();
});

test('commands are held, released, timed and cancelled by keyboard, and what the vehicle holds is compared field by field', { timeout: 90_000 }, async (t) => {
    const server = await serve(t, 'queue', ['--scenario', 'nominal']);
    const { page, problems, text, shows } = await open(server.address);
    await shows('waiting', /set edl parameters/);

    // A hazardous command that would be refused is not armed.
    await review(page, 'do edl');
    await shows('dry-run', /✖ It would be refused: EDL_DO_EDL must not be sent now: parameters_received == 1: is 0/, 30_000);
    await page.keyboard.press('Enter');
    await shows('command-message', /not armed: .*parameters_received/);
    assert.equal(await page.getByTestId('command-armed').count(), 0);
    await page.keyboard.press('Escape');

    await review(page, 'set edl parameters');
    await shows('dry-run', /✓ It would be sent/);
    await tabTo(page, 'hold');
    await page.keyboard.press('Space');
    await shows('dry-run', /held until you release it/);
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
    await page.keyboard.press('Enter');
    await shows('command-queue', /2 commands wait[^]*NO_OP #2[^]*leaves at 2012-\d{3}T[\d:.]+, priority 3/);
    await review(page, 'no op');
    await tabTo(page, 'hold');
    await page.keyboard.press('Space');
    await page.keyboard.press('Enter');
    await shows('command-queue', /3 commands wait/);
    await page.locator('[data-waiting="3"]').getByRole('button', { name: 'cancel' }).focus();
    await page.keyboard.press('Enter');
    await shows('command-queue', /2 commands wait/);
    await waitFor(() => stageLook(page, 'NO_OP', 'released'), /failed/);
    await page.locator('[data-waiting="1"]').getByRole('button', { name: 'release' }).focus();
    await page.keyboard.press('Enter');
    await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/, 30_000);

    await page.getByRole('button', { name: 'EDL_SET_PARAMETERS #1' }).focus();
    await page.keyboard.press('Enter');
    await shows('read-back', /✓ 17 of 17 are held as sent/);
    assert.equal(await page.getByTestId('read-back').locator('tbody tr').count(), 17);
    assert.match(await text('command-details'), /queued[^]*authorised[^]*released[^]*held until[^]*radiated[^]*executed[^]*verified[^]*17 of 17 arguments equal/);
    const { commands } = await server.get('/runs/latest/commands');
    assert.ok((await text('command-details')).replaceAll(/\s/g, '').includes(commands.find((each) => each.command === '1').octets));

    await page.keyboard.press('Escape');
    await setPace(page, 20);
    await waitFor(() => page.locator('[data-waiting="2"]').count(), (waiting) => waiting === 0, 30_000);
    await waitFor(async () => (await server.get('/runs/latest/commands')).commands.find((each) => each.command === '2').stages.at(-1).command_stage, (stage) => stage.stage === 'executed' && stage.status === 'ok', 30_000);
    assert.deepEqual(problems, []);
    await page.close();
});
