// SPDX-License-Identifier: Apache-2.0
// Compares pictures of panels with stored ones, both as averages of tiles, so that the edge of a letter does not count
// but a moved panel or lost colours do. A trace is one pixel thin and would vanish in a tile, so the columns of pixels
// with a trace's colour are counted for each canvas. A picture that differs is kept whole in build/test/pictures.
// AEOLIS_RENEW_PICTURES=1 stores new pictures, and whole ones there: look at those before you commit.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { root } from './support.mjs';

/** The size of a tile, and how far its mean may lie from the stored one: of 255, in any colour. */
const FINE = { tile_px: 8, differs: 28 };
/** For many pictures of whole windows: a sixteenth of the octets; a panel that moved or is empty shows all the same. */
export const COARSE = { tile_px: 32, differs: 10 };
// a colour of at least this share of tiles is background: the page, a panel, edges, table lines
const GROUND_SHARE = 0.004;
const GROUND_NEAR = 5; // of 255
// of the tiles with content in either picture, so that a large background hides no missing content
const TOLERANCE = 0.12;

const TRACES = ['by-uhf', 'by-tone', 'by-recording', 'mode-rehearsal'];
const COLUMNS = 0.1; // relative deviation from the stored count
const COLUMNS_LEAST = 8; // chosen: variation at the end of a letter

const folder = path.join(root, 'tests/browser/pictures');
const wholeFolder = path.join(root, 'build/test/pictures');

const tracesFile = path.join(folder, 'traces.json');
const storedTraces = () => (existsSync(tracesFile) ? JSON.parse(readFileSync(tracesFile, 'utf8')) : {});

function differentTraces(name, now, stored) {
  if (now.length !== stored.length) return [`${name}: has ${now.length} canvases, ${stored.length} are stored`];
  return now.flatMap((counts, canvas) =>
    TRACES.flatMap((trace, i) =>
      Math.abs(counts[i] - stored[canvas][i]) <= Math.max(COLUMNS_LEAST, COLUMNS * stored[canvas][i])
        ? []
        : [`${name}: canvas ${canvas} has ${trace} in ${counts[i]} columns of pixels, ${stored[canvas][i]} are stored`],
    ),
  );
}

function keepWhole(name, screenshot) {
  const whole = path.join(wholeFolder, `${name}.png`);
  mkdirSync(path.dirname(whole), { recursive: true });
  writeFileSync(whole, screenshot);
}

/** Compares with the stored picture; undefined, or a line that states the difference. */
export async function comparePicture(page, name, screenshot, { tile_px, differs: limit } = FINE) {
  const file = path.join(folder, `${name}.png`);
  const traces = await page.evaluate(columnsOfTraces, TRACES);
  if (process.env.AEOLIS_RENEW_PICTURES) {
    mkdirSync(path.dirname(file), { recursive: true });
    keepWhole(name, screenshot);
    writeFileSync(
      file,
      Buffer.from((await page.evaluate(inPage, { png: screenshot.toString('base64'), tile: tile_px })).png, 'base64'),
    );
    const { [name]: _before, ...others } = storedTraces();
    const all = traces.length > 0 ? { ...others, [name]: traces } : others;
    const lines = Object.entries(all)
      .sort(([one], [other]) => (one < other ? -1 : 1))
      .map(([each, counts]) => `  ${JSON.stringify(each)}: ${JSON.stringify(counts)}`);
    writeFileSync(tracesFile, `{\n${lines.join(',\n')}\n}\n`);
    return [];
  }
  const lost = differentTraces(name, traces, storedTraces()[name] ?? []);
  const { width, height, differs } = await page.evaluate(inPage, {
    png: screenshot.toString('base64'),
    stored: readFileSync(file).toString('base64'),
    tile: tile_px,
    limit,
    share: GROUND_SHARE,
    near: GROUND_NEAR,
  });
  if (differs === undefined) return [...lost, `${name}: is ${width} x ${height} tiles, the stored picture is not`];
  return differs <= TOLERANCE
    ? lost
    : [
        ...lost,
        `${name}: ${(differs * 100).toFixed(1)} % of its tiles with content differ from ${path.relative(root, file)}`,
      ];
}

const SETTLES_MS = 60_000; // only a difference waits this long
// A picture that is stored has nothing to be compared with: it is taken once nothing has moved for so long.
const STILL_MS = 4000;
const MOVES_MS = 40_000; // what still moves then moves by itself

async function stands(what) {
  const end = Date.now() + MOVES_MS;
  let [last, since] = [undefined, Date.now()];
  while (Date.now() < end && Date.now() - since < STILL_MS) {
    const now = await what.screenshot({ animations: 'disabled' });
    if (last === undefined || !now.equals(last)) since = Date.now();
    last = now;
    await new Promise((resolve) => setTimeout(resolve, 250));
  }
}

/**
 * Waits until `what` matches the stored picture; undefined, or the remaining difference. On a busy machine the page's
 * successive requests take seconds.
 */
export async function comesToLook(page, name, what, fineness = FINE) {
  if (process.env.AEOLIS_RENEW_PICTURES) await stands(what);
  const end = Date.now() + SETTLES_MS;
  for (;;) {
    const screenshot = await what.screenshot({ animations: 'disabled' });
    const found = await comparePicture(page, name, screenshot, fineness);
    if (found.length === 0) return found;
    if (Date.now() > end) {
      keepWhole(name, screenshot);
      return found;
    }
    await page.waitForTimeout(250);
  }
}

/**
 * Runs in the page: for each canvas, the number of columns that contain each of these colours. A canvas has no
 * background of its own, so a thin line is pale, not of another colour.
 */
function columnsOfTraces(tokens) {
  const style = getComputedStyle(document.documentElement);
  const colours = tokens
    .map((token) => parseInt(style.getPropertyValue(`--${token}`).trim().slice(1), 16))
    .map((rgb) => [rgb >> 16, (rgb >> 8) & 255, rgb & 255]);
  return [...document.querySelectorAll('canvas')]
    .filter((canvas) => canvas.checkVisibility() && canvas.width > 0 && canvas.height > 0)
    .map((canvas) => {
      const { data, width, height } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      const seen = colours.map(() => new Set());
      for (let at = 0, i = 0; i < width * height; ++i, at += 4) {
        if (data[at + 3] < 60) continue;
        colours.forEach(([r, g, b], colour) => {
          if (Math.abs(data[at] - r) + Math.abs(data[at + 1] - g) + Math.abs(data[at + 2] - b) < 24)
            seen[colour].add(i % width);
        });
      }
      return seen.map((columns) => columns.size);
    });
}

/** Runs in the page: the screenshot with one pixel per tile, and its difference from the stored one. */
async function inPage({ png, stored, tile, limit, share, near }) {
  const pixels = async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height);
  };
  const whole = await pixels(png);
  const [width, height] = [Math.floor(whole.width / tile), Math.floor(whole.height / tile)];
  const means = new Uint8ClampedArray(width * height * 4).fill(255);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      for (let colour = 0; colour < 3; ++colour) {
        let sum = 0;
        for (let i = 0; i < tile * tile; ++i)
          sum += whole.data[((y * tile + Math.floor(i / tile)) * whole.width + x * tile + (i % tile)) * 4 + colour];
        means[(y * width + x) * 4 + colour] = sum / (tile * tile);
      }
    }
  }
  if (stored === undefined) {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [width, height];
    canvas.getContext('2d').putImageData(new ImageData(means, width, height), 0, 0);
    return { width, height, png: canvas.toDataURL('image/png').split(',')[1] };
  }
  const other = await pixels(stored);
  if (other.width !== width || other.height !== height) return { width, height };
  const count = new Map();
  const colourAt = (data, i) => (data[i] << 16) | (data[i + 1] << 8) | data[i + 2];
  for (let i = 0; i < means.length; i += 4)
    count.set(colourAt(other.data, i), (count.get(colourAt(other.data, i)) ?? 0) + 1);
  const grounds = [...count]
    .filter(([, tiles]) => tiles > share * width * height)
    .map(([rgb]) => [rgb >> 16, (rgb >> 8) & 255, rgb & 255]);
  const isGround = (data, i) =>
    grounds.some((ground) => ground.every((part, colour) => Math.abs(data[i + colour] - part) <= near));
  let [differs, content] = [0, 0];
  for (let i = 0; i < means.length; i += 4) {
    const bare = [isGround(means, i), isGround(other.data, i)];
    const apart = Math.max(...[0, 1, 2].map((colour) => Math.abs(means[i + colour] - other.data[i + colour])));
    if (bare[0] && bare[1] && apart <= limit) continue;
    ++content;
    if (bare[0] !== bare[1] || apart > limit) ++differs;
  }
  return { width, height, differs: differs / Math.max(1, content) };
}
