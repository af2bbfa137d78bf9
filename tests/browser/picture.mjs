// Pictures of panels against stored ones: both as means of tiles, so that the edge of a letter does not count and a panel that moved,
// lost its trace or changed its colours does. AEOLIS_RENEW_PICTURES=1 stores what is seen: look at it before you commit it.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { root } from './support.mjs';

const TILE_PX = 8;
const DIFFERS = 28; // of 255, in any colour
const TOLERANCE = 0.03; // of all tiles

const folder = path.join(root, 'tests/browser/pictures');

/** Nothing, or a line that says how different the picture is. */
export async function comparePicture(page, name, screenshot) {
    const file = path.join(folder, `${name}.png`);
    if (process.env.AEOLIS_RENEW_PICTURES) {
        mkdirSync(folder, { recursive: true });
        writeFileSync(file, Buffer.from((await page.evaluate(inPage, { png: screenshot.toString('base64'), tile: TILE_PX })).png, 'base64'));
        return [];
    }
    const { width, height, differs } = await page.evaluate(inPage, {
        png: screenshot.toString('base64'), stored: readFileSync(file).toString('base64'), tile: TILE_PX, limit: DIFFERS,
    });
    if (differs === undefined) return [`${name}: is ${width} x ${height} tiles, the stored picture is not`];
    return differs <= TOLERANCE ? [] : [`${name}: ${(differs * 100).toFixed(1)} % of its tiles differ from ${path.relative(root, file)}`];
}

/** Runs in the page: the screenshot as one pixel a tile, and how much of it is not as stored. */
async function inPage({ png, stored, tile, limit }) {
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
                for (let i = 0; i < tile * tile; ++i) sum += whole.data[((y * tile + Math.floor(i / tile)) * whole.width + x * tile + (i % tile)) * 4 + colour];
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
    let differs = 0;
    for (let i = 0; i < means.length; i += 4) if ([0, 1, 2].some((colour) => Math.abs(means[i + colour] - other.data[i + colour]) > limit)) ++differs;
    return { width, height, differs: differs / (width * height) };
}
