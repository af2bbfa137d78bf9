// SPDX-License-Identifier: Apache-2.0
// Landings rebuilt from their recordings beside the truth, as the table and the picture of docs/reconstruction.md:
//   node bench/reconstruction_figures.mjs [CASES] [PICTURE]
// Case 0 is nominal_auto, the others are dispersed alike. The picture needs gnuplot (Debian's gnuplot-nox).
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const root = new URL('..', import.meta.url).pathname;
const cases = Number(process.argv[2] ?? 10);
const picture = process.argv[3];
const folder = mkdtempSync(join(tmpdir(), 'aeolis-reconstruction-'));
const seed = 1;
const radius_m = 3391148;
const entry_sclk = 397501715;
const degree = Math.PI / 180;

const quiet = { encoding: 'utf8', maxBuffer: 1 << 28 };
const aeolis = (...words) => execFileSync(`${root}build/release/aeolis`, words, quiet);
const rows_of = (file) => {
  const [head, ...lines] = readFileSync(file, 'utf8').trimEnd().split('\n');
  const names = head.split(',');
  return lines.map((line) => {
    const cells = line.split(',');
    return Object.fromEntries(names.map((name, i) => [name, cells[i] === '' ? Number.NaN : Number(cells[i])]));
  });
};
const place = (latitude_deg, longitude_deg, r) => {
  const [a, o] = [latitude_deg * degree, longitude_deg * degree];
  return [r * Math.cos(a) * Math.cos(o), r * Math.cos(a) * Math.sin(o), r * Math.sin(a)];
};

/** Errors of each point of a rebuilt path, and its own standard deviations. */
function compared(number) {
  const in_folder = (name) => join(folder, `${number}-${name}`);
  const landing = JSON.parse(
    aeolis(
      'rehearse',
      '--scenario',
      'nominal_auto',
      '--seed',
      `${seed}`,
      '--case',
      `${number}`,
      '--json',
      '--archive',
      in_folder('a.db'),
      '--truth',
      in_folder('truth.csv'),
    ),
  );
  if (landing.outcome !== 'touchdown') throw new Error(`case ${number}: ${landing.outcome}`);
  const { latitude_deg, longitude_deg } = landing.touchdown;
  aeolis(
    'reconstruct',
    '--archive',
    in_folder('a.db'),
    '--run',
    '1',
    '--out',
    in_folder('path.csv'),
    '--site',
    `${latitude_deg}`,
    `${longitude_deg}`,
    `${radius_m}`,
  );
  const truth = rows_of(in_folder('truth.csv'));
  let at = 1;
  const points = [];
  for (const point of rows_of(in_folder('path.csv'))) {
    const e_s = point.sclk - entry_sclk;
    while (at + 1 < truth.length && truth[at].e_s < e_s) ++at;
    const [low, high] = [truth[at - 1], truth[at]];
    if (e_s < low.e_s || e_s > high.e_s) continue;
    const part = (e_s - low.e_s) / (high.e_s - low.e_s);
    const between = (name) => low[name] + part * (high[name] - low[name]);
    const p = place(between('latitude_deg'), between('longitude_deg'), radius_m + between('altitude_m'));
    const off_m = Math.hypot(point.p_x_m - p[0], point.p_y_m - p[1], point.p_z_m - p[2]);
    // In the middle of the step that ends here.
    const middle = (e_s - 0.0625 - low.e_s) / (high.e_s - low.e_s);
    const density = low.density_kgm3 * (high.density_kgm3 / low.density_kgm3) ** middle;
    points.push({
      e_s,
      off_m,
      sigma_p_m: point.sigma_p_m,
      height_m: point.altitude_m - between('altitude_m'),
      sigma_height_m: point.sigma_height_m,
      speed_mps: point.speed_mps - between('speed_mps'),
      sigma_v_mps: point.sigma_v_mps / Math.sqrt(3),
      density: point.density_kgm3 / density - 1,
      sigma_density: point.sigma_density_kgm3 / point.density_kgm3,
      altitude_km: point.altitude_m / 1000,
    });
  }
  return points;
}

const share = (points, error, sigma) => {
  const known = points.filter((point) => !Number.isNaN(point[error]));
  const within = known.filter((point) => Math.abs(point[error]) <= 3 * point[sigma]).length;
  const largest = known.reduce((most, point) => Math.max(most, Math.abs(point[error])), 0);
  return { percent: (100 * within) / known.length, largest };
};

const printed = (cells) => console.log(`| ${cells.join(' | ')} |`);
const position_head = ['position, % within 3σ', 'at most, m'];
printed([
  'case',
  ...position_head,
  'height',
  'at most, m',
  'speed',
  'at most, m/s',
  'density',
  'at most below 60 km, %',
]);
console.log('|---:|---:|---:|---:|---:|---:|---:|---:|---:|');
try {
  for (let number = 0; number <= cases; ++number) {
    const points = compared(number);
    const position = share(points, 'off_m', 'sigma_p_m');
    const height = share(points, 'height_m', 'sigma_height_m');
    const speed = share(points, 'speed_mps', 'sigma_v_mps');
    const density = share(points, 'density', 'sigma_density');
    const low = share(
      points.filter((point) => point.altitude_km < 60),
      'density',
      'sigma_density',
    );
    const cells = ({ percent, largest }, digits) => [percent.toFixed(1), largest.toFixed(digits)];
    printed([
      number,
      ...cells(position, 0),
      ...cells(height, 0),
      ...cells(speed, 2),
      density.percent.toFixed(1),
      (100 * low.largest).toFixed(1),
    ]);
    if (number > 0 || !picture) continue;
    const data = join(folder, 'errors.csv');
    const row_of = (p) => [
      ...[p.e_s, p.off_m, 3 * p.sigma_p_m, p.height_m, 3 * p.sigma_height_m],
      ...[p.speed_mps, 3 * p.sigma_v_mps, 100 * p.density, 300 * p.sigma_density, p.altitude_km],
    ];
    const text_of = (numbers) => numbers.map((n) => (Number.isNaN(n) ? 'nan' : n)).join(' ');
    writeFileSync(data, points.map((point) => text_of(row_of(point))).join('\n'));
    const plot = (x, error, sigma) =>
      `plot "${data}" using ${x}:${sigma} with lines ls 1 title "3 sigma", \\\n` +
      `  "${data}" using ${x}:(-$${sigma}) with lines ls 1 notitle, \\\n` +
      `  "${data}" using ${x}:${error} with lines ls 2 title "rebuilt less true"\n`;
    const panel = (title, unit, error, sigma, range) =>
      `set title "${title}"; set ylabel "${unit}"; set yrange [${range}]\n${plot(1, error, sigma)}`;
    execFileSync('gnuplot', {
      input: `
set terminal pngcairo noenhanced size 1500,1100 font "DejaVu Sans,11"
set output "${picture}"
set key top right
set grid lc rgb "#dddddd"
set style line 1 lc rgb "#999999" lw 2
set style line 2 lc rgb "#c0392b" lw 1.5
set xlabel "E+ s"; set xrange [-30:440]
set multiplot layout 2,2 title "Scenario nominal_auto, seed 1: rebuilt from its recording and the landing site"
${panel('Position, three axes together', 'm', 2, 3, '0:600')}
${panel('Height', 'm', 4, 5, '-400:400')}
${panel('Speed', 'm/s', 6, 7, '-2.5:2.5')}
set xlabel "height km"; set xrange [10:95]
set title "Density by drag"; set ylabel "%"; set yrange [-40:40]
${plot(10, 8, 9)}
`,
    });
  }
} finally {
  rmSync(folder, { recursive: true });
}
