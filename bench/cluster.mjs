// SPDX-License-Identifier: Apache-2.0
// Servers and workers over NATS as programs, on loopback; AEOLIS_NATS_SERVER names the engine's program (./test unpacks
// Debian's). Processor time of the whole origin for a landing's items, published and not; campaigns flown by workers
// and in one process. cluster_bench has rates and lags.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const program = 'build/release/aeolis';
const engine_program = process.env.AEOLIS_NATS_SERVER ?? 'build/nats-server/usr/sbin/nats-server';
const [landings, cases, clients] = [3, 24, Number(process.env.AEOLIS_CLIENTS ?? 100)];
const goals = { publishing_ratio: 1.1, workers_ratio: 0.9, clients_ratio: 1.1 };
const folder = mkdtempSync(join(tmpdir(), 'aeolis-bench-'));
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const started = [];

function start(command, args) {
  const child = spawn(command, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  child.said = '';
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (part) => (child.said += part));
  started.push(child);
  return child;
}
async function end(child, signal = 'SIGTERM') {
  if (child.exitCode !== null || child.signalCode !== null) return;
  child.kill(signal);
  await once(child, 'exit');
}
async function until(condition, what) {
  for (let i = 0; i < 6000; ++i) {
    if (await condition()) return;
    await pause(50);
  }
  throw new Error(`${what}: not within 300 s`);
}

async function startEngine(name) {
  const taken = createServer().listen(0, '127.0.0.1');
  await once(taken, 'listening');
  const { port } = taken.address();
  await new Promise((resolve) => taken.close(resolve));
  const child = start(engine_program, ['-a', '127.0.0.1', '-p', port, '-js', '-sd', join(folder, name)].map(String));
  await until(async () => {
    const socket = connect(port, '127.0.0.1');
    const [event] = await Promise.race([once(socket, 'connect').then(() => ['connect']), once(socket, 'error')]);
    socket.destroy();
    return event === 'connect';
  }, 'the engine');
  return { child, url: `nats://127.0.0.1:${port}` };
}

async function serve(archive, ...more) {
  const child = start(program, ['serve', '--listen', '127.0.0.1:0', '--archive', join(folder, archive), ...more]);
  await until(() => /end with Ctrl-C/.test(child.said) || child.exitCode !== null, 'aeolis serve');
  const address = /http:\/\/127\.0\.0\.1:\d+/.exec(child.said)?.[0];
  if (!address) throw new Error(`aeolis serve: ${child.said}`);
  const metrics = async () => {
    const text = await (await fetch(`${address}/metrics`)).text();
    return (name) => Number(new RegExp(`^${name} (.*)$`, 'm').exec(text)?.[1]);
  };
  const run = async () => (await fetch(`${address}/api/v1/runs/1`)).json();
  return { child, address, metrics, run };
}

/** Microseconds of processor time of an origin for each item of a landing. */
async function landing(name, pace, ...more) {
  const origin = await serve(`${name}.db`, '--scenario', 'nominal_auto', '--pace', String(pace), ...more);
  await until(async () => (await origin.run()).state === 'finished', 'the landing');
  if (more.length > 0)
    await until(async () => (await origin.metrics())('aeolis_publishing_waiting_items') === 0, 'publishing');
  const cpu_s = (await origin.metrics())('aeolis_process_cpu_seconds_total');
  const items = Number((await origin.run()).last_seq);
  await end(origin.child);
  return (cpu_s / items) * 1e6;
}

async function publishing() {
  const alone = [];
  const published = [];
  for (let i = 0; i < landings; ++i) {
    // in turn, so that a slowing processor slows both alike
    alone.push(await landing(`alone-${i}`, 0));
    const engine = await startEngine(`streams-${i}`);
    published.push(await landing(`published-${i}`, 0, '--nats', engine.url));
    await end(engine.child);
  }
  const [one, other] = [Math.min(...alone), Math.min(...published)];
  const ratio = other / one;
  console.log(
    `an item costs an origin ${one.toFixed(1)} us of processor, ${other.toFixed(1)} us published: ` +
      `${ratio.toFixed(2)} x, goal ${goals.publishing_ratio}, ratio ${(ratio / goals.publishing_ratio).toFixed(2)}`,
  );
  return ratio <= goals.publishing_ratio;
}

/** Streams that follow the run, and throw away what comes. */
function follow(address, many) {
  return Array.from({ length: many }, () => {
    const socket = new WebSocket(`${address.replace('http', 'ws')}/api/v1/stream`, 'aeolis.v1.json');
    socket.addEventListener('open', () => socket.send('{"subscribe":{}}'));
    return socket;
  });
}

/** What an origin pays for clients that are served by two followers, and for two of its own. */
async function viewers() {
  const cost = async (name, of_followers) => {
    const engine = await startEngine(`streams-${name}`);
    const origin = await serve(`${name}.db`, '--nats', engine.url, '--scenario', 'nominal_auto', '--pace', '60');
    await until(async () => (await origin.metrics())('aeolis_published_steps_total') > 0, 'the first step');
    const followers = [];
    for (const each of ['one', 'two']) followers.push(await serve(`${name}-${each}.db`, '--follow', engine.url));
    const sockets = of_followers
      ? followers.flatMap(({ address }) => follow(address, clients))
      : follow(origin.address, 2);
    await until(() => sockets.every(({ readyState }) => readyState === WebSocket.OPEN), 'the streams');
    await until(async () => (await origin.run()).state === 'finished', 'the landing');
    const cpu_s = (await origin.metrics())('aeolis_process_cpu_seconds_total');
    for (const socket of sockets) socket.close();
    for (const each of [origin, ...followers]) await end(each.child);
    await end(engine.child);
    return cpu_s;
  };
  const two = await cost('two-clients', false);
  const many = await cost('many-clients', true);
  const ratio = many / two;
  console.log(
    `a landing with two followers costs the origin ${two.toFixed(1)} s of processor with 2 clients of its own, ` +
      `${many.toFixed(1)} s with ${clients} at each follower: ${ratio.toFixed(2)} x, goal ${goals.clients_ratio}, ` +
      `ratio ${(ratio / goals.clients_ratio).toFixed(2)}`,
  );
  return ratio <= goals.clients_ratio;
}

async function campaigns() {
  const call = ['campaign', '--scenario', 'campaign', '--cases', String(cases)];
  const fly = (...more) => {
    const text = execFileSync(program, [...call, ...more], { encoding: 'utf8' });
    return Number(/([\d.]+) cases\/s/.exec(text)[1]);
  };
  const alone = fly('--jobs', '3', '--results', join(folder, 'alone.db'));
  const engine = await startEngine('streams-cases');
  const workers = [1, 2, 3].map((n) =>
    start(program, ['worker', '--nats', engine.url, '--jobs', '1', '--name', `w${n}`]),
  );
  const shared = fly('--nats', engine.url, '--results', join(folder, 'shared.db'));
  for (const worker of workers) await end(worker, 'SIGINT');
  await end(engine.child);
  const ratio = shared / alone;
  console.log(
    `${cases} cases: ${alone.toFixed(2)} cases/s by --jobs 3, ${shared.toFixed(2)} by three workers: ` +
      `${ratio.toFixed(2)} x, goal ${goals.workers_ratio}, ratio ${(ratio / goals.workers_ratio).toFixed(2)}`,
  );
  return ratio >= goals.workers_ratio;
}

let met = true;
try {
  if (!existsSync(engine_program))
    throw new Error(`${engine_program}: there is no nats-server; AEOLIS_NATS_SERVER names one`);
  for (const part of [publishing, viewers, campaigns]) met = (await part()) && met;
} finally {
  for (const child of started) await end(child, 'SIGKILL');
  rmSync(folder, { recursive: true, force: true });
}
process.exit(met ? 0 : 1);
