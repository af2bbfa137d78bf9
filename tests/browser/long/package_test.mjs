// SPDX-License-Identifier: Apache-2.0
// The Debian package: made from the build of ./test, inspected, installed into an empty root, and started there.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import {
  chmodSync,
  copyFileSync,
  existsSync,
  lstatSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  readdirSync,
  rmSync,
  statSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import https from 'node:https';
import { tmpdir } from 'node:os';
import { basename, dirname, join, resolve } from 'node:path';
import test from 'node:test';

const program = resolve(process.env.AEOLIS_PROGRAM ?? 'build/release/aeolis');
const page = readFileSync(resolve(import.meta.dirname, '../../../docs/operations.md'), 'utf8');
const folder = mkdtempSync(join(tmpdir(), 'aeolis-package-'));
test.after(() => rmSync(folder, { recursive: true, force: true }));

const once = (make) => {
  let made;
  return () => (made ??= make());
};

const package_file = once(() => {
  const made = join(folder, 'made');
  mkdirSync(made);
  // Built by a user with a restrictive umask, which the package's files must not inherit.
  execFileSync(
    'sh',
    ['-c', 'umask 0077; exec cpack --config "$0" -B "$1"', join(dirname(program), 'CPackConfig.cmake'), made],
    { stdio: 'pipe' },
  );
  const [file] = readdirSync(made).filter((name) => name.endsWith('.deb'));
  assert.match(file, /^aeolis_[0-9.]+_\w+\.deb$/);
  return join(made, file);
});

/** Its files as they lie below /, and in DEBIAN the scripts that dpkg runs. */
const unpacked = once(() => {
  const there = join(folder, 'unpacked');
  execFileSync('dpkg-deb', ['-R', package_file(), there]);
  return there;
});
const unit_path = () => join(unpacked(), 'usr/lib/systemd/system/aeolis.service');
const scripts = ['postinst', 'prerm', 'postrm'];

/** The same files as a later version. */
const next_version = once(() => {
  const there = join(folder, 'next');
  execFileSync('cp', ['-a', unpacked(), there]);
  const control = join(there, 'DEBIAN/control');
  writeFileSync(control, readFileSync(control, 'utf8').replace(/^Version: .*$/m, '$&.1'));
  execFileSync('dpkg-deb', ['--root-owner-group', '-Znone', '-b', there, `${there}.deb`], { stdio: 'pipe' });
  return `${there}.deb`;
});

/** An empty root with dpkg in it. Libraries are taken from the machine. */
const empty_root = (name) => {
  const root = join(folder, name);
  for (const part of ['info', 'updates', 'triggers']) mkdirSync(join(root, 'var/lib/dpkg', part), { recursive: true });
  for (const part of ['status', 'available']) writeFileSync(join(root, 'var/lib/dpkg', part), '');
  const options = [
    `--root=${root}`,
    '--force-depends',
    '--force-not-root',
    '--force-script-chrootless',
    `--log=${join(folder, 'log')}`,
  ];
  return {
    root,
    dpkg: (args, env) =>
      execFileSync('dpkg', [...options, ...args], { encoding: 'utf8', stdio: 'pipe', env: { ...process.env, ...env } }),
  };
};

/** Stand-ins of these names, first in PATH, that only record their calls. */
const recorders = (...names) => {
  const there = mkdtempSync(join(folder, 'recorders-'));
  const record = join(there, 'calls');
  writeFileSync(record, '');
  for (const name of names)
    writeFileSync(join(there, name), `#!/bin/sh\necho "${name} $*" >>'${record}'\n`, { mode: 0o755 });
  return {
    PATH: `${there}:${process.env.PATH}`,
    calls: () => readFileSync(record, 'utf8').split('\n').filter(Boolean),
  };
};

/** The address that a started server prints. */
const address_of = (server) =>
  new Promise((found, failed) => {
    let text = '';
    const listen = (piece) => {
      text += piece;
      const at = /https?:\/\/\S+\//.exec(text);
      if (at) found(at[0]);
    };
    server.stdout.on('data', listen);
    server.stderr.on('data', (piece) => (text += piece));
    server.on('exit', (status) => failed(new Error(`it ended with ${status}: ${text}`)));
  });

test('the package installs into an empty root and its server runs from there, by its file of settings', async () => {
  const { root, dpkg } = empty_root('root');
  dpkg(['-i', package_file()]);
  for (const path of [
    'usr/bin/aeolis',
    'etc/aeolis/aeolis.conf',
    'lib/systemd/system/aeolis.service',
    'usr/share/doc/aeolis/copyright',
  ])
    assert.ok(existsSync(join(root, path)) || existsSync(join(root, 'usr', path)), `${path} is not there`);

  const settings = join(folder, 'settings.conf');
  const archive = join(folder, 'by-file.db');
  writeFileSync(settings, `listen=127.0.0.1:0\narchive=${archive}\nlog-format=json\n`);
  const server = spawn(join(root, 'usr/bin/aeolis'), ['serve', '--config', settings], {
    cwd: folder,
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  const log = [];
  server.stderr.on('data', (piece) => log.push(...piece.toString().split('\n').filter(Boolean)));
  const address = await address_of(server);
  const page = await fetch(address);
  assert.equal(page.status, 200, 'the console is in the package');
  const scenarios = await (await fetch(`${address}api/v1/scenarios`)).json();
  assert.ok(scenarios.scenarios.length > 5);
  const started = await fetch(`${address}api/v1/rehearsals`, {
    method: 'POST',
    body: '{"scenario":"nominal","pace":100}',
  });
  assert.equal(started.status, 201, await started.text());
  server.kill('SIGTERM');
  assert.equal(await new Promise((ended) => server.on('exit', ended)), 0);
  assert.ok(existsSync(archive));
  assert.ok(log.length > 0);
  for (const line of log) assert.ok(JSON.parse(line).message, line);

  dpkg(['--purge', 'aeolis']);
  assert.ok(!existsSync(join(root, 'usr/bin/aeolis')));
});

test('what a document names is in the package: the pages, their pictures, and the one that the unit shows', () => {
  const documents = join(unpacked(), 'usr/share/doc/aeolis');
  const [, shown] = /^Documentation=file:\/\/(.*)$/m.exec(readFileSync(unit_path(), 'utf8'));
  assert.ok(existsSync(join(unpacked(), shown)), shown);
  const pages = readdirSync(documents, { recursive: true }).filter((name) => name.endsWith('.md'));
  for (const name of ['operations.md', 'user-guide.md', 'archive.md', 'architecture.md', 'licences.md'])
    assert.ok(pages.includes(name), name);
  for (const name of pages)
    for (const [, to] of readFileSync(join(documents, name), 'utf8').matchAll(/\]\((?!\w+:|#)([^)#\s]+)/g))
      assert.ok(existsSync(join(documents, dirname(name), to)), `${name} leads to ${to}`);
});

test("the package's files are root's, nobody else may write them, and its scripts are sound", () => {
  for (const line of execFileSync('dpkg-deb', ['-c', package_file()], { encoding: 'utf8' }).trim().split('\n'))
    assert.match(line, /^(-rwxr-xr-x|-rw-r--r--|drwxr-xr-x) root\/root /);
  for (const name of scripts) assert.equal(statSync(join(unpacked(), 'DEBIAN', name)).mode & 0o777, 0o755, name);
  const paths = scripts.map((name) => join(unpacked(), 'DEBIAN', name));
  for (const path of paths) execFileSync('sh', ['-n', path]);
  execFileSync('shellcheck', paths, { stdio: 'pipe' });
});

test('an upgrade restarts the server that runs, and only that; removing stops it before its files go', () => {
  const { PATH, calls } = recorders('systemctl', 'deb-systemd-invoke', 'deb-systemd-helper');
  const booted = join(folder, 'booted'); // replaces the folder that marks a machine running systemd
  mkdirSync(booted);
  const run = (name, ...args) => {
    const before = calls().length;
    const text = readFileSync(join(unpacked(), 'DEBIAN', name), 'utf8')
      .replaceAll('/run/systemd/system', booted)
      .replaceAll('/var/lib/aeolis', join(folder, 'none'));
    execFileSync('sh', ['-c', text, name, ...args], {
      env: { PATH, DPKG_MAINTSCRIPT_PACKAGE: 'aeolis' },
      stdio: 'pipe',
    });
    return calls()
      .slice(before)
      .filter((call) => !call.startsWith('deb-systemd-helper'));
  };
  const reload = 'systemctl --system daemon-reload';
  assert.deepEqual(run('postinst', 'configure', ''), [reload]);
  assert.deepEqual(run('prerm', 'upgrade', '9'), []);
  assert.deepEqual(run('postrm', 'upgrade', '9'), []);
  assert.deepEqual(run('postinst', 'configure', '0.1.0'), [reload, 'deb-systemd-invoke try-restart aeolis.service']);
  assert.deepEqual(run('prerm', 'remove'), ['deb-systemd-invoke stop aeolis.service']);
  assert.deepEqual(run('postrm', 'remove'), [reload]);
  assert.deepEqual(run('postrm', 'purge'), []);

  rmSync(booted, { recursive: true });
  for (const [name, ...args] of [
    ['postinst', 'configure', '0.1.0'],
    ['prerm', 'remove'],
    ['postrm', 'remove'],
  ])
    assert.deepEqual(run(name, ...args), [], 'without systemd');
});

test('installed, upgraded, removed and purged in a root, no link leads nowhere, what was flown stays and is said, and the machine around it is not asked', () => {
  const { root, dpkg } = empty_root('whole-life');
  const { PATH, calls } = recorders('systemctl', 'deb-systemd-invoke');
  const there = (path) => existsSync(join(root, path));
  dpkg(['-i', package_file()], { PATH });
  const wants = join(root, 'etc/systemd/system/multi-user.target.wants');
  const link = join(wants, 'aeolis.service');
  assert.ok(!there('etc/systemd/system'), 'who operates it enables it');
  mkdirSync(wants, { recursive: true });
  symlinkSync('/lib/systemd/system/aeolis.service', link); // as systemctl enable does
  writeFileSync(join(root, 'etc/aeolis/aeolis.conf'), '# mine\n');
  mkdirSync(join(root, 'var/lib/private/aeolis'), { recursive: true });
  symlinkSync('private/aeolis', join(root, 'var/lib/aeolis')); // as systemd does for a dynamic user
  writeFileSync(join(root, 'var/lib/aeolis/aeolis.db'), 'runs');

  dpkg(['-i', next_version()], { PATH });
  assert.ok(lstatSync(link).isSymbolicLink(), 'still enabled');
  assert.equal(readFileSync(join(root, 'etc/aeolis/aeolis.conf'), 'utf8'), '# mine\n');
  dpkg(['--remove', 'aeolis'], { PATH });
  assert.throws(() => lstatSync(link), /ENOENT/);
  assert.ok(!there('usr/bin/aeolis') && there('etc/aeolis/aeolis.conf') && there('var/lib/aeolis/aeolis.db'));
  const purged = spawnSync(
    'dpkg',
    [
      `--root=${root}`,
      '--force-not-root',
      '--force-script-chrootless',
      `--log=${join(folder, 'log')}`,
      '--purge',
      'aeolis',
    ],
    { encoding: 'utf8', env: { ...process.env, PATH } },
  );
  assert.equal(purged.status, 0, purged.stderr);
  assert.match(purged.stderr, /runs, accounts and audit stay in \/var\/lib\/aeolis/);
  assert.equal(readFileSync(join(root, 'var/lib/aeolis/aeolis.db'), 'utf8'), 'runs');
  assert.ok(!there('etc/aeolis'));
  const left = execFileSync('find', [root, '-mindepth', '1', '-printf', '%P\\n'], { encoding: 'utf8' }).split('\n');
  assert.deepEqual(left.filter((name) => /aeolis|deb-systemd/.test(name)).sort(), [
    'var/lib/aeolis',
    'var/lib/private/aeolis',
    'var/lib/private/aeolis/aeolis.db',
  ]);
  assert.deepEqual(calls(), []);
});

test("systemd understands the unit with the page's credentials, and finds it closed", () => {
  const there = join(folder, 'units');
  mkdirSync(join(there, 'aeolis.service.d'), { recursive: true });
  const unit = join(there, 'aeolis.service');
  writeFileSync(unit, readFileSync(unit_path(), 'utf8').replace('ExecStart=', `ExecStart=${unpacked()}`));
  const lines = [...page.matchAll(/LoadCredential=\S+/g)].map(String);
  assert.equal(lines.length, 2);
  writeFileSync(join(there, 'aeolis.service.d/override.conf'), `[Service]\n${lines.join('\n')}\n`);
  const verified = spawnSync('systemd-analyze', ['verify', '--man=no', unit], { encoding: 'utf8' });
  assert.equal(verified.status, 0, verified.stderr);
  assert.doesNotMatch(verified.stderr, /aeolis/);
  // Tenths of ten. Most of the remaining exposure is the network access that a server needs.
  const exposure = spawnSync('systemd-analyze', ['security', '--offline=true', '--threshold=20', unit], {
    encoding: 'utf8',
  });
  assert.equal(exposure.status, 0, exposure.stdout + exposure.stderr);
});

test("the unit's own line, the package's settings and the page's serve TLS with the credentials that systemd hands in", async (t) => {
  const state = join(folder, 'state');
  const credentials = join(folder, 'credentials');
  for (const made of [state, credentials]) mkdirSync(made);
  t.after(() => chmodSync(credentials, 0o700));
  execFileSync('sh', ['-e', '-c', /`(openssl req [^`]+)`/.exec(page)[1]], { cwd: folder, stdio: 'pipe' });
  for (const [, name, from] of page.matchAll(/LoadCredential=([^:\s]+):(\S+)/g)) {
    copyFileSync(join(folder, basename(from)), join(credentials, name));
    chmodSync(join(credentials, name), 0o400);
  }
  chmodSync(credentials, 0o500);

  const here = (text) =>
    text.replaceAll('/run/credentials/aeolis.service', credentials).replaceAll('/var/lib/aeolis', state);
  const settings = join(folder, 'aeolis.conf');
  const [, added] = /<<'END'\n(.*?)^END$/ms.exec(page);
  writeFileSync(
    settings,
    here(readFileSync(join(unpacked(), 'etc/aeolis/aeolis.conf'), 'utf8') + added).replace(
      '0.0.0.0:8443',
      '127.0.0.1:0',
    ),
  );
  const unit = readFileSync(unit_path(), 'utf8');
  const said = (key) => new RegExp(`^${key}=(.*)$`, 'm').exec(unit)[1];
  const line = said('ExecStart')
    .replace('/usr/bin/', `${unpacked()}/usr/bin/`)
    .replace('/etc/aeolis/aeolis.conf', settings)
    .split(' ');
  const server = spawn('sh', ['-c', `umask ${said('UMask')}; exec "$@"`, 'sh', ...line], {
    cwd: here(said('WorkingDirectory')),
    env: { PATH: process.env.PATH, STATE_DIRECTORY: state, CREDENTIALS_DIRECTORY: credentials },
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  t.after(() => server.kill('SIGKILL'));
  const { port } = new URL(await address_of(server));
  assert.notEqual(port, '8080', "the page's address, which stands after the package's, is the one that counts");
  const status = await new Promise((found, failed) =>
    https
      .get(
        {
          host: '127.0.0.1',
          port,
          path: '/healthz',
          servername: 'station.example',
          headers: { host: `station.example:${port}` },
          ca: readFileSync(join(folder, 'cert.pem')),
        },
        (answer) => found(answer.resume().statusCode),
      )
      .on('error', failed),
  );
  assert.equal(status, 200);
  server.kill('SIGTERM');
  assert.equal(await new Promise((ended) => server.on('exit', ended)), 0);
  assert.deepEqual(readdirSync(state).sort(), ['accounts.json', 'aeolis.db']);
  for (const name of readdirSync(state))
    assert.equal(statSync(join(state, name)).mode & 0o077, 0, `${name} is nobody else's`);
});

test('the command line counts before the environment, and that before the file; what a file has wrong is named', async () => {
  const settings = join(folder, 'order.conf');
  writeFileSync(settings, `listen=127.0.0.1:0\narchive=${join(folder, 'file.db')}\n`);
  const started = async (args, env) => {
    const server = spawn(program, ['serve', '--config', settings, ...args], {
      cwd: folder,
      env: { ...process.env, ...env },
    });
    await address_of(server);
    server.kill('SIGTERM');
    await new Promise((ended) => server.on('exit', ended));
  };
  await started([], {});
  assert.ok(existsSync(join(folder, 'file.db')));
  await started([], { AEOLIS_ARCHIVE: join(folder, 'environment.db') });
  assert.ok(existsSync(join(folder, 'environment.db')));
  await started(['--archive', join(folder, 'flag.db')], { AEOLIS_ARCHIVE: join(folder, 'other.db') });
  assert.ok(existsSync(join(folder, 'flag.db')) && !existsSync(join(folder, 'other.db')));

  writeFileSync(settings, 'lisen=127.0.0.1:0\n');
  assert.throws(() => execFileSync(program, ['serve', '--config', settings], { stdio: 'pipe' }), /lisen/);
  writeFileSync(settings, 'listen=nowhere\n');
  assert.throws(() => execFileSync(program, ['serve', '--config', settings], { stdio: 'pipe' }), /nowhere/);
});
