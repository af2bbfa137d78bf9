// SPDX-License-Identifier: Apache-2.0
// Under the content security policy of a server with accounts: log in, lose the session during work, log in again;
// acknowledge and shelve an alarm, write a note, manage users. In the second test a stand-in answers for alarms.
import assert from 'node:assert/strict';
import path from 'node:path';
import { test } from 'node:test';
import { standIn } from '../stand_in.mjs';
import { findings, focused, temporaryFolder, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();

/** Sends a request as a program with a cookie. Returns the answer with the cookie that it sets. */
async function ask(address, method, route, body, cookie) {
  const answer = await fetch(`${address}/api/v1${route}`, {
    method,
    body: body && JSON.stringify(body),
    headers: cookie ? { cookie } : {},
  });
  const text = await answer.text();
  return {
    status: answer.status,
    cookie: answer.headers.get('set-cookie')?.split(';')[0],
    answer: text === '' ? undefined : JSON.parse(text),
  };
}

/**
 * Presses every button in every panel, uses every key and submits every form. Returns the page's requests other than
 * reads.
 */
async function whatObserverDoes(page) {
  const asked = [];
  page.on(
    'request',
    (request) => request.method() !== 'GET' && asked.push(`${request.method()} ${new URL(request.url()).pathname}`),
  );
  let subscribed = 0;
  page.on('websocket', (socket) =>
    socket.on('framesent', ({ payload }) => {
      if (payload[0] === 0x0a)
        ++subscribed; // the only message that reads; seeing it here shows that others would be seen
      else asked.push(`message ${payload[0]} over the socket`);
    }),
  );
  await page.reload();
  await waitFor(() => page.getByTestId('stream-state').innerText(), /connected/);
  await page.evaluate(() => (Element.prototype.requestFullscreen = async () => undefined)); // it would cover the tabs
  const under_way = new Set();
  page.on('request', (request) => under_way.add(request));
  for (const end of ['requestfinished', 'requestfailed']) page.on(end, (request) => under_way.delete(request));
  const tabs = await page.getByRole('tab').evaluateAll((all) => all.map((tab) => tab.dataset.testid));
  let pressed = 0;
  for (const tab of tabs) {
    await page.getByTestId(tab).click();
    await waitFor(
      async () => (await page.getByTestId(tab).getAttribute('aria-selected')) === 'true' && under_way.size === 0,
      (whole) => whole === true,
    );
    pressed += await page.evaluate(() => {
      const pressable = () => [
        ...document.querySelectorAll('button:enabled:not([data-testid="log-out"]):not([role="tab"])'),
      ];
      const all = pressable();
      for (const button of all) if (button.isConnected) button.click();
      for (const form of document.querySelectorAll('form')) form.requestSubmit();
      return all.length;
    });
    for (const key of ['p', '+', '-', '/', 'Escape', 'Escape']) await page.keyboard.press(key);
  }
  // The worker answers this request after all earlier messages.
  const last = page.waitForRequest(/\/packets\?verdict=/);
  for (const tab of ['tab-channels', 'tab-verdicts']) await page.getByTestId(tab).click();
  await last;
  assert.ok(subscribed > 0, 'what goes over the socket is seen');
  assert.ok(tabs.length >= 10 && pressed > tabs.length, `${pressed} controls in ${tabs.length} panels`);
  for (const event of ['request', 'requestfinished', 'requestfailed']) page.removeAllListeners(event);
  page.removeAllListeners('websocket');
  return asked;
}

test('with accounts: a log-in in place, an end of the session in the middle that loses and doubles nothing, and what each role may do', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const server = await serve(t, 'access', ['--scenario', 'nominal', '--accounts', path.join(folder, 'accounts.json')]);
  await waitFor(async () => server.said(), /Aeolis is at/);
  const first = /administrator with (\S+)/.exec(server.said())[1];
  const { cookie } = await ask(server.address, 'POST', '/session', { user: 'administrator', password: first });
  const administer = (method, route, body) => ask(server.address, method, route, body, cookie);
  assert.equal((await administer('GET', '/users')).status, 403, 'the first password opens nothing');
  assert.equal(
    (await administer('PATCH', '/users/administrator', { current_password: first, password: 'an own long password' }))
      .status,
    200,
  );
  for (const [user, role] of [
    ['ann', 'director'],
    ['eve', 'observer'],
  ])
    assert.equal((await administer('POST', '/users', { user, role, password: 'given by another' })).status, 201);

  const { page, problems, text, shows } = await open(`${server.address}/?run=1&data=links`);
  const logIn = async (name, password) => {
    await page.getByTestId('log-in-user').fill(name);
    await page.getByTestId('log-in-password').fill(password);
    await page.keyboard.press('Enter');
  };
  const choose = async (given, chosen) => {
    await page.getByTestId('password-given').fill(given);
    await page.getByTestId('password-chosen').fill(chosen);
    await page.getByTestId('password-again').fill(chosen);
    await page.keyboard.press('Enter');
  };

  await waitFor(
    () => page.getByTestId('log-in').count(),
    (forms) => forms === 1,
  );
  assert.deepEqual(await findings(page, 'dark'), []);
  assert.equal(await page.getByTestId('panel-timeline').count(), 0, 'nothing of a run is shown');
  await logIn('ann', 'guess');
  await shows('log-in-problem', /user or password is wrong/);
  await logIn('ann', 'given by another');
  await shows('choose-password', /Choose one of your own/);
  assert.deepEqual(await findings(page, 'dark'), []);
  await choose('given by another', 'short');
  await shows('choose-problem', /12 to 128/);
  await choose('given by another', 'a password of ann');
  await shows('badge', /REHEARSAL/);
  await shows('who', /ann[^]*director/);
  await shows('waiting', /set edl parameters/);
  await waitFor(() => page.getByTestId('timepoints-fired').innerText(), /of \d+/);
  assert.equal(
    await page.getByTestId('tab-links').getAttribute('aria-selected'),
    'true',
    'the link holds after the log-in',
  );

  await page.keyboard.press('Escape'); // leaves the command line
  await page.keyboard.press('n');
  await waitFor(() => focused(page), /note-text/);
  await page.keyboard.type('<b>the radar</b> is late');
  await page.keyboard.press('Enter');
  await shows('note-list', /ann[^]*<b>the radar<\/b> is late/);

  // The rights end while a command is armed, its name half typed.
  await page.keyboard.press('Escape');
  await page.keyboard.press('/');
  await page.keyboard.type('select_prime computer=b');
  await page.keyboard.press('Enter');
  await shows('dry-run', /✓ It would be sent once it is armed/);
  await page.keyboard.press('Enter');
  await shows('command-armed', /ARMED/);
  const name = /ARMED: (\w+)/.exec(await text('command-armed'))[1];
  await page.keyboard.type(name.slice(0, 4));
  assert.equal((await administer('PATCH', '/users/ann', { role: 'observer' })).status, 200);
  await shows('command-armed', /✖ It would be refused: ann is observer/);
  await page.keyboard.type(name.slice(4));
  await page.keyboard.press('Enter');
  await shows('command-message', /nothing was sent: ann is observer: this needs the right to command/);
  await shows('who', /ann[^]*observer, only looks/);
  await waitFor(
    () => page.getByTestId('command-line').isDisabled(),
    (disabled) => disabled,
  );
  assert.deepEqual((await administer('GET', '/runs/latest/commands')).answer.commands ?? [], [], 'nothing was sent');
  assert.equal((await administer('PATCH', '/users/ann', { role: 'director' })).status, 200);
  await page.reload();
  await shows('who', /ann[^]*director/);
  await waitFor(() => page.getByTestId('timepoints-fired').innerText(), /of \d+/);
  await shows('stream-state', /connected/);
  await page.keyboard.press('Escape');
  await page.getByTestId('tab-notes').click();
  await page.getByTestId('note-text').focus();

  // The session ends while a second note is being written.
  await page.keyboard.type('second');
  assert.equal((await administer('PATCH', '/users/ann', { password: 'given once more' })).status, 200);
  await waitFor(() => text('stream-state'), /NO CONNECTION|connecting/);
  await page.getByTestId('note-text').focus();
  await page.keyboard.press('Enter');
  await shows('note-problem', /was not written down: log in first/);
  await shows('expired-bar', /Your session has ended/);
  assert.equal(await page.getByTestId('note-text').inputValue(), 'second', 'what was typed is still there');
  await logIn('ann', 'given once more');
  await choose('given once more', 'a password of ann');
  await waitFor(
    () => page.getByTestId('expired-bar').count(),
    (bars) => bars === 0,
  );
  await shows('stream-state', /connected/);
  const notes = async () => (await administer('GET', '/runs/latest/notes')).answer.notes.length;
  assert.equal(await notes(), 1, 'nothing was sent again by itself');
  await page.getByTestId('note-text').focus();
  await page.keyboard.press('Enter');
  await shows('note-list', /second/);
  assert.equal(await notes(), 2);
  await page.keyboard.press('Escape');

  await page.getByTestId('log-out').click();
  await waitFor(
    () => page.getByTestId('log-in').count(),
    (forms) => forms === 1,
  );
  assert.equal(await page.getByTestId('panel-timeline').count(), 0, 'nothing stays after log-out');
  await logIn('eve', 'given by another');
  await choose('given by another', 'a password of eve');
  await shows('who', /eve[^]*observer, only looks/);
  await waitFor(
    () => page.getByTestId('command-line').isDisabled(),
    (disabled) => disabled,
  );
  assert.deepEqual(await whatObserverDoes(page), []);
  await page.goto(server.address);
  await page.getByTestId('log-out').click();

  await logIn('administrator', 'an own long password');
  await shows('who', /administrator/);
  await waitFor(() => focused(page), /command-line/); // once all of the run has come; a letter is text there
  await page.keyboard.press('Escape');
  await page.keyboard.press('u');
  await page.getByLabel('name of the new user').fill('<i>new</i>');
  await page.getByLabel('password of the new user').fill('long enough for it');
  await page.keyboard.press('Enter');
  await shows('users-message', /a name has 1 to 32/);
  await page.getByLabel('name of the new user').fill('dina');
  await page.getByLabel('password of the new user').fill('long enough for it');
  await page.keyboard.press('Enter');
  await waitFor(
    () => page.locator('[data-user="dina"]').count(),
    (rows) => rows === 1,
  );
  await page.getByLabel('name of the new token').fill('plotter');
  await page.keyboard.press('Enter');
  await shows('new-token', /plotter[^]*[A-Za-z0-9_-]{43}/);
  assert.deepEqual(await findings(page, 'dark'), []);
  assert.match(await text('audit'), /dina[^]*ann[^]*note/, 'the newest stands first');
  assert.doesNotMatch(await text('audit'), /given|password of|long enough/);
  assert.deepEqual(
    problems.filter((problem) => !/status of (401|403|409|422 .*\/users(\/ann)?$)/.test(problem)),
    [],
    'the policy forbids nothing that the page does',
  );
  await page.close();
});

test('alarms are acknowledged with a note, shelved and taken back by keyboard, and the header counts what no one has looked at', async (t) => {
  const server = await serve(t, 'alarms', ['--scenario', 'nominal']);
  const all = new Map([
    [
      'battery_V',
      {
        name: 'battery_V',
        kind: 'limit',
        state: 'unacknowledged',
        severity: 'critical',
        worst: 'critical',
        limit: '< 26 V',
        value: 25.1,
      },
    ],
    [
      'GncNavigation',
      { name: 'GncNavigation', kind: 'staleness', state: 'unacknowledged', severity: 'warning', worst: 'warning' },
    ],
  ]);
  const routes = {
    'GET /runs/1/alarms?state=current': () => [200, { alarms: [...all.values()] }],
    'POST /runs/1/alarms': ({ channel, action, shelve_s: seconds, note, by }) => {
      const acknowledged = action === 'acknowledge';
      const state = { acknowledge: 'acknowledged', shelve: 'shelved', unshelve: 'unacknowledged', reset: 'normal' }[
        action
      ];
      all.set(channel, {
        ...all.get(channel),
        state,
        acknowledged,
        note,
        by,
        ...(action === 'shelve' && { shelved_until: `in ${seconds} s` }),
      });
      return [200, {}];
    },
  };
  const way = await standIn(server.address, routes);
  t.after(() => way.close());
  const { page, problems, shows } = await open(way.address);
  await shows('alarms-waiting', /2 to acknowledge/);
  await page.keyboard.press('Escape'); // leaves the command line
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
  assert.deepEqual(
    way.asked.filter((each) => each.method === 'POST').map(({ body }) => body.action),
    ['acknowledge', 'shelve', 'unshelve'],
  );
  assert.deepEqual(problems, []);
  await page.close();
});
