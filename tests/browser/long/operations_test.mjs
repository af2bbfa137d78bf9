// SPDX-License-Identifier: Apache-2.0
// Runs docs/operations.md as it stands: from accounts and TLS by a file of settings to a rehearsal, an export and a
// campaign.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { program, root, temporaryFolder } from '../support.mjs';

const page = readFileSync(path.join(root, 'docs/operations.md'), 'utf8');
/** The shell lines under a heading. */
const shell_of = (heading) => {
  const section = page.split(/^## /m).find((each) => each.startsWith(heading));
  assert.ok(section, `the page has no heading ${heading}`);
  return [...section.matchAll(/^```sh\n(.*?)^```$/gms)].map((block) => block[1]);
};

test('the page of operations leads from a secured server with two users to a rehearsal, an export and a campaign', async (t) => {
  const { folder, remove } = await temporaryFolder();
  t.after(remove);
  const state = path.join(folder, 'state');
  const credentials = path.join(folder, 'credentials');
  for (const made of [state, credentials]) mkdirSync(made);
  let port = '8443';
  // With folders and a port of the test, and without a password prompt. The rest is the page's.
  const here = (text) =>
    text
      .replaceAll('/var/lib/aeolis', state)
      .replaceAll('/run/credentials/aeolis.service', credentials)
      .replaceAll('8443', port)
      .replaceAll('sudo aeolis', program);
  const run = (text) =>
    execFileSync('bash', ['-e', '-u', '-o', 'pipefail', '-c', text], {
      cwd: folder,
      env: { ...process.env, HOME: folder },
      encoding: 'utf8',
      stdio: 'pipe',
    });

  run(/`(openssl req [^`]+)`/.exec(page)[1]);
  for (const name of ['cert.pem', 'key.pem']) execFileSync('cp', [path.join(folder, name), credentials]);
  const [settings, users] = shell_of('Who may use it');
  const given = /<<'END'\n(.*?)^END$/ms.exec(settings)[1];
  writeFileSync(
    path.join(folder, 'aeolis.conf'),
    `${here(given).replace(/listen=\S+/, 'listen=127.0.0.1:0')}archive=${path.join(state, 'aeolis.db')}\n`,
  );
  const server = spawn(program, ['serve', '--config', 'aeolis.conf'], {
    cwd: folder,
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  t.after(() => server.kill('SIGKILL'));
  let said = '';
  const answer = await new Promise((found, failed) => {
    const listen = (chunk) => {
      said += chunk;
      const all = [/https:\/\/\S+:(\d+)\//.exec(said), /administrator with (\S+)/.exec(said)];
      if (all.every(Boolean)) found(all.map((each) => each[1]));
    };
    server.stdout.on('data', listen);
    server.stderr.on('data', listen);
    server.on('exit', (code) => failed(new Error(`it ended with ${code}: ${said}`)));
  });
  port = answer[0];
  const first = answer[1];
  // In place of a name service and of --cacert.
  writeFileSync(
    path.join(folder, '.curlrc'),
    `resolve = "station.example:${port}:127.0.0.1"\ncacert = "${path.join(folder, 'cert.pem')}"\n`,
  );

  const [way_in, with_secret] = here(users)
    .replaceAll('FIRST', first)
    .split(/^(?=curl .*SECRET)/m);
  const made = run(way_in);
  const secret = /"token":"([^"]+)"/.exec(made)?.[1];
  assert.ok(secret, `a token has its secret in the answer: ${made}`);
  const known = `${way_in.split('\n').slice(0, 2).join('\n')}\n`;
  const audit = run(known + with_secret.replace('SECRET', secret));
  for (const word of ['dina', 'carl', 'exporter', 'log-in']) assert.match(audit, new RegExp(word));

  const [rehearsal] = shell_of('A rehearsal');
  const [begin, ...rest] = here(rehearsal).split('\n');
  assert.match(run(`${known}${begin}`), /"scenario":"nominal_auto"/);
  for (
    let tries = 0;
    !/"sclk":\[\d/.test(run(`${known}$C $A'/runs/latest/channels?names=altitude_m&points=2'`));
    ++tries
  ) {
    // as slow as people
    assert.ok(tries < 400, 'the run brings nothing');
    await new Promise((done) => setTimeout(done, 200));
  }
  run(known + rest.join('\n'));
  assert.ok(statSync(path.join(folder, 'samples.jsonl')).size > 1_000);
  assert.match(readFileSync(path.join(folder, 'samples.csv'), 'utf8'), /altitude_m/);
  const [campaign] = shell_of('A campaign');
  assert.match(run(known + here(campaign)), /"campaign":"campaign-1"/);

  server.kill('SIGTERM');
  const [code] = await once(server, 'exit');
  assert.equal(code, 0, said);
  assert.match(run(`${program} archive verify --archive ${path.join(state, 'aeolis.db')}`), /audit/);
});
