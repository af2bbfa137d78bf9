// SPDX-License-Identifier: Apache-2.0
// The events of scenario od137 beside the published ones, as the table of docs/validation.md:   node bench/od137_table.mjs
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';

const root = new URL('..', import.meta.url).pathname;
const rows = readFileSync(`${root}tests/simulation/od137_events.csv`, 'utf8')
  .split('\n')
  .filter((line) => line !== '' && !line.startsWith('#'))
  .slice(1)
  .map((line) => line.split(','));
const landing = JSON.parse(
  execFileSync(`${root}build/release/aeolis`, ['rehearse', '--scenario', 'od137', '--json'], { encoding: 'utf8' }),
);
const flown = Object.fromEntries(landing.events.map((event) => [event.name, event]));

const signed = (value, digits) => (value < 0 ? '−' : '+') + Math.abs(value).toFixed(digits);
const mark = (inside) => (inside ? '' : ' ✗');
console.log(
  '| event | published E+s | flown | difference | published height m | flown | difference | published m/s | flown |',
);
console.log('|---|---:|---:|---:|---:|---:|---:|---:|---:|');
for (const [name, e_s, height_m, speed_mps, within_s, speed_within] of rows) {
  const event = flown[name];
  const late_s = event.e_s - e_s;
  const higher_m = event.altitude_m - height_m;
  const faster_mps = event.speed_mps - speed_mps;
  console.log(
    `| ${name} | ${e_s} | ${event.e_s.toFixed(2)} | ${signed(late_s, 2)}${mark(Math.abs(late_s) <= within_s)} ` +
      `| ${height_m} | ${event.altitude_m.toFixed(0)} | ${signed(higher_m, 0)}${mark(Math.abs(higher_m) <= Math.max(0.03 * height_m, 10))} ` +
      `| ${speed_mps} | ${event.speed_mps.toFixed(1)}${mark(Math.abs(faster_mps) <= Math.max(speed_within * speed_mps, 1))} |`,
  );
}
const { vertical_mps, horizontal_mps, miss_m } = landing.touchdown;
console.log(
  `\nPeak deceleration ${landing.peak_deceleration_mps2.toFixed(2)} m/s² (published 121.10). ` +
    `Touchdown ${vertical_mps.toFixed(2)} m/s down, ${horizontal_mps.toFixed(2)} m/s across, ${miss_m.toFixed(0)} m from the target.`,
);
