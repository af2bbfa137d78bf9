// Under the content security policy of a server with accounts: log in, lose the session in the middle of something, log in again; acknowledge
// and shelve an alarm, write a note, manage users. Sessions, alarms and notes are answered by a stand-in, everything else by the program.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { standIn } from './stand_in.mjs';
import { findings, focused, waitFor, workplace } from './support.mjs';

const { open, serve } = workplace();

test('with accounts: a log-in in place, an end of the session in the middle that loses and doubles nothing, and what each role may do', { timeout: 90_000 }, async (t) => {
    const server = await serve(t, 'access', ['--scenario', 'nominal']);
    let user;
    let notes = [];
    const roles = { ann: 'controller', eve: 'observer', root: 'administrator' };
    const routes = {
        'GET /session': () => [200, { accounts: true, user: user ?? '', role: roles[user] ?? '', rights: user ? ['look'] : [] }],
        'POST /session': ({ user: name, password }) => (roles[name] && password === `${name}-secret` ? [200, { user: (user = name) }] : [401, { error: 'wrong user or password' }]),
        'DELETE /session': () => [204, (user = undefined)],
        'GET /runs/1/notes': () => [200, { notes, next_after: '0' }],
        'POST /runs/1/notes': ({ text }) => [201, void (notes = [...notes, { seq: String(1e6 + notes.length), note: { text, by: user, at: '2012-219T04:50:00.0' } }])],
        'GET /users': () => [200, { users: Object.entries(roles).map(([name, role]) => ({ user: name, role })) }],
        'POST /users': ({ user: name, role }) => [201, (roles[name] = role) && {}],
        'GET /tokens': () => [200, { tokens: [] }],
        'POST /tokens': ({ name }) => [201, { name, token: 'shown-once-4711' }],
        'GET /audit': () => [200, { audit: [{ number: 1, at: '2026-01-01T00:00:00Z', user: 'ann', action: 'log_in' }] }],
    };
    const way = await standIn(server.address, routes, (path) => path.startsWith('/session') || user !== undefined);
    t.after(() => way.close());
    const { page, problems, text, shows } = await open(way.address);
    const logIn = async (name, password) => {
        await page.getByTestId('log-in-user').fill(name);
        await page.getByTestId('log-in-password').fill(password);
        await page.keyboard.press('Enter');
    };

    await waitFor(() => page.getByTestId('log-in').count(), (forms) => forms === 1);
    assert.deepEqual(await findings(page, 'dark'), []);
    assert.equal(await page.getByTestId('panel-timeline').count(), 0, 'nothing of a run is shown');
    await logIn('ann', 'guess');
    await shows('log-in-problem', /wrong user or password/);
    await logIn('ann', 'ann-secret');
    await shows('badge', /REHEARSAL/);
    await shows('who', /ann[^]*controller/);
    await shows('waiting', /set edl parameters/);
    await waitFor(() => page.getByTestId('timepoints-fired').innerText(), /of 71/);

    await page.keyboard.press('n');
    await waitFor(() => focused(page), /note-text/);
    await page.keyboard.type('<b>the radar</b> is late');
    await page.keyboard.press('Enter');
    await shows('note-list', /ann[^]*<b>the radar<\/b> is late/);

    // The session ends while a second note is being written.
    await page.keyboard.type('second');
    user = undefined;
    way.drop();
    await page.keyboard.press('Enter');
    await shows('note-problem', /was not written down: log in first/);
    await shows('expired-bar', /Your session has ended/);
    assert.equal(await page.getByTestId('note-text').inputValue(), 'second', 'what was typed is still there');
    assert.match(await text('stream-state'), /NO CONNECTION|connecting/);
    await logIn('ann', 'ann-secret');
    await waitFor(() => page.getByTestId('expired-bar').count(), (bars) => bars === 0);
    await shows('stream-state', /connected/);
    assert.equal(notes.length, 1, 'nothing was sent again by itself');
    await page.getByTestId('note-text').focus();
    await page.keyboard.press('Enter');
    await shows('note-list', /second/);
    assert.equal(notes.length, 2);
    await page.keyboard.press('Escape');

    await page.getByTestId('log-out').click();
    await waitFor(() => page.getByTestId('log-in').count(), (forms) => forms === 1);
    assert.equal(await page.getByTestId('panel-timeline').count(), 0, 'nothing stays after log-out');
    await logIn('eve', 'eve-secret');
    await shows('who', /eve[^]*observer, only looks/);
    await waitFor(() => page.getByTestId('command-line').isDisabled(), (disabled) => disabled);

    user = 'root';
    await page.reload();
    await shows('who', /root[^]*administrator/);
    await page.keyboard.press('u');
    await page.getByLabel('name of the new user').fill('<i>new</i>');
    await page.getByLabel('password of the new user').fill('long enough');
    await page.keyboard.press('Enter');
    await waitFor(() => page.locator('[data-user="<i>new</i>"]').count(), (rows) => rows === 1);
    await page.getByLabel('name of the new token').fill('plotter');
    await page.keyboard.press('Enter');
    await shows('new-token', /shown-once-4711/);
    assert.deepEqual(await findings(page, 'dark'), []);
    assert.match(await text('audit'), /ann[^]*log_in/);
    assert.deepEqual(problems.filter((problem) => !/status of 401/.test(problem)), [], 'the policy forbids nothing that the page does');
    await page.close();
});

test('alarms are acknowledged with a note, shelved and taken back by keyboard, and the header counts what no one has looked at', { timeout: 60_000 }, async (t) => {
    const server = await serve(t, 'alarms', ['--scenario', 'nominal']);
    const all = new Map([
        ['battery_V', { name: 'battery_V', kind: 'limit', state: 'unacknowledged', severity: 'critical', worst: 'critical', limit: '< 26 V', value: 25.1 }],
        ['GncNavigation', { name: 'GncNavigation', kind: 'staleness', state: 'unacknowledged', severity: 'warning', worst: 'warning' }],
    ]);
    const routes = {
        'GET /runs/1/alarms?state=current': () => [200, { alarms: [...all.values()] }],
        'POST /runs/1/alarms': ({ channel, action, shelve_s: seconds, note, by }) => {
            const acknowledged = action === 'acknowledge';
            const state = { acknowledge: 'acknowledged', shelve: 'shelved', unshelve: 'unacknowledged', reset: 'normal' }[action];
            all.set(channel, { ...all.get(channel), state, acknowledged, note, by, ...(action === 'shelve' && { shelved_until: `in ${seconds} s` }) });
            return [200, {}];
        },
    };
    const way = await standIn(server.address, routes);
    t.after(() => way.close());
    const { page, problems, shows } = await open(way.address);
    await shows('alarms-waiting', /2 to acknowledge/);
    await page.keyboard.press('a');
    await waitFor(() => focused(page), /alarm-note/);
    await page.keyboard.type('seen, known');
    await page.getByRole('button', { name: 'acknowledge battery_V' }).focus();
    await page.keyboard.press('Enter');
    await shows('alarms-waiting', /1 to acknowledge/);
    await shows('alarms', /battery_V[^]*acknowledged[^]*seen, known/);
    await page.getByTestId('shelve-for').selectOption('900');
    await page.getByRole('button', { name: 'shelve GncNavigation' }).focus();
    await page.keyboard.press('Enter');
    await shows('alarm-sentence', /all acknowledged/);
    await shows('alarms', /shelved until in 900 s/);
    assert.equal(await page.getByTestId('alarms-waiting').count(), 0);
    assert.deepEqual(await findings(page, 'dark'), []);
    await page.getByRole('button', { name: 'unshelve GncNavigation' }).focus();
    await page.keyboard.press('Enter');
    await shows('alarms-waiting', /1 to acknowledge/);
    assert.deepEqual(way.asked.filter((each) => each.method === 'POST').map(({ body }) => body.action), ['acknowledge', 'shelve', 'unshelve']);
    assert.deepEqual(problems, []);
    await page.close();
});
