// SPDX-License-Identifier: Apache-2.0
// Measures anew how wide the predicted corridor of the descent picture is:
//   node web/scripts/corridor.mjs http://127.0.0.1:8080 >web/src/descent/corridor.ts
// The middle of the corridor is the predicted path, from the server. The width is how far from it SEEDS landings of the scenario
// "nominal_auto" came, each with all errors drawn anew; they are flown one after the other by the server that is named, which
// should have an archive for it.

const SEEDS = 12;
const FROM_E_S = -15; // as in web/src/descent/model.ts
const LEAST_M = 1;
const LEAST_MPS = 0.5;
const STRAIGHT_DECADES = 0.012; // a point is left out where the line without it is as near as this

const [, , address] = process.argv;

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
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Altitude and speed of an answer's channels, from one packet each, until `end_sclk`. */
function path({ channels }, end_sclk) {
  const [altitude, speeds] = ['altitude_m', 'speed_mps'].map((name) => channels.find((each) => each.name === name));
  const points = [];
  let j = 0;
  altitude.sclk.forEach((sclk, i) => {
    while (j < speeds.sclk.length && speeds.sclk[j] < sclk) ++j;
    if (j < speeds.sclk.length && speeds.sclk[j] - sclk < 0.3 && sclk <= end_sclk)
      points.push({ sclk, altitude_m: altitude.value[i], speed_mps: speeds.value[j] });
  });
  return points;
}

async function landing(seed) {
  const { run } = await json('/rehearsals', { scenario: 'nominal_auto', seed: String(seed), pace: 0 });
  for (;;) {
    const state = await json(`/runs/${run}`);
    if (state.state === 'finished') {
      if (state.outcome !== 'touchdown') return undefined;
      break;
    }
    await wait(500);
  }
  const { timepoints } = await json(`/runs/${run}/timepoints`);
  const touchdown = timepoints.find((point) => point.name === 'touchdown');
  const flown = await json(`/runs/${run}/channels?names=altitude_m,speed_mps&points=4000`);
  return path(flown, touchdown.recorded_sclk ?? touchdown.realtime_sclk).map(decades);
}

async function predicted() {
  for (;;) {
    const prediction = await json('/runs/latest/prediction?channels=altitude_m,speed_mps');
    if (prediction.state === 'none') throw new Error(prediction.reason);
    if (prediction.state === 'ready') {
      const { entry_sclk } = await json('/runs/latest');
      const { e_s } = prediction.events.find(({ name, timepoint }) => timepoint && name === 'touchdown');
      return path(prediction, entry_sclk + e_s)
        .map((point) => ({ ...point, e_s: point.sclk - entry_sclk }))
        .filter((point) => point.e_s >= FROM_E_S);
    }
    await wait(500);
  }
}

const landings = [];
for (let seed = 1; seed <= SEEDS; ++seed) {
  const points = await landing(seed);
  if (points) landings.push(points);
  process.stderr.write(`seed ${seed}: ${points?.length ?? 'no landing'}\n`);
}

const rows = simplified(await predicted()).map((point) => ({ ...point, half: 0 }));
for (const point of landings.flat()) {
  let least = { off: Infinity, at: 0 };
  for (let i = 1; i < rows.length; ++i) {
    const off = distance(point, decades(rows[i - 1]), decades(rows[i]));
    if (off < least.off) least = { off, at: i };
  }
  // Above the first row nothing is drawn.
  if (10 ** point[1] > rows[0].altitude_m) continue;
  for (const i of [least.at - 1, least.at]) rows[i].half = Math.max(rows[i].half, least.off);
}
process.stdout.write(
  `// SPDX-License-Identifier: Apache-2.0
// Written by web/scripts/corridor.mjs: how far ${landings.length} landings of the scenario "nominal_auto" strayed from its predicted
// path, in decades of altitude and speed, by seconds from entry.
export const SPREAD: readonly { e_s: number; half_decades: number }[] = [
${rows.map((row) => `  { e_s: ${row.e_s.toFixed(1)}, half_decades: ${row.half.toFixed(3)} },`).join('\n')}
];
`,
);
