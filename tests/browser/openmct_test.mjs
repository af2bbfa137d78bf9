// The plugin in the real Open MCT: a run's channels in its tree, their history, and live values. Skipped where `npm ci` was not run in web/openmct.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { serve as serveOpenMct } from '../../web/openmct/serve.mjs';
import { browser, open, root, serve, temporaryFolder, waitFor } from './support.mjs';

const installed = existsSync(path.join(root, 'web/openmct/node_modules/openmct/dist/openmct.js'));

test('Open MCT shows runs and channels of a server, with history and live values', {
    timeout: 90_000, skip: installed ? false : 'openmct is not installed: npm ci in web/openmct',
}, async () => {
    const { folder, remove } = await temporaryFolder();
    const chrome = await browser();
    const server = await serve({ archive: path.join(folder, 'openmct.db'), more: ['--scenario', 'nominal_auto', '--pace', '100'] });
    const pages = await serveOpenMct(server.address);
    try {
        await waitFor(async () => (await server.get('/runs')).runs[0]?.clocks?.e_s, (e_s) => e_s > -60, 60_000); // the rest of the landing is still to come
        const { page } = await open(chrome, `http://127.0.0.1:${pages.address().port}/`);
        await page.waitForFunction(() => window.openmct !== undefined);

        const tree = await page.evaluate(async () => {
            const names = async (key) => {
                const found = await openmct.composition.get(await openmct.objects.get({ namespace: 'aeolis', key })).load();
                return found.map(({ name, type }) => `${name} (${type})`);
            };
            return { runs: await names('runs'), channels: await names('1') };
        });
        assert.deepEqual(tree.runs, ['Run 1: nominal_auto (folder)']);
        assert.ok(tree.channels.includes('altitude_m (aeolis.channel)'), tree.channels.slice(0, 5).join());

        const live = await page.evaluate(async () => {
            const altitude = await openmct.objects.get({ namespace: 'aeolis', key: '1~altitude_m' });
            const taken = [];
            await new Promise((resolve) => {
                const stop = openmct.telemetry.subscribe(altitude, (datum) => {
                    taken.push(datum);
                    if (taken.length < 5) return;
                    stop();
                    resolve();
                });
            });
            return taken.map(({ e, value }) => ({ e, value }));
        });
        await waitFor(async () => (await server.get('/runs')).runs[0].state, (state) => state === 'finished', 60_000);

        const history = await page.evaluate(async () => {
            const altitude = await openmct.objects.get({ namespace: 'aeolis', key: '1~altitude_m' });
            return openmct.telemetry.request(altitude, { start: 0, end: 60_000, size: 500 });
        });
        const { entry_sclk: entry } = (await server.get('/runs')).runs[0];
        const [series] = (await server.get(`/runs/1/channels?names=altitude_m&from=${entry}&to=${entry + 60}&points=500`)).channels;
        assert.deepEqual(history.map(({ e, value }) => [e / 1000 + entry, value]), series.sclk.map((sclk, i) => [sclk, series.value[i]]));
        assert.ok(history.length > 50, `${history.length} points`);
        const all = (await server.get('/runs/1/channels?names=altitude_m')).channels[0];
        for (const { e, value } of live) {
            const at = all.sclk.findIndex((sclk) => Math.abs(sclk - entry - e / 1000) < 1e-6);
            assert.equal(all.value[at], value, `live ${value} at ${e} ms is not what is recorded`);
        }

        // What a person sees: the run's channel as a plot.
        await page.goto('about:blank');
        await page.goto(`http://127.0.0.1:${pages.address().port}/#/browse/aeolis:runs/aeolis:1/aeolis:1~altitude_m`);
        await page.waitForSelector('.gl-plot-chart-area canvas');
        await waitFor(() => page.locator('.gl-plot').first().innerText(), /GNC-\d+[^]*\b[1-9]\d{4,}\b[^]*E\+\d/); // its axes are those of the values
        await page.close();
    } finally {
        pages.closeAllConnections();
        pages.close();
        await server.stop();
        await chrome.close();
        await remove();
    }
});
