// The Debian package: made from what ./test has built, installed into an empty root, and started there.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import test from 'node:test';

const program = resolve(process.env.AEOLIS_PROGRAM ?? 'build/release/aeolis');
const folder = mkdtempSync(join(tmpdir(), 'aeolis-package-'));
test.after(() => rmSync(folder, { recursive: true, force: true }));

/** What a started server says of its address. */
const address_of = (server) =>
    new Promise((found, failed) => {
        let text = '';
        server.stdout.on('data', (piece) => {
            text += piece;
            const at = /http:\/\/\S+\//.exec(text);
            if (at) found(at[0]);
        });
        server.on("exit", (status) => failed(new Error(`it ended with ${status}: ${text}`)));
    });

test('the package installs into an empty root and its server runs from there, by its file of settings', async () => {
    const made = join(folder, 'made');
    mkdirSync(made);
    execFileSync('cpack', ['--config', join(dirname(program), 'CPackConfig.cmake'), '-B', made], { stdio: 'pipe' });
    const [file] = readdirSync(made).filter((name) => name.endsWith('.deb'));
    assert.match(file, /^aeolis_[0-9.]+_\w+\.deb$/);

    const root = join(folder, 'root');
    for (const name of ['info', 'updates', 'triggers']) mkdirSync(join(root, 'var/lib/dpkg', name), { recursive: true });
    for (const name of ['status', 'available']) writeFileSync(join(root, 'var/lib/dpkg', name), '');
    // Its libraries are those of the machine, so the empty root need not have them.
    const dpkg = ['--root=' + root, '--force-depends', '--force-not-root', '--force-script-chrootless', '--log=' + join(folder, 'log')];
    execFileSync('dpkg', [...dpkg, '-i', join(made, file)], { stdio: 'pipe' });
    for (const path of ['usr/bin/aeolis', 'etc/aeolis/aeolis.conf', 'lib/systemd/system/aeolis.service', 'usr/share/doc/aeolis/copyright'])
        assert.ok(existsSync(join(root, path)) || existsSync(join(root, "usr", path)), `${path} is not there`);

    const settings = join(folder, 'settings.conf');
    const archive = join(folder, 'by-file.db');
    writeFileSync(settings, `listen=127.0.0.1:0\narchive=${archive}\nlog-format=json\n`);
    const server = spawn(join(root, 'usr/bin/aeolis'), ['serve', '--config', settings], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
    const log = [];
    server.stderr.on('data', (piece) => log.push(...piece.toString().split('\n').filter(Boolean)));
    const address = await address_of(server);
    const page = await fetch(address);
    assert.equal(page.status, 200, 'the console is in the package');
    const scenarios = await (await fetch(address + 'api/v1/scenarios')).json();
    assert.ok(scenarios.scenarios.length > 5);
    const started = await fetch(address + "api/v1/rehearsals", { method: "POST", body: '{"scenario":"nominal","pace":100}' });
    assert.equal(started.status, 201, await started.text());
    server.kill('SIGTERM');
    assert.equal(await new Promise((ended) => server.on('exit', ended)), 0);
    assert.ok(existsSync(archive));
    assert.ok(log.length > 0);
    for (const line of log) assert.ok(JSON.parse(line).message, line);

    execFileSync('dpkg', [...dpkg, '--purge', 'aeolis'], { stdio: 'pipe' });
    assert.ok(!existsSync(join(root, 'usr/bin/aeolis')));
});

test('the command line counts before the environment, and that before the file; what a file has wrong is named', async () => {
    const settings = join(folder, 'order.conf');
    writeFileSync(settings, `listen=127.0.0.1:0\narchive=${join(folder, "file.db")}\n`);
    const started = async (args, env) => {
        const server = spawn(program, ['serve', '--config', settings, ...args], { cwd: folder, env: { ...process.env, ...env } });
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
