// SPDX-License-Identifier: Apache-2.0
// A rehearsal with an instructor and three who are rehearsed, each in a browser of their own: from the choice of a plan
// that the others cannot see to the review in which it stands beside what they did.
import assert from 'node:assert/strict';
import path from 'node:path';
import { test } from 'node:test';
import { findings, temporaryFolder, waitFor, workplace } from '../support.mjs';

const { open, serve } = workplace();
const PASSWORD = 'a password of my own';
const HIDDEN = /station’s line|station's line|pyro controller A answers|line_down|left to instructors/i;

test('an instructor’s plan runs against three who do not see it, and the review has it beside what they did', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const server = await serve(t, 'instructor', ['--accounts', path.join(folder, 'accounts.json')]);
  await waitFor(async () => server.said(), /Aeolis is at/);
  const cookies = {};
  const ask = async (who, method, route, body) => {
    const answer = await fetch(`${server.address}/api/v1${route}`, {
      method,
      body: body && JSON.stringify(body),
      headers: cookies[who] ? { cookie: cookies[who] } : {},
    });
    const text = await answer.text();
    return { status: answer.status, text, json: text === '' ? undefined : JSON.parse(text), answer };
  };
  const logIn = async (user, given) => {
    const { answer, status } = await ask(undefined, 'POST', '/session', { user, password: given });
    assert.equal(status, 201);
    cookies[user] = answer.headers.get('set-cookie').split(';')[0];
    await ask(user, 'PATCH', `/users/${user}`, { current_password: given, password: PASSWORD });
  };
  await logIn('administrator', /administrator with (\S+)/.exec(server.said())[1]);
  const rehearsed = { dina: 'director', carl: 'controller', cleo: 'controller' };
  for (const [user, role] of Object.entries({ ida: 'instructor', ...rehearsed })) {
    await ask('administrator', 'POST', '/users', { user, role, password: 'given by another' });
    await logIn(user, 'given by another');
  }

  const pages = {};
  for (const user of ['ida', ...Object.keys(rehearsed)]) {
    pages[user] = await open(server.address, { width: 1440, height: 790 });
    await pages[user].page.getByTestId('log-in-user').fill(user);
    await pages[user].page.getByTestId('log-in-password').fill(PASSWORD);
    await pages[user].page.keyboard.press('Enter');
    await pages[user].shows('who', new RegExp(user));
    await pages[user].page.keyboard.press('s');
  }
  const ida = pages.ida.page;
  const whole = async (user) => pages[user].page.locator('body').innerText();
  for (const user of Object.keys(rehearsed)) {
    assert.equal(await pages[user].page.getByTestId('plan-choice').count(), 0, `${user} is offered no plan`);
    assert.equal((await ask(user, 'GET', '/plans')).status, 403);
  }

  await ida.getByTestId('plan-choice').selectOption('station_and_pyro');
  await pages.ida.shows('plan-chosen', /tells a fault of the ground/);
  assert.deepEqual(await findings(ida, 'dark'), []);
  const begun = await ask('ida', 'POST', '/rehearsals', {
    scenario: 'nominal_auto',
    plan: 'station_and_pyro',
    pace: 100,
  });
  assert.equal(begun.status, 201, begun.text);
  await pages.ida.shows('instructor', /Instructor/);
  await ida.locator('[data-testid="instructor"] > summary').click();
  await pages.ida.shows('plan', /The station's line fails before entry/);
  await pages.ida.shows('plan', /sends no command for 60 s|Pyro controller A/);

  // The room: one acknowledges what is raised, one writes. Nobody of them sees the plan, whatever they ask.
  const e_s = async () =>
    (await ask('dina', 'GET', '/rehearsals/current')).json.clocks?.e_s ?? Number.NEGATIVE_INFINITY;
  await waitFor(e_s, (now) => now > -245);
  await ask('ida', 'POST', '/rehearsals/current', { pace: 5 });
  await waitFor(
    async () =>
      (await ask('carl', 'GET', '/runs/1/alarms?state=current')).json.alarms.map((each) => each.name ?? each.alarm),
    (names) => names.length > 0,
  );
  for (const user of Object.keys(rehearsed)) {
    assert.doesNotMatch(await whole(user), HIDDEN);
    for (const route of ['/runs/1/plan', '/runs/1/interventions'])
      assert.equal((await ask(user, 'GET', route)).status, 403);
    assert.equal((await ask(user, 'POST', '/rehearsals/current', { plan: { inject: 'pyro_silent' } })).status, 403);
  }
  for (const alarm of ['uhf_live', 'x_band'])
    await ask('carl', 'POST', '/runs/1/alarms', { alarm, action: 'acknowledge' });
  await ask('cleo', 'POST', '/runs/1/notes', {
    text: 'Both links ended at once: the station. Procedure UHF lost begun',
  });
  await pages.ida.shows('plan', /done[^]*The station's line|The station's line[^]*done/);
  await ida.getByTestId('inject-skip-pyro_silent').click();
  await pages.ida.shows('plan', /skipped/);
  await ask('ida', 'POST', '/rehearsals/current', { pace: 0 });
  await waitFor(async () => (await ask('dina', 'GET', '/runs')).json.runs[0].state, /finished/);

  const cleo = pages.cleo.page;
  await pages.cleo.shows('review', /Review of run 1/);
  await cleo.locator('[data-testid="review"] > summary').click();
  await pages.cleo.shows('review-terms', /diagnosis/);
  await pages.cleo.shows('review-terms', /Both links ended at once/);
  await pages.cleo.shows('review', /The station's line fails before entry/);
  assert.deepEqual(await findings(cleo, 'dark'), []);
  const score = (await ask('cleo', 'GET', '/runs/1/score')).json;
  const diagnosis = score.terms.find((term) => term.name === 'diagnosis');
  assert.equal(diagnosis.judged[0].inject, 'line_down');
  assert.ok(diagnosis.points > 0, JSON.stringify(diagnosis));
  for (const { problems } of Object.values(pages))
    assert.deepEqual(
      problems.filter((each) => !each.includes('401 (Unauthorized)')), // before each logged in
      [],
    );
});
