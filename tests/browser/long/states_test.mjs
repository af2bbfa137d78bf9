// SPDX-License-Identifier: Apache-2.0
// Panels in states that an ended run without accounts does not have: users, tokens and audit; a command that is
// reviewed, armed or waits for a second person; a command file checked by the ground. In each state axe finds nothing
// in both themes, the stored picture is matched, and nothing is wider than the screen or cut off from 320 px to 4K.
// AEOLIS_RENEW_PICTURES=1 stores new pictures.
import assert from 'node:assert/strict';
import path from 'node:path';
import { test } from 'node:test';
import { comesToLook } from '../picture.mjs';
import { comesToRest, findings, temporaryFolder, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
const SIZE = { width: 1000, height: 640 };
const SIZES = [
  [320, 640],
  [768, 1024],
  [1024, 768],
  [1366, 768],
  [1920, 1080],
  [3840, 2160],
];

/**
 * In the page: the illegible parts of the panel. Parts reachable by scrolling down are legible; parts beside the edge
 * of a scrolling box are not checked.
 */
function cutOff() {
  const main = document.querySelector('main');
  const found =
    document.documentElement.scrollWidth > innerWidth
      ? [`the page is ${document.documentElement.scrollWidth} px wide`]
      : [];
  const isAside = (box) => /auto|scroll/.test(getComputedStyle(box).overflowX) && box.scrollWidth > box.clientWidth + 1;
  for (const box of main.querySelectorAll('*'))
    if (isAside(box)) found.push(`${box.className || box.tagName} has ${box.scrollWidth} px in ${box.clientWidth}`);
  const said = (from, words) => from.closest('[title]')?.title.includes(words);
  const walk = document.createTreeWalker(main, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const [words, parent] = [walk.currentNode.data.trim(), walk.currentNode.parentElement];
    if (words === '' || parent.closest('option, datalist, textarea') || !parent.checkVisibility()) continue;
    const range = document.createRange();
    range.selectNodeContents(walk.currentNode);
    const text = range.getBoundingClientRect();
    let { right } = text;
    for (let box = parent; box && box !== main; box = box.parentElement) {
      const { overflowX, overflowY } = getComputedStyle(box);
      const around = box.getBoundingClientRect();
      const cut =
        (overflowX === 'hidden' && text.right > around.right + 1) ||
        (overflowY === 'hidden' && text.bottom > around.bottom + 1);
      if (cut && !said(parent, words)) found.push(`“${words}” is cut off`);
      if (overflowX === 'hidden') right = Math.min(right, around.right);
      if (/auto|scroll/.test(overflowY)) break;
    }
    if (right > innerWidth + 1) found.push(`“${words}” is beyond the edge`);
  }
  const pen = document.createElement('canvas').getContext('2d');
  for (const field of main.querySelectorAll('input:not([type="checkbox"], [type="file"])')) {
    if (!field.checkVisibility()) continue;
    const { font, paddingLeft, paddingRight } = getComputedStyle(field);
    pen.font = font;
    const [words, room] = [
      field.value || field.placeholder,
      field.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight),
    ];
    if (pen.measureText(words).width > room + 1 && !said(field, words)) found.push(`“${words}” does not fit its field`);
  }
  return [...new Set(found)];
}

/** The faults in the look of this state. */
async function flawsOf(page, name) {
  const flaws = [];
  for (const theme of ['dark', 'light']) {
    await page.setViewportSize(SIZE);
    await page.evaluate((wanted) => (document.documentElement.dataset.theme = wanted), theme);
    flaws.push(
      ...(await findings(page, theme)).map((line) => `${name}, ${theme}: ${line}`),
      ...(await comesToLook(page, `${name}_${theme}`, page.locator('main'))),
    );
  }
  for (const [width, height] of SIZES) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    flaws.push(...(await page.evaluate(cutOff)).map((line) => `${name}, ${width} px: ${line}`));
  }
  await page.setViewportSize(SIZE);
  await page.evaluate(() => (document.documentElement.dataset.theme = 'dark'));
  return flaws;
}

test('users, tokens and audit of a server with accounts look as stored, and nothing of them is cut off', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const server = await serve(t, 'users', ['--accounts', path.join(folder, 'accounts.json')]);
  const given = /administrator with (\S+)/.exec(await waitFor(async () => server.said(), /administrator with \S+/))[1];
  let cookie = '';
  const ask = async (method, route, body) => {
    const answer = await fetch(`${server.address}/api/v1${route}`, {
      method,
      body: JSON.stringify(body),
      headers: { cookie },
    });
    cookie ||= answer.headers.get('set-cookie').split(';')[0];
    return answer.status;
  };
  assert.equal(await ask('POST', '/session', { user: 'administrator', password: given }), 201);
  assert.equal(
    await ask('PATCH', '/users/administrator', { current_password: given, password: 'an own long password' }),
    200,
  );
  for (const [user, role, commands] of [
    ['ann', 'director', []],
    ['ben', 'controller', ['NO_OP', 'EDL_SET_PARAMETERS']],
    ['w'.repeat(32), 'observer', []],
  ])
    assert.equal(await ask('POST', '/users', { user, role, commands, password: 'given by another' }), 201);
  for (const [name, role, commands] of [
    ['plotter', 'observer', []],
    ['planner-of-the-second-shift', 'controller', ['NO_OP', 'EDL_SET_PARAMETERS', 'EDL_SET_TIMEPOINT_OFFSET']],
  ])
    assert.equal(await ask('POST', '/tokens', { name, role, commands }), 201);
  assert.ok(
    (await ask('POST', '/users', { user: 'ann', role: 'observer', password: 'given by another' })) >= 400,
    'there is an ann',
  );

  const { page, problems, shows } = await open(server.address, SIZE);
  const [name, value] = cookie.split('=');
  await page.context().addCookies([{ name, value, url: server.address }]);
  await page.route('**/api/v1/audit*', async (route) => {
    // whose date differs each time
    const answer = await (await route.fetch()).json();
    for (const entry of answer.entries) entry.at = '2012-08-06T05:10:47Z';
    await route.fulfill({ json: answer });
  });
  await page.goto(`${server.address}/?panel=users`);
  await shows('audit', /refused[^]*ann/);
  await shows('stream-state', /connected/);
  const flaws = await flawsOf(page, 'users_of_accounts');
  await page.getByLabel('name of the new token').fill('archiver');
  await page.keyboard.press('Enter');
  await shows('new-token', /archiver[^]*[A-Za-z0-9_-]{43}/);
  await page.getByRole('button', { name: 'remove ann' }).click();
  for (const [width, height] of SIZES) {
    await page.setViewportSize({ width, height });
    flaws.push(...(await page.evaluate(cutOff)).map((line) => `a new token, ${width} px: ${line}`));
  }
  assert.deepEqual(flaws, []);
  assert.deepEqual(
    problems.filter((problem) => !/status of 401/.test(problem)),
    [],
  );
  await page.close();
});

test('a command that is reviewed or armed and a file that the ground has looked at look as stored, and nothing of them is cut off', async (t) => {
  const server = await serve(t, 'commands', ['--scenario', 'nominal']);
  const { page, problems, shows } = await open(`${server.address}/?panel=commands`, SIZE);
  await shows('badge', /REHEARSAL/);
  await shows('stream-state', /connected/);
  const review = async (words) => {
    await page.getByTestId('command-line').fill(words);
    await page.getByTestId('command-line').press('Enter');
  };
  await review('set edl parameters');
  await shows('dry-run', /✓ It would be sent as it stands here[^]*to spare[^]*octets/);
  const flaws = await flawsOf(page, 'commands_reviewed');
  await page.keyboard.press('Escape');

  await review('select_prime computer=b');
  await shows('dry-run', /✓ It would be sent once it is armed/);
  await page.keyboard.press('Enter');
  await shows('command-armed', /ARMED: SELECT_PRIME[^]*✓ Its checks hold/);
  await page.keyboard.type('SELECT');
  flaws.push(...(await flawsOf(page, 'commands_armed')));
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await page.getByTestId('command-line').fill('');

  await page.getByTestId('command-file').locator('summary').click();
  const choose = (commands) =>
    page.getByTestId('file-chosen').setInputFiles({
      name: 'landing.json',
      mimeType: 'application/json',
      buffer: Buffer.from(JSON.stringify({ commands })),
    });
  await choose([
    { command: 'EDL_SET_PARAMETERS', from_solution: true },
    { command: 'EDL_DO_EDL', hold: true },
  ]);
  await shows('file-lines', /✓ All would be taken[^]*solution_id=[^]*▲ EDL_DO_EDL/);
  flaws.push(...(await flawsOf(page, 'commands_file')));
  for (const [state, reach] of [
    [
      'a file that is armed',
      async () => {
        await page.getByTestId('file-forward').click();
        await shows('file-armed', /Type EDL_DO_EDL/);
        await page.keyboard.type('no');
        await page.keyboard.press('Enter');
        await shows('file-message', /nothing was sent/);
      },
    ],
    [
      'a file that is refused',
      async () => {
        await page.keyboard.press('Escape');
        await choose([{ command: 'NO_OP' }, { command: 'NO_OP', service: 'CD' }]);
        await shows('file-lines', /✖ None would go/);
      },
    ],
  ]) {
    await reach();
    for (const theme of ['dark', 'light']) {
      await page.evaluate((wanted) => (document.documentElement.dataset.theme = wanted), theme);
      flaws.push(...(await findings(page, theme)).map((line) => `${state}, ${theme}: ${line}`));
    }
    for (const [width, height] of SIZES) {
      await page.setViewportSize({ width, height });
      flaws.push(...(await page.evaluate(cutOff)).map((line) => `${state}, ${width} px: ${line}`));
    }
  }
  assert.deepEqual((await server.get('/runs/latest/commands')).commands ?? [], [], 'nothing was sent');
  assert.deepEqual(flaws, []);
  assert.deepEqual(
    problems.filter((problem) => !/status of 422 .*\/sequences$/.test(problem)),
    [],
  ); // a refused file, which the browser logs
  await page.close();
});

test('a command that waits for a second person looks as stored to who asked and to who may approve, and nothing of it is cut off', async (t) => {
  const server = await serve(t, 'second', ['--scenario', 'two_persons']);
  const [ann, bob] = [
    await open(`${server.address}/?panel=commands`, SIZE),
    await open(`${server.address}/?panel=commands`, SIZE),
  ];
  await ann.shows('stream-state', /connected/);
  await ann.page.getByTestId('command-line').fill('set edl parameters');
  await ann.page.getByTestId('command-line').press('Enter');
  await ann.page.getByTestId('controller').fill('ann');
  await ann.shows('dry-run', /✓ It would wait for the approval of a second controller/);
  await ann.page.getByTestId('controller').press('Enter');
  await ann.shows('command-message', /EDL_SET_PARAMETERS is #1/);
  await ann.shows('command-queue', /One command waits/);
  await bob.shows('command-queue', /EDL_SET_PARAMETERS #1/);
  const flaws = [...(await flawsOf(ann.page, 'commands_asked')), ...(await flawsOf(bob.page, 'commands_to_approve'))];
  assert.deepEqual(flaws, []);
  assert.deepEqual([...ann.problems, ...bob.problems], []);
  await Promise.all([ann.page.close(), bob.page.close()]);
});
