// SPDX-License-Identifier: Apache-2.0
// One person makes standard calls by one key each, another reads one back by one key: both see it, and the log has it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { comesToRest, findings, focused, waitFor, workplace } from './support.mjs';
import { notWhole } from './texts.mjs';

const { open, serve } = workplace();

test('a call is made and read back by one key each, and typed words make none', async (t) => {
  const server = await serve(t, 'calls', ['--scenario', 'nominal']);
  const at = async (name) => {
    const opened = await open(`${server.address}/?data=notes`, { width: 1440, height: 790 });
    await opened.shows('waiting', /set edl parameters/);
    await opened.page.locator('[data-testid=notes] [data-testid=signature]').fill(name);
    await opened.page.evaluate(() => document.activeElement.blur());
    return opened;
  };
  const [ann, bob] = [await at('Ann'), await at('Bob')];
  const notes = async () => (await server.get('/runs/1/notes')).notes ?? [];

  // Words in the command line make no call, with the key of the list in them or without.
  await ann.page.getByTestId('command-line').fill('p');
  await ann.page.getByTestId('command-line').pressSequentially('7p');
  assert.equal(await ann.page.getByTestId('calls').count(), 0);
  await ann.page.getByTestId('command-line').fill('');
  await ann.page.evaluate(() => document.activeElement.blur());
  assert.deepEqual(await notes(), []);

  await ann.page.keyboard.press('7');
  await waitFor(() => focused(ann.page), /calls|signature/);
  await ann.page.getByTestId('calls').focus();
  assert.deepEqual(await findings(ann.page, 'dark'), []);
  await ann.page.keyboard.press('p');
  await ann.page.getByTestId('calls').waitFor({ state: 'detached' });
  for (const { shows } of [ann, bob]) await shows('calls-waiting', /Parachute seen[^]*Ann, not read back/);
  assert.equal(
    await ann.page.getByTestId('calls-waiting').getByRole('button').count(),
    0,
    'nobody reads back themselves',
  );

  await bob.page.keyboard.press('6');
  await bob.shows('note-list', /Ann[^]*✓ read back by Bob/);
  for (const { page } of [ann, bob]) await page.getByTestId('calls-waiting').waitFor({ state: 'detached' });
  assert.deepEqual(
    (await notes()).map(({ note }) => [note.by, note.text, note.call]),
    [
      ['Ann', 'Parachute seen', 'parachute_seen'],
      ['Bob', 'reads back “Parachute seen”', 'parachute_seen'],
    ],
  );

  // One that asks for more, and one that nobody reads back.
  await ann.page.keyboard.press('7');
  await ann.page.getByTestId('calls').focus();
  await ann.page.keyboard.press('t');
  await waitFor(() => focused(ann.page), /call-given/);
  await ann.page.keyboard.type('165 taken over');
  await ann.page.keyboard.press('Enter');
  await bob.shows('calls-waiting', /Tone heard: 165 taken over/);
  await bob.shows('calls-waiting', /not read back for \d/);
  for (const [width, height] of [
    [1280, 585],
    [390, 700],
    [1440, 790],
  ]) {
    await bob.page.setViewportSize({ width, height });
    await bob.page.evaluate(() => document.activeElement.blur());
    await bob.page.keyboard.press('7');
    await bob.page.getByTestId('calls').waitFor();
    await comesToRest(bob.page);
    const flaws = (await bob.page.evaluate(notWhole)).filter((line) => /^(call|the page is)/.test(line));
    assert.deepEqual(flaws, [], `${width} px wide`);
    await bob.page.getByTestId('calls').focus();
    await bob.page.keyboard.press('Escape');
  }
  for (const { page, problems } of [ann, bob]) {
    assert.deepEqual(problems, []);
    await page.close();
  }
});
