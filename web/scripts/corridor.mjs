// SPDX-License-Identifier: Apache-2.0
// Renews the predicted corridor of the descent picture:
//   node web/scripts/corridor.mjs PREDICTION.csv http://127.0.0.1:8080 >web/src/descent/corridor.ts
// The middle is the published prediction [od137], the rows t_from_EI_s, height_above_landing_radius_km and v_rel_mps of its
// table. The width is how far from it SEEDS landings of the scenario "nominal_auto" came, each with all errors drawn anew; they
// are flown one after the other by the server that is named, which should have an archive for it.
import { readFile } from 'node:fs/promises';

const SEEDS = 12;
const LEAST_M = 1;
const LOWEST_M = 8; // published heights count from the descent stage on its bridle, ours from the ground: the last metres do not compare
const LEAST_MPS = 0.5;
const STRAIGHT_DECADES = 0.012; // a point is left out where the line without it is as near as this

const [, , csv, address] = process.argv;
const table = (await readFile(csv, 'utf8'))
  .split('\n')
  .filter((line) => line !== '' && !line.startsWith('#'))
  .map((line) => line.split(','));
const column = (name) => table[0].indexOf(name);
const [time, height, speed] = ['t_from_EI_s', 'height_above_landing_radius_km', 'v_rel_mps'].map(column);
const published = table
  .slice(1)
  .map((row) => ({ e_s: Number(row[time]), altitude_m: Number(row[height]) * 1000, speed_mps: Number(row[speed]) }))
  .filter((row) => row.e_s >= -15 && row.altitude_m > LOWEST_M);

const decades = ({ altitude_m, speed_mps }) => [
  Math.log10(Math.max(LEAST_MPS, speed_mps)),
  Math.log10(Math.max(LEAST_M, altitude_m)),
];

/** Distance of p from the stretch a … b. */
function distance(p, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const t = Math.max(0, Math.min(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

function simplified(points) {
  if (points.length < 3) return points;
  const [first, last] = [points[0], points[points.length - 1]];
  let worst = 0;
  let at = 0;
  points.forEach((point, index) => {
    const off = distance(decades(point), decades(first), decades(last));
    if (off > worst) [worst, at] = [off, index];
  });
  if (worst <= STRAIGHT_DECADES) return [first, last];
  return [...simplified(points.slice(0, at + 1)), ...simplified(points.slice(at)).slice(1)];
}

const json = async (path, body) => {
  const answer = await fetch(
    `${address}/api/v1${path}`,
    body && { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) },
  );
  if (!answer.ok) throw new Error(`${path}: ${await answer.text()}`);
  return answer.json();
};

async function landing(seed) {
  const { run } = await json('/rehearsals', { scenario: 'nominal_auto', seed: String(seed), pace: 0 });
  for (;;) {
    const state = await json(`/runs/${run}`);
    if (state.state === 'finished') {
      if (state.outcome !== 'touchdown') return undefined;
      break;
    }
    await new Promise((resolve) => setTimeout(resolve, 500));
  }
  const { channels } = await json(`/runs/${run}/channels?names=altitude_m,speed_mps&points=4000`);
  const [altitude, speeds] = ['altitude_m', 'speed_mps'].map((name) => channels.find((each) => each.name === name));
  const { timepoints } = await json(`/runs/${run}/timepoints`);
  const touchdown = timepoints.find((point) => point.name === 'touchdown');
  const end = touchdown.recorded_sclk ?? touchdown.realtime_sclk;
  const points = [];
  let j = 0;
  altitude.sclk.forEach((sclk, i) => {
    while (j < speeds.sclk.length && speeds.sclk[j] < sclk) ++j;
    if (j < speeds.sclk.length && speeds.sclk[j] - sclk < 0.3 && sclk <= end)
      points.push(decades({ altitude_m: altitude.value[i], speed_mps: speeds.value[j] }));
  });
  return points;
}

const landings = [];
for (let seed = 1; seed <= SEEDS; ++seed) {
  const points = await landing(seed);
  if (points) landings.push(points);
  process.stderr.write(`seed ${seed}: ${points?.length ?? 'no landing'}\n`);
}

const rows = simplified(published).map((point) => ({ ...point, half: 0 }));
for (const point of landings.flat()) {
  let least = { off: Infinity, at: 0 };
  for (let i = 1; i < rows.length; ++i) {
    const off = distance(point, decades(rows[i - 1]), decades(rows[i]));
    if (off < least.off) least = { off, at: i };
  }
  // Above the first row nothing was published.
  if (10 ** point[1] > rows[0].altitude_m) continue;
  for (const i of [least.at - 1, least.at]) rows[i].half = Math.max(rows[i].half, least.off);
}
process.stdout.write(
  `// The predicted corridor, by web/scripts/corridor.mjs: the published prediction [od137], and how far from it ${landings.length} landings
// of the scenario "nominal_auto" came, in decades of altitude and speed.
export interface CorridorPoint {
  e_s: number; // from entry
  altitude_m: number; // above the landing radius
  speed_mps: number; // relative to Mars
  half_decades: number;
}

export const CORRIDOR: readonly CorridorPoint[] = [
${rows.map((row) => `  { e_s: ${row.e_s.toFixed(1)}, altitude_m: ${row.altitude_m.toPrecision(4)}, speed_mps: ${row.speed_mps.toPrecision(4)}, half_decades: ${row.half.toFixed(3)} },`).join('\n')}
];
`.replaceAll(/(\d+\.\d+)e\+(\d+)/g, (text) => String(Number(text))),
);
