// SPDX-License-Identifier: Apache-2.0
// A director and a controller take positions: nothing leaves before the go of the poll, the holder of command sends
// after it, a later no go closes commanding again, and command is handed over.
import assert from 'node:assert/strict';
import path from 'node:path';
import { test } from 'node:test';
import { comesToRest, findings, temporaryFolder, waitFor, workplace } from '../support.mjs';
import { notWhole } from '../texts.mjs';

const { open, serve } = workplace();

/** Accounts of a server by name and role, each with its cookie and its way of asking. */
async function peopleOf(server, roles) {
  const given = /administrator with (\S+)/.exec(await waitFor(async () => server.said(), /administrator with \S+/))[1];
  const enter = async (user, first, own) => {
    let cookie = '';
    const ask = async (method, route, body) => {
      const answer = await fetch(`${server.address}/api/v1${route}`, {
        method,
        ...(body && { body: JSON.stringify(body) }),
        headers: { cookie },
      });
      cookie ||= answer.headers.get('set-cookie').split(';')[0];
      const text = await answer.text();
      assert.ok(answer.ok, `${method} ${route}: ${answer.status} ${text}`);
      return text === '' ? undefined : JSON.parse(text);
    };
    await ask('POST', '/session', { user, password: first });
    await ask('PATCH', `/users/${user}`, { current_password: first, password: own });
    return { ask, cookie };
  };
  const administrator = await enter('administrator', given, 'an own long password');
  const people = {};
  for (const [user, role] of Object.entries(roles)) {
    await administrator.ask('POST', '/users', { user, role, password: 'given by another' });
    people[user] = await enter(user, 'given by another', `a password of ${user}`);
  }
  return people;
}

test('a command leaves after the go of the poll alone, a no go ends it, and command is handed over', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const more = ['--scenario', 'nominal', '--accounts', path.join(folder, 'accounts.json')];
  const server = await serve(t, 'positions', more);
  const { ann, carl, ben } = await peopleOf(server, { ann: 'director', carl: 'controller', ben: 'controller' });
  const at = async ({ cookie }, query) => {
    const opened = await open(server.address, { width: 1440, height: 790 });
    const [name, value] = cookie.split('=');
    await opened.page.context().addCookies([{ name, value, url: server.address }]);
    await opened.page.goto(`${server.address}/${query}`);
    const press = (label) => opened.page.getByRole('button', { name: label, exact: true }).click();
    const seat = (position) => opened.page.locator(`[data-seat="${position}"]`);
    return { ...opened, press, seat };
  };
  const director = await at(ann, '?panel=procedures');
  const controller = await at(carl, '?data=procedures');

  await director.shows('room', /Positions: nobody has taken one/);
  await director.press('take one …');
  await director.page.getByTestId('position-taken').selectOption('flight_director');
  await director.press('take');
  await waitFor(() => director.seat('flight_director').innerText(), /ann/);
  await director.shows('position-change', /I am Flight director/); // and may stand in for others

  // The other sees it, takes command, and reads why nothing leaves before anything is typed.
  await waitFor(() => controller.seat('flight_director').innerText(), /ann/);
  await controller.press('take: Command');
  await controller.shows('position-held', /I am Command/);
  await controller.shows('commanding-closed', /Commanding is closed: \S/);
  const sends = async () => {
    await controller.page.getByTestId('command-line').fill('no op');
    await controller.page.getByTestId('command-line').press('Enter');
    await controller.shows('dry-run', /It would be (sent|refused)/);
    await controller.page.keyboard.press('Enter');
  };
  await sends();
  await controller.shows('command-message', /nothing was sent: \S|NO_OP refused: \S/);
  await controller.page.keyboard.press('Escape');
  await controller.page.keyboard.press('Escape');

  await controller.shows('lasting', /Commanding is closed/);
  await controller.page.getByTestId('tab-channels').click();
  await director.press('call a poll: Flight director');
  await director.page.keyboard.type('parameters');
  await director.page.keyboard.press('Enter');
  await director.shows('room-decision', /polling/);
  // Who is asked is told in the banner, whatever the panel shows, and is led to the answer.
  await controller.shows('asked-here', /Command, go or no go: “parameters”\?/);
  assert.equal(await director.page.getByTestId('asked-here').count(), 0, 'nobody else is asked');
  await controller.page.getByRole('button', { name: 'answer' }).click();
  await controller.shows('room-poll', /parameters[^]*poll called by ann/);
  await waitFor(() => controller.seat('command').innerText(), /□ not answered/);
  for (const { page } of [director, controller]) assert.deepEqual(await findings(page, 'dark'), []);
  for (const width of [1440, 390]) {
    await director.page.setViewportSize({ width, height: 790 });
    await comesToRest(director.page);
    const flaws = (await director.page.evaluate(notWhole)).filter((line) => /^(room|position|the page is)/.test(line));
    assert.deepEqual(flaws, [], `${width} px wide`);
  }

  // By key: what can be done now is the answer.
  await controller.page.evaluate(() => document.activeElement.blur());
  await controller.page.keyboard.press('8');
  await waitFor(() => controller.page.evaluate(() => document.activeElement?.dataset.positionAct), /^go$/);
  await controller.page.keyboard.press('Enter');
  await waitFor(() => director.seat('command').innerText(), /✓ go/);
  await controller.page.getByTestId('asked-here').waitFor({ state: 'detached' });
  await director.shows('asked-here', /Flight director, all have answered: “parameters”\?/);
  await director.press('go: Flight director');
  await director.shows('room-decision', /✓ GO/);
  await controller.shows('room-decision', /✓ GO/);
  await controller.page.getByTestId('commanding-closed').waitFor({ state: 'detached' });
  await sends();
  await controller.shows('command-message', /NO_OP is #\d/);

  // A later no go ends the go; against it the flight director decides with a reason alone.
  await controller.press('no go: Command');
  await controller.page.keyboard.type('the station asks for a minute');
  await controller.page.keyboard.press('Enter');
  await director.shows('room-decision', /polling/);
  await waitFor(() => director.seat('command').innerText(), /✕ no go[^]*the station asks for a minute/);
  await controller.shows('commanding-closed', /Commanding is closed: \S/);
  await director.press('go: Flight director');
  await director.page.getByTestId('position-ask').waitFor();
  await director.page.keyboard.type('the window closes');
  await director.page.keyboard.press('Enter');
  await controller.shows('room-poll', /✓ GO[^]*the window closes[^]*overridden: \S/);

  // An offer changes nothing until it is taken.
  await controller.press('offer: Command');
  await controller.page.keyboard.type('ben');
  await controller.page.keyboard.press('Enter');
  await waitFor(() => director.seat('command').innerText(), /carl[^]*offered to ben/);
  await ben.ask('POST', '/runs/1/positions', { kind: 'take', position: 'command' });
  await waitFor(() => director.seat('command').getAttribute('data-by'), /^ben$/);
  await controller.page.getByTestId('position-held').waitFor({ state: 'detached' });
  assert.equal(await controller.page.getByRole('button', { name: 'offer: Command' }).count(), 0);

  // The past has the room as it stood: between the poll and the first answer, with nothing to press.
  const { clocks } = (await ann.ask('GET', '/runs')).runs[0];
  const { acts } = await ann.ask('GET', '/runs/1/positions');
  const us = (wanted) => Number(acts.find(({ position_act: { kind } }) => kind === wanted).ert_us);
  const between_e_s = clocks.e_s - (clocks.ert_us - (us('poll') + us('go')) / 2) / 1e6;
  await director.page.goto(`${server.address}/?panel=procedures&run=1&past=-1200,${between_e_s}`);
  await director.shows('room-decision', /polling/);
  await waitFor(() => director.seat('command').innerText(), /carl[^]*□ not answered/);
  assert.equal(await director.page.locator('[data-position-act]').count(), 0);

  for (const { page, problems } of [director, controller]) {
    assert.deepEqual(
      problems.filter((each) => !each.includes('401 (Unauthorized)')), // before each logged in
      [],
    );
    await page.close();
  }
});
