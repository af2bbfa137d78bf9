// SPDX-License-Identifier: Apache-2.0
// Pictures of panels against stored ones: both as means of tiles, so that the edge of a letter does not count and a panel that moved,
// lost its colours does. A trace is a pixel thin and would be lost in a tile: of each canvas is counted besides in how many columns of
// pixels something of a trace's colour stands. AEOLIS_RENEW_PICTURES=1 stores what is seen: look at it before you commit it.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { root } from './support.mjs';

const TILE_PX = 8;
const DIFFERS = 28; // of 255, in any colour
const GROUND_SHARE = 0.004; // a colour of so many tiles is ground: the page, a panel, their edges, the lines of a table
const GROUND_NEAR = 5; // of 255
const TOLERANCE = 0.12; // of the tiles that have content in either picture, so that much ground hides nothing that is missing

const TRACES = ['by-uhf', 'by-tone', 'by-recording', 'mode-rehearsal'];
const COLUMNS = 0.1; // of what is stored, more or fewer
const COLUMNS_LEAST = 8; // ours: where a letter ends

const folder = path.join(root, 'tests/browser/pictures');

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

/** Nothing, or a line that says how different the picture is. */
export async function comparePicture(page, name, screenshot) {
  const file = path.join(folder, `${name}.png`);
  const traces = await page.evaluate(columnsOfTraces, TRACES);
  if (process.env.AEOLIS_RENEW_PICTURES) {
    mkdirSync(folder, { recursive: true });
    writeFileSync(
      file,
      Buffer.from((await page.evaluate(inPage, { png: screenshot.toString('base64'), tile: TILE_PX })).png, 'base64'),
    );
    if (traces.length > 0)
      writeFileSync(
        tracesFile,
        `{\n${Object.entries({ ...storedTraces(), [name]: traces })
          .sort(([one], [other]) => (one < other ? -1 : 1))
          .map(([each, counts]) => `  ${JSON.stringify(each)}: ${JSON.stringify(counts)}`)
          .join(',\n')}\n}\n`,
      );
    return [];
  }
  const lost = differentTraces(name, traces, storedTraces()[name] ?? []);
  const { width, height, differs } = await page.evaluate(inPage, {
    png: screenshot.toString('base64'),
    stored: readFileSync(file).toString('base64'),
    tile: TILE_PX,
    limit: DIFFERS,
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

const SETTLES_MS = 60_000; // only what differs waits so long
const RENEWED_AFTER_MS = 1500; // nothing is there to compare with: longer than history and a draw after it take

/** Nothing once `what` looks as stored; else how it differs still. What a page asks for one after the other has come when it has come: on a busy machine that takes seconds. */
export async function comesToLook(page, name, what) {
  if (process.env.AEOLIS_RENEW_PICTURES) await page.waitForTimeout(RENEWED_AFTER_MS);
  const end = Date.now() + SETTLES_MS;
  for (;;) {
    const found = await comparePicture(page, name, await what.screenshot({ animations: 'disabled' }));
    if (found.length === 0 || Date.now() > end) return found;
    await page.waitForTimeout(250);
  }
}

/** Runs in the page: of each canvas, in how many columns each of these colours stands. A canvas has no ground of its own: what is thin is pale, not of another colour. */
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

/** Runs in the page: the screenshot as one pixel a tile, and how much of it is not as stored. */
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
