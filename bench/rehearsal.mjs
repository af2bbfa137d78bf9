// One landing, headless, as fast as it goes: without archive and with everything stored. The goals are the project's:
// 1000 × real time on one core without storage, 300 × with it, both with statistical tones.
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const program = "build/release/aeolis";
const scenario = "simulation/scenarios/nominal_auto.textproto";
const runs = 3; // the best of three: the machine is shared
const folder = mkdtempSync(join(tmpdir(), "aeolis-bench-"));

function land(archive) {
  const args = ["rehearse", "--scenario", scenario, "--seed", "1", "--json"];
  if (archive) args.push("--archive", archive);
  // one core: a pipeline thread that hides on a second one would flatter us
  const text = execFileSync("taskset", ["-c", "0", program, ...args], { encoding: "utf8", maxBuffer: 1 << 28 });
  return JSON.parse(text);
}

let missed = false;
const rows = [];
try {
  for (const [name, stored, goal] of [
    ["landing without archive", false, 1000],
    ["landing, everything archived", true, 300],
  ]) {
    let best;
    let octets = 0;
    for (let i = 0; i < runs; i += 1) {
      const archive = stored ? join(folder, `${i}.db`) : undefined;
      const run = land(archive);
      if (archive) octets = statSync(archive).size;
      if (run.outcome !== "touchdown") throw new Error(`outcome ${run.outcome}, not touchdown`);
      if (!best || run.real_time_factor > best.real_time_factor) best = run;
    }
    missed ||= best.real_time_factor < goal;
    rows.push({
      measured: name,
      "× real time": Math.round(best.real_time_factor),
      goal,
      ratio: (best.real_time_factor / goal).toFixed(2),
      "wall s": best.wall_s.toFixed(2),
      cycles: best.cycles,
      packets: best.packets.recorded,
      "archive MB": stored ? (octets / 1e6).toFixed(1) : "",
    });
  }
} finally {
  rmSync(folder, { recursive: true, force: true });
}
console.table(rows);
process.exitCode = missed ? 1 : 0;
