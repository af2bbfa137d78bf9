// SPDX-License-Identifier: Apache-2.0
// Starts the program on a free port with an archive of its own, and Debian's Chromium, for the browser tests.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { readFileSync } from 'node:fs';
import { mkdtemp, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { connect, createServer } from 'node:net';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after } from 'node:test';
import { fileURLToPath } from 'node:url';

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const { chromium } = createRequire(path.join(root, 'web/package.json'))('playwright-core');

export const program =
  process.env.AEOLIS_PROGRAM ?? process.env.AEOLIS_BINARY ?? path.join(root, 'build/release/aeolis');
// chosen: limit of every wait. Only a failure waits this long, and a busy machine fails nothing
const DEADLINE_MS = 120_000;
const TICKS_HZ = 100; // of /proc, on every Linux

export async function temporaryFolder() {
  const folder = await mkdtemp(path.join(tmpdir(), 'aeolis-browser-'));
  return { folder, remove: () => rm(folder, { recursive: true, force: true }) };
}

/** `aeolis serve`; `port` 0 takes a free one. */
export async function serve({ archive, port = 0, planFlights = 0, more = [], web = path.join(root, 'web/dist') }) {
  const child = spawn(
    program,
    [
      'serve',
      '--listen',
      `127.0.0.1:${port}`,
      '--archive',
      archive,
      '--web',
      web,
      '--plan-flights',
      `${planFlights}`,
      ...more,
    ],
    { stdio: ['ignore', 'pipe', 'pipe'] },
  );
  let said = '';
  const address = await new Promise((resolve, reject) => {
    const late = setTimeout(
      () => reject(new Error(`no address after ${DEADLINE_MS} ms; it said: ${said}`)),
      DEADLINE_MS,
    );
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
    address,
    port: Number(new URL(address).port),
    said: () => said,
    /** Processor time that it has used, in seconds. */
    processor_s: () => {
      const [utime, stime] = readFileSync(`/proc/${child.pid}/stat`, 'utf8')
        .replace(/.*\) /, '')
        .split(' ')
        .slice(11, 13);
      return (Number(utime) + Number(stime)) / TICKS_HZ;
    },
    kill: () => end('SIGKILL'),
    stop: async () => {
      const late = setTimeout(() => child.kill('SIGKILL'), 5_000);
      await end('SIGTERM');
      clearTimeout(late);
    },
    get: async (route) => (await fetch(`${address}/api/v1${route}`)).json(),
  };
}

/**
 * `scrollbars` are hidden, as Playwright has it, unless asked for: then they take their room as in a window. `more`:
 * further arguments of the browser.
 */
export async function browser({ scrollbars = false, more = [] } = {}) {
  return chromium.launch({
    executablePath: process.env.AEOLIS_CHROMIUM ?? '/usr/bin/chromium',
    ignoreDefaultArgs: scrollbars ? ['--hide-scrollbars'] : [],
    args: [
      '--headless',
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
      ...more,
    ],
  });
}

/**
 * The resources shared by the tests of one file: a browser and a folder. A server of the test `t` ends with it, any
 * other with the file.
 */
export function workplace(options = {}) {
  let made;
  const servers = [];
  const both = () => (made ??= Promise.all([browser(options), temporaryFolder()]));
  after(async () => {
    const [chrome, folder] = await both();
    await Promise.all(servers.map((server) => server.stop()));
    await chrome.close();
    await folder.remove();
  });
  return {
    open: async (address, size, script) => open((await both())[0], address, size, script),
    /** With the archive NAME of this file's folder. */
    serve: async (t, name, more = [], options = {}) => {
      const [, { folder }] = await both();
      const server = await serve({ archive: path.join(folder, `${name}.db`), more, ...options });
      servers.push(server);
      t?.after(() => server.stop());
      return server;
    },
  };
}

/**
 * A server with a landing flown at the highest pace, for tests that only look at it. It ends with the test `t`, or with
 * the file.
 */
export async function landed(serve, t) {
  const server = await serve(t, 'landed', ['--scenario', 'nominal_auto', '--pace', '0']);
  await untilRun(server, ({ state }) => state === 'finished');
  return server;
}

/**
 * Waits until the newest run `isThere`. A busy machine flies slowly: it fails only once the run, or the flight before
 * its beginning, has stood still for as long as any wait lasts.
 */
export async function untilRun(server, isThere) {
  let [seen, end] = ['', 0];
  for (;;) {
    const [run] = (await server.get('/runs')).runs;
    if (run && (await isThere(run))) return;
    const now = run
      ? `it is ${run.state} at ${run.clocks?.e_s} s from entry, item ${run.last_seq}`
      : `there is none after ${5 * Math.floor(server.processor_s() / 5)} s of processor time`;
    if (now !== seen) [seen, end] = [now, Date.now() + DEADLINE_MS];
    else if (Date.now() > end) throw new Error(`the run stood still for ${DEADLINE_MS} ms: ${now}`);
    await new Promise((resolve) => setTimeout(resolve, 60));
  }
}

/** Orders one thing of the rehearsal of `server`: its pace, or a pause. */
export async function control(server, order) {
  const answer = await fetch(`${server.address}/api/v1/rehearsals/current`, {
    method: 'POST',
    body: JSON.stringify(order),
  });
  if (!answer.ok) throw new Error(`${JSON.stringify(order)}: ${answer.status} ${await answer.text()}`);
}

/**
 * Brings the rehearsal of `server` to `e_s` seconds from entry and holds it there. It slows down on approach, so that a
 * busy machine does not overshoot.
 */
export async function flyTo(server, e_s) {
  await control(server, { pause: false });
  let pace;
  await untilRun(server, async ({ clocks }) => {
    if (!clocks) return false; // it has just begun
    const left_s = e_s - clocks.e_s;
    const wanted = [100, 50, 20, 10, 5, 2, 1].find((each) => each * 2 <= left_s) ?? 1;
    if (left_s > 0 && wanted !== pace) {
      pace = wanted;
      await control(server, { pace });
    }
    return left_s <= 0;
  });
  await control(server, { pause: true });
}

/** A page that fails the test when its scripts do. */
export async function open(chrome, address, size = { width: 1920, height: 1080 }, script = undefined) {
  const page = await chrome.newPage({ viewport: size });
  if (script) await page.addInitScript(script);
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => {
    // One of the tests needs refused connections while the server is down.
    if (message.type() === 'error' && !/ERR_CONNECTION|WebSocket/.test(message.text()))
      problems.push(`${message.text()} ${message.location().url}`);
  });
  page.setDefaultTimeout(DEADLINE_MS);
  await page.goto(address);
  const text = (id) => page.getByTestId(id).innerText();
  return { page, problems, text, shows: (id, pattern, timeout) => waitFor(() => text(id), pattern, timeout) };
}

const axe = createRequire(path.join(root, 'web/package.json')).resolve('axe-core/axe.min.js');

/**
 * The findings of axe, one line each: rule, number of places, the first of them. In the second theme only rules about
 * colours.
 */
export async function findings(page, theme) {
  // like a debugger: a page's policy forbids foreign scripts
  if (!(await page.evaluate(() => 'axe' in window))) await page.evaluate(readFileSync(axe, 'utf8'));
  const rules =
    theme === 'dark'
      ? ['wcag2a', 'wcag2aa', 'wcag21aa', 'wcag22aa', 'best-practice']
      : ['color-contrast', 'link-in-text-block'];
  const { violations } = await page.evaluate((runOnly) => window.axe.run(document, { runOnly }), rules);
  return violations.map(
    ({ id, nodes }) => `${id} × ${nodes.length}: ${nodes[0].target} ${nodes[0].failureSummary.split('\n')[1] ?? ''}`,
  );
}

/** Waits until the result of `read` matches; fails with the last result. An error does not match. */
export async function waitFor(read, wanted, timeout_ms = DEADLINE_MS) {
  const end = Date.now() + timeout_ms;
  const fits = (value) => (wanted instanceof RegExp ? wanted.test(value) : wanted(value));
  for (;;) {
    let last;
    try {
      const value = await read();
      if (fits(value)) return value;
      last = value;
    } catch (error) {
      last = error;
    }
    if (Date.now() > end)
      throw new Error(`not within ${timeout_ms} ms: ${wanted}; it was: ${String(last).slice(0, 400)}`);
    await new Promise((resolve) => setTimeout(resolve, 60));
  }
}

/**
 * Waits until header, panels and pictures have not moved for ten frames, so that a measurement after a resize is final.
 */
export async function comesToRest(page) {
  let before;
  for (const end = Date.now() + DEADLINE_MS; Date.now() < end; ) {
    await page.evaluate(async () => {
      for (let frame = 0; frame < 10; ++frame) await new Promise(requestAnimationFrame);
    });
    const now = await page.evaluate(() =>
      [...document.querySelectorAll('header, main, .panel, canvas')]
        .map((each) => Object.values(each.getBoundingClientRect().toJSON()).join())
        .join(';'),
    );
    if (now === before) return;
    before = now;
  }
}

/**
 * A proxy to a server on `port` that can be cut and restored, or frozen silently, while the server goes on. Frozen
 * connections stay frozen; connections after a thaw pass.
 */
export async function breakable(port) {
  const open = new Set();
  let broken = false;
  let frozen = false;
  const swallow = (socket) => socket.unpipe().resume();
  const way = createServer((near) => {
    if (broken) return near.destroy();
    if (frozen) return open.add(swallow(near.on('error', () => near.destroy())));
    const far = connect(port, '127.0.0.1');
    near.pipe(far).pipe(near);
    for (const [one, other] of [
      [near, far],
      [far, near],
    ]) {
      open.add(one);
      one
        .on('error', () => other.destroy())
        .on('close', () => {
          open.delete(one);
          other.destroy();
        });
    }
  });
  const cut = () => {
    broken = true;
    for (const socket of open) socket.destroy();
  };
  way.listen(0, '127.0.0.1');
  await once(way, 'listening');
  return {
    address: `http://127.0.0.1:${way.address().port}`,
    cut,
    mend: () => (broken = false),
    freeze: () => {
      frozen = true;
      for (const socket of open) swallow(socket);
    },
    thaw: () => (frozen = false),
    close: () => {
      cut();
      way.close();
    },
  };
}

/** Presses the keys of the pace until it is the wanted one. */
export async function setPace(page, wanted) {
  for (let presses = 0; presses < 12; ++presses) {
    const now = Number(await page.getByTestId('pace').inputValue());
    if (now === wanted) return;
    await page.keyboard.press(now === 0 || now > wanted ? '-' : '+');
    await waitFor(
      () => page.getByTestId('pace').inputValue(),
      (value) => Number(value) !== now,
    );
  }
  throw new Error(`the pace never became ${wanted}`);
}

/** The look of a stage of the newest command of this name in the history: ok, failed, unknown, pending, none. */
export const stageLook = (page, command, name) =>
  page.locator(`[data-command="${command}"] [data-stage="${name}"]`).first().getAttribute('data-look');

/** The test name of the focused element. */
export const focused = (page) => page.evaluate(() => document.activeElement?.dataset.testid);

/** Converts "E+4:28" to seconds. */
export function secondsFromEntry(text) {
  const [, sign, hours, minutes, seconds] = /E([+−])(?:(\d+):)?(\d+):(\d+)/.exec(text) ?? [];
  const value = Number(hours ?? 0) * 3600 + Number(minutes) * 60 + Number(seconds);
  return sign === '−' ? -value : value;
}
