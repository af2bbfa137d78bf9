// SPDX-License-Identifier: Apache-2.0
// One client beside another that takes all it can get: 60 slow questions at a time, 1000 commands a second and 1000
// subscriptions. The first one's plot and its hazardous command are held against what they take alone.
import { randomBytes } from 'node:crypto';
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, rmSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { Worker, isMainThread, parentPort, workerData } from 'node:worker_threads';

const program = 'build/release/aeolis';
const [plots, slow_questions, commands_per_s, subscriptions] = [300, 60, 1000, 1000];
const goals = { plot_ratio: 2, plot_ms: 50, command_ms: 100 };
const password = 'a password for this bench';
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Sends requests of the API to the server there. */
function askAt(address) {
  return async (method, path, body, cookie) => {
    const response = await fetch(`${address}/api/v1${path}`, {
      method,
      headers: { ...(cookie && { cookie }), ...(body && { 'content-type': 'application/json' }) },
      body: body && JSON.stringify(body),
    });
    return { status: response.status, text: await response.text(), cookie: response.headers.getSetCookie() };
  };
}

/** `aeolis serve` with an archive of one whole landing and a rehearsal that waits for its commands. */
async function serve(name, folder) {
  const archive = join(folder, `${name}.db`);
  const landed = 'simulation/scenarios/nominal_auto.textproto';
  execFileSync(program, ['rehearse', '--scenario', landed, '--seed', '1', '--archive', archive], { stdio: 'ignore' });
  const more = ['--scenario', 'nominal', '--accounts', join(folder, `${name}.json`)];
  const server = spawn(program, ['serve', '--listen', '127.0.0.1:0', '--archive', archive, ...more], {
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  let said = '';
  for (const stream of [server.stdout, server.stderr]) stream.on('data', (part) => (said += part));
  for (let i = 0; !/Aeolis is at http/.test(said) || !/administrator with \S+/.test(said); ++i) {
    if (i > 600) throw new Error(`aeolis serve does not begin: ${said}`);
    await pause(50);
  }
  const address = /http:\/\/127\.0\.0\.1:\d+/.exec(said)[0];
  const ask = askAt(address);
  const logIn = async (user, given) => {
    const { status, text, cookie } = await ask('POST', '/session', { user, password: given });
    if (status !== 200 && status !== 201) throw new Error(`log-in of ${user}: ${status} ${text}`);
    return cookie.map((each) => each.split(';')[0]).join('; ');
  };
  const ownPassword = async (user, given) => {
    const body = { current_password: given, password };
    const changed = await ask('PATCH', `/users/${user}`, body, await logIn(user, given));
    if (changed.status !== 200) throw new Error(`password of ${user}: ${changed.text}`);
    return logIn(user, password);
  };
  const admin = await ownPassword('administrator', /administrator with (\S+)/.exec(said)[1]);
  const cookies = {};
  for (const [user, role] of [
    ['dora', 'director'],
    ['greta', 'controller'],
  ]) {
    const made = await ask('POST', '/users', { user, role, password: 'given by another' }, admin);
    if (made.status !== 201) throw new Error(`user ${user}: ${made.text}`);
    cookies[user] = await ownPassword(user, 'given by another');
  }
  const end = async () => {
    server.kill('SIGTERM');
    await once(server, 'exit');
  };
  return { address, ask, cookies, end };
}

/** Milliseconds of each of some plots, one after another. */
async function plotTimes({ address, cookies }) {
  const took_ms = [];
  for (let i = 0; i < plots; ++i) {
    const begun = performance.now();
    const path = '/api/v1/runs/1/channels?names=altitude_m,speed_mps&points=2000&format=protobuf';
    const response = await fetch(address + path, { headers: { cookie: cookies.dora } });
    if (!response.ok) throw new Error(`plot: ${response.status} ${await response.text()}`);
    await response.arrayBuffer();
    took_ms.push(performance.now() - begun);
  }
  return took_ms.sort((a, b) => a - b);
}

/**
 * Milliseconds until the answer that "do edl" was released, of the request that was not refused. What becomes of it in
 * flight is not looked at.
 */
async function doEdl({ ask, cookies }) {
  const send = (body) => ask('POST', '/runs/2/commands', body, cookies.dora);
  const parameters = await send({ command: 'EDL_SET_PARAMETERS', from_solution: true });
  if (parameters.status !== 202) throw new Error(`parameters: ${parameters.text}`);
  for (let i = 0; i < 300; ++i) {
    const begun = performance.now();
    const sent = await send({ command: 'EDL_DO_EDL', armed: true, confirmation: 'EDL_DO_EDL' });
    if (sent.status === 202) return performance.now() - begun;
    if (sent.status !== 409) throw new Error(`do edl: ${sent.status} ${sent.text}`);
    await pause(100); // the parameters are not on board yet
  }
  throw new Error('do edl is refused for 30 s');
}

/** A subscription by hand: Node's own WebSocket is younger than Debian's Node. Calls `opened` if it is granted. */
function subscription(address, cookie, opened) {
  const { hostname, port } = new URL(address);
  const socket = connect(Number(port), hostname);
  const key = randomBytes(16).toString('base64');
  socket.write(
    `GET /api/v1/stream HTTP/1.1\r\nHost: ${hostname}:${port}\r\nOrigin: ${address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n` +
      `Sec-WebSocket-Key: ${key}\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: aeolis.v1.json\r\nCookie: ${cookie}\r\n\r\n`,
  );
  const text = Buffer.from(JSON.stringify({ subscribe: { run: '2', all_channels: true } }));
  socket.once('data', (head) => {
    if (!head.toString('latin1').startsWith('HTTP/1.1 101')) return;
    opened();
    socket.write(Buffer.concat([Buffer.from([0x81, 0x80 | text.length, 0, 0, 0, 0]), text]));
  });
  socket.on('data', () => undefined);
  socket.on('error', () => undefined);
  return socket;
}

/**
 * Takes all it can get, until it is told to end; then says what it got. It has a thread of its own, so that the other
 * client does not wait until this one's answers are read.
 */
function takeAll({ address, cookies }) {
  const ask = askAt(address);
  let over = false;
  const got = { questions: 0, refused: 0, commands: 0, limited: 0, subscriptions: 0 };
  const question = async () => {
    while (!over) {
      const { status } = await ask('GET', '/runs/1/proof', undefined, cookies.greta).catch(() => ({ status: 0 }));
      if (status === 200) ++got.questions;
      else ++got.refused;
      if (status !== 200) await pause(20);
    }
  };
  const flood = async () => {
    while (!over) {
      const some = Array.from({ length: commands_per_s / 20 }, async () => {
        const { status } = await ask('POST', '/runs/2/commands', { command: 'NO_OP' }, cookies.greta).catch(() => ({}));
        if (status === 202) ++got.commands;
        else ++got.limited;
      });
      await Promise.all([pause(50), ...some]);
    }
  };
  const sockets = Array.from({ length: subscriptions }, () =>
    subscription(address, cookies.greta, () => ++got.subscriptions),
  );
  const all = [flood(), ...Array.from({ length: slow_questions }, question)];
  parentPort.once('message', async () => {
    over = true;
    for (const socket of sockets) socket.destroy();
    await Promise.all(all);
    parentPort.postMessage(got);
  });
}

const p99 = (sorted) => sorted[Math.ceil(sorted.length * 0.99) - 1];
async function main() {
  const folder = mkdtempSync(join(tmpdir(), 'aeolis-bench-'));
  try {
    const alone = await serve('alone', folder);
    const plot_alone_ms = p99(await plotTimes(alone));
    const command_alone_ms = await doEdl(alone);
    await alone.end();

    const shared = await serve('shared', folder);
    const { address, cookies } = shared;
    const greedy = new Worker(new URL(import.meta.url), { workerData: { address, cookies } });
    await pause(3000);
    const plot_ms = p99(await plotTimes(shared));
    const command_ms = await doEdl(shared);
    greedy.postMessage('end');
    const [got] = await once(greedy, 'message');
    await shared.end();

    const slower = plot_ms / plot_alone_ms;
    const later_ms = command_ms - command_alone_ms;
    console.log(`beside it: ${JSON.stringify(got)}`);
    console.log(
      `plot, p99 of ${plots}   alone ${plot_alone_ms.toFixed(1)} ms   beside ${plot_ms.toFixed(1)} ms   ` +
        `ratio ${slower.toFixed(2)}   goal ${goals.plot_ratio}, or ${goals.plot_ms} ms`,
    );
    console.log(
      `do edl released      alone ${command_alone_ms.toFixed(1)} ms   beside ${command_ms.toFixed(1)} ms   ` +
        `later ${later_ms.toFixed(1)} ms   goal ${goals.command_ms} ms`,
    );
    return (slower > goals.plot_ratio && plot_ms > goals.plot_ms) || later_ms > goals.command_ms;
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

if (isMainThread) process.exit((await main()) ? 1 : 0);
takeAll(workerData);
