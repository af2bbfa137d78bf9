// SPDX-License-Identifier: Apache-2.0
// One landing, headless, as fast as it goes: without archive and with everything stored. The goals are the project's:
// 1000 × real time on one core without storage, 300 × with it, both with statistical tones. Then the same landing in
// `aeolis serve`: the largest resident memory, which at 1 × is to stay below 200 MB.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const program = 'build/release/aeolis';
const scenario = 'simulation/scenarios/nominal_auto.textproto';
const runs = 3; // the best of three: the machine is shared
const folder = mkdtempSync(join(tmpdir(), 'aeolis-bench-'));

function land(archive) {
  const args = ['rehearse', '--scenario', scenario, '--seed', '1', '--json'];
  if (archive) args.push('--archive', archive);
  // one core: a pipeline thread that hides on a second one would flatter us
  const text = execFileSync('taskset', ['-c', '0', program, ...args], { encoding: 'utf8', maxBuffer: 1 << 28 });
  return JSON.parse(text);
}

const memory_goal_mb = 200;
const serve_pace = Number(process.env.AEOLIS_SERVE_PACE ?? 100); // at 1 × the queues are shorter, and it takes 25 minutes
const serve_limit_ms = 120_000 + 1_800_000 / serve_pace;

/** The largest resident memory [MB] of `aeolis serve` over a whole landing. */
async function serve(archive) {
  const server = spawn(
    program,
    [
      'serve',
      '--listen',
      '127.0.0.1:0',
      '--archive',
      archive,
      '--scenario',
      scenario,
      '--seed',
      '1',
      '--pace',
      String(serve_pace),
    ],
    { stdio: ['ignore', 'pipe', 'inherit'] },
  );
  try {
    let printed = '';
    for await (const part of server.stdout) {
      printed += part;
      if (/http:\S+\n/.test(printed)) break;
    }
    const address = printed.match(/http:\/\/[^/\s]+/)?.[0];
    if (!address) throw new Error('aeolis serve printed no address');
    const until = Date.now() + serve_limit_ms;
    for (let state = ''; state !== 'finished'; ) {
      if (Date.now() > until) throw new Error(`the landing was not over in ${serve_limit_ms / 1000} s`);
      await new Promise((resolve) => setTimeout(resolve, 250));
      const { runs } = await (await fetch(`${address}/api/v1/runs`)).json();
      state = runs.at(-1)?.state;
    }
    return Number(readFileSync(`/proc/${server.pid}/status`, 'utf8').match(/VmHWM:\s+(\d+)/)[1]) / 1024;
  } finally {
    server.kill('SIGTERM');
  }
}

let missed = false;
const rows = [];
let peak_mb;
try {
  for (const [name, stored, goal] of [
    ['landing without archive', false, 1000],
    ['landing, everything archived', true, 300],
  ]) {
    let best;
    let octets = 0;
    for (let i = 0; i < runs; i += 1) {
      const archive = stored ? join(folder, `${i}.db`) : undefined;
      const run = land(archive);
      if (archive) octets = statSync(archive).size;
      if (run.outcome !== 'touchdown') throw new Error(`outcome ${run.outcome}, not touchdown`);
      if (!best || run.real_time_factor > best.real_time_factor) best = run;
    }
    missed ||= best.real_time_factor < goal;
    rows.push({
      measured: name,
      '× real time': Math.round(best.real_time_factor),
      goal,
      ratio: (best.real_time_factor / goal).toFixed(2),
      'wall s': best.wall_s.toFixed(2),
      cycles: best.cycles,
      packets: best.packets.recorded,
      'archive MB': stored ? (octets / 1e6).toFixed(1) : '',
    });
  }
  peak_mb = await serve(join(folder, 'serve.db'));
} finally {
  rmSync(folder, { recursive: true, force: true });
}
console.table(rows);
console.log(
  `aeolis serve, landing at ${serve_pace} ×: ${peak_mb.toFixed(0)} MB resident at most, goal ${memory_goal_mb} MB, ratio ${(peak_mb / memory_goal_mb).toFixed(2)}`,
);
missed ||= peak_mb > memory_goal_mb;
process.exitCode = missed ? 1 : 0;
