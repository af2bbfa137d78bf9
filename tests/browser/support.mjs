// Starts what the browser tests need: the program on a free port with an archive of its own, and Debian's Chromium.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtemp, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const { chromium } = createRequire(path.join(root, 'web/package.json'))('playwright-core');

const program = process.env.AEOLIS_PROGRAM ?? process.env.AEOLIS_BINARY ?? path.join(root, 'build/release/aeolis');
const START_MS = 15_000;

export async function temporaryFolder() {
    const folder = await mkdtemp(path.join(tmpdir(), 'aeolis-browser-'));
    return { folder, remove: () => rm(folder, { recursive: true, force: true }) };
}

/** `aeolis serve`; `port` 0 takes a free one. */
export async function serve({ archive, port = 0, more = [] }) {
    const child = spawn(program, ['serve', '--listen', `127.0.0.1:${port}`, '--archive', archive,
        '--web', path.join(root, 'web/dist'), ...more], { stdio: ['ignore', 'pipe', 'pipe'] });
    let said = '';
    const address = await new Promise((resolve, reject) => {
        const late = setTimeout(() => reject(new Error(`no address after ${START_MS} ms; it said: ${said}`)), START_MS);
        const listen = (chunk) => {
            said += chunk;
            const found = /http:\/\/127\.0\.0\.1:(\d+)/.exec(said);
            if (found) {
                clearTimeout(late);
                resolve(found[0]);
            }
        };
        child.stdout.on('data', listen);
        child.stderr.on('data', listen);
        child.on('error', reject);
        child.on('exit', (code) => reject(new Error(`it ended with ${code}; it said: ${said}`)));
    });
    const end = async (signal) => {
        if (child.exitCode !== null || child.signalCode !== null) return;
        child.kill(signal);
        await once(child, 'exit');
    };
    return {
        address, port: Number(new URL(address).port), said: () => said,
        kill: () => end('SIGKILL'),
        stop: async () => {
            const late = setTimeout(() => child.kill('SIGKILL'), 5_000);
            await end('SIGTERM');
            clearTimeout(late);
        },
        get: async (route) => (await fetch(`${address}/api/v1${route}`)).json(),
    };
}

export async function browser() {
    return chromium.launch({
        executablePath: process.env.AEOLIS_CHROMIUM ?? '/usr/bin/chromium',
        args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
            '--disable-background-networking', '--disable-component-update', '--disable-sync'],
    });
}

/** A page that fails the test when its scripts do. */
export async function open(chrome, address, size = { width: 1920, height: 1080 }) {
    const page = await chrome.newPage({ viewport: size });
    const problems = [];
    page.on('pageerror', (error) => problems.push(String(error)));
    page.on('console', (message) => {
        // A connection that is refused while the server is down is what one of the tests is about.
        if (message.type() === 'error' && !/ERR_CONNECTION|WebSocket/.test(message.text())) problems.push(message.text());
    });
    page.setDefaultTimeout(20_000);
    await page.goto(address);
    const text = (id) => page.getByTestId(id).innerText();
    return { page, problems, text, shows: (id, pattern, timeout) => waitFor(() => text(id), pattern, timeout) };
}

/** Waits until what `read` gives matches; fails with what it was last. */
export async function waitFor(read, wanted, timeout_ms = 20_000) {
    const end = Date.now() + timeout_ms;
    const fits = (value) => (wanted instanceof RegExp ? wanted.test(value) : wanted(value));
    for (;;) {
        const value = await read().catch((error) => String(error));
        if (fits(value)) return value;
        if (Date.now() > end) throw new Error(`not within ${timeout_ms} ms: ${wanted}; it was: ${String(value).slice(0, 400)}`);
        await new Promise((resolve) => setTimeout(resolve, 60));
    }
}

/** "E+00:04:28" in seconds. */
export function secondsFromEntry(text) {
    const [, sign, hours, minutes, seconds] = /E([+−])(\d+):(\d+):(\d+)/.exec(text) ?? [];
    const value = Number(hours) * 3600 + Number(minutes) * 60 + Number(seconds);
    return sign === '−' ? -value : value;
}
