// SPDX-License-Identifier: Apache-2.0
// The plugin in the real Open MCT: a run's channels in its tree, their history, and live values; skipped unless `npm
// ci` was run in web/openmct. Also its server: read-only, for its own page alone.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { request } from 'node:http';
import path from 'node:path';
import { test } from 'node:test';
import { serve as serveOpenMct } from '../../../web/openmct/serve.mjs';
import { browser, open, root, serve, temporaryFolder, untilRun, waitFor } from '../support.mjs';

const installed = existsSync(path.join(root, 'web/openmct/node_modules/openmct/dist/openmct.js'));

test('Open MCT shows runs and channels of a server, with history and live values', {
  skip: installed ? false : 'openmct is not installed: npm ci in web/openmct',
}, async () => {
  const { folder, remove } = await temporaryFolder();
  const chrome = await browser();
  const server = await serve({
    archive: path.join(folder, 'openmct.db'),
    more: ['--scenario', 'nominal_auto', '--pace', '50'],
  });
  const pages = await serveOpenMct(server.address);
  try {
    await waitFor(
      async () => (await server.get('/runs')).runs[0]?.clocks?.e_s,
      (e_s) => e_s > -1200,
    ); // the landing is still ahead, however slow this machine is
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
    await untilRun(server, ({ state }) => state === 'finished');

    const history = await page.evaluate(async () => {
      const altitude = await openmct.objects.get({ namespace: 'aeolis', key: '1~altitude_m' });
      return openmct.telemetry.request(altitude, { start: 0, end: 60_000, size: 500 });
    });
    const { entry_sclk: entry } = (await server.get('/runs')).runs[0];
    const [series] = (await server.get(`/runs/1/channels?names=altitude_m&from=${entry}&to=${entry + 60}&points=500`))
      .channels;
    assert.deepEqual(
      history.map(({ e, value }) => [e / 1000 + entry, value]),
      series.sclk.map((sclk, i) => [sclk, series.value[i]]),
    );
    assert.ok(history.length > 50, `${history.length} points`);
    const all = (await server.get('/runs/1/channels?names=altitude_m')).channels[0];
    for (const { e, value } of live) {
      const at = all.sclk.findIndex((sclk) => Math.abs(sclk - entry - e / 1000) < 1e-6);
      assert.equal(all.value[at], value, `live ${value} at ${e} ms is not what is recorded`);
    }

    // A user's view: the run's channel as a plot.
    await page.goto('about:blank');
    await page.goto(`http://127.0.0.1:${pages.address().port}/#/browse/aeolis:runs/aeolis:1/aeolis:1~altitude_m`);
    await page.waitForSelector('.gl-plot-chart-area canvas');
    // its axes fit the values
    await waitFor(() => page.locator('.gl-plot').first().innerText(), /GNC-\d+[^]*\b[1-9]\d{4,}\b[^]*E\+\d/);
    await page.close();
  } finally {
    pages.closeAllConnections();
    pages.close();
    await server.stop();
    await chrome.close();
    await remove();
  }
});

/**
 * Sends a request as a page or a program would, word for word. Returns the status, and for an upgrade whether it got a
 * socket.
 */
const ask = (port, path, { method = 'GET', headers = {} } = {}) =>
  new Promise((resolve, reject) => {
    const asked = request(
      { hostname: '127.0.0.1', port, path, method, headers: { host: `127.0.0.1:${port}`, ...headers } },
      (answer) => {
        answer.destroy();
        resolve(answer.statusCode);
      },
    );
    asked
      .on('upgrade', (_, socket) => {
        socket.destroy();
        resolve('a socket');
      })
      .on('error', reject)
      .end();
  });

test('what serves Open MCT answers its own page alone, gives no socket for commands, and no address ends it', async () => {
  const { folder, remove } = await temporaryFolder();
  const chrome = await browser();
  const server = await serve({
    archive: path.join(folder, 'openmct_reads.db'),
    more: ['--scenario', 'nominal_auto', '--pace', '0'],
  });
  const pages = await serveOpenMct(server.address);
  const { port } = pages.address();
  try {
    await untilRun(server, ({ state }) => state === 'finished');
    const own = { origin: `http://127.0.0.1:${port}` };
    const live = '/live?run=1&after=0&channels=1,2';
    for (const address of ['/', '/plugin.js', '/api/v1/runs']) {
      assert.equal(await ask(port, address, { headers: own }), 200, address);
      for (const origin of ['http://elsewhere.example', `http://127.0.0.1:${port + 1}`, server.address, 'null'])
        assert.equal(await ask(port, address, { headers: { origin } }), 403, `${address} asked by ${origin}`);
      for (const host of ['elsewhere.example', `elsewhere.example:${port}`, '127.0.0.1'])
        assert.equal(await ask(port, address, { headers: { host } }), 403, `${address} of ${host}`);
    }
    for (const method of ['POST', 'PUT', 'DELETE', 'PATCH', 'OPTIONS'])
      assert.equal(await ask(port, '/api/v1/commands', { method, headers: own }), 405, method);
    const upgrade = {
      connection: 'Upgrade',
      upgrade: 'websocket',
      'sec-websocket-version': '13',
      'sec-websocket-key': 'AAAAAAAAAAAAAAAAAAAAAA==',
      'sec-websocket-protocol': 'aeolis.v1.json',
    };
    assert.equal(await ask(port, live, { headers: { ...own, ...upgrade } }), 'a socket');
    for (const headers of [{ origin: 'http://elsewhere.example' }, { host: 'elsewhere.example' }])
      assert.equal(await ask(port, live, { headers: { ...upgrade, ...headers } }), 403);
    for (const address of ['/api/v1/stream', '/', '//', '/live/'])
      assert.notEqual(await ask(port, address, { headers: { ...own, ...upgrade } }), 'a socket', address);
    for (const more of ['', 'run=1&after=0', 'run=1&after=0&channels=1}}', 'run=1"&after=0&channels=1'])
      assert.equal(await ask(port, `/live?${more}`, { headers: { ...own, ...upgrade } }), 400, more);
    for (const address of [
      '/openmct/%',
      '/openmct/%00',
      '/openmct/',
      '/openmct/..%2f..%2f..%2fserve.mjs',
      '//',
      '/%',
      '/api/v1/%',
      '//%',
      '/api/v1/nothing',
    ]) {
      const status = await ask(port, address);
      assert.ok(status >= 400 && status < 500, `${address}: ${status}`);
    }

    // Commands from its own page are ignored: there is no answer and no entry in the history, while its subscription
    // works.
    const { page } = await open(chrome, `http://127.0.0.1:${port}/plugin.js`);
    const heard = await page.evaluate(async (address) => {
      const socket = new WebSocket(`${location.origin.replace('http', 'ws')}${address}`, 'aeolis.v1.json');
      const messages = [];
      socket.onmessage = ({ data }) => messages.push(Object.keys(JSON.parse(data))[0]);
      await new Promise((resolve) => (socket.onopen = resolve));
      socket.send(JSON.stringify({ command: { request: 7, run: 1, command: 'CDH_NO_OP' } }));
      socket.send(JSON.stringify({ control: { pace: 2 } }));
      for (let tries = 0; tries < 200 && !(messages.includes('welcome') && messages.includes('batch')); ++tries)
        await new Promise((resolve) => setTimeout(resolve, 100));
      await new Promise((resolve) => setTimeout(resolve, 1000)); // an answer would have come by then
      socket.close();
      return messages;
    }, live);
    assert.ok(heard.includes('welcome') && heard.includes('batch'), heard.join());
    assert.deepEqual(
      heard.filter((kind) => /reply|refusal/i.test(kind)),
      [],
    );
    await page.close();
    assert.equal(await ask(port, '/'), 200);
  } finally {
    pages.closeAllConnections();
    pages.close();
    await server.stop();
    await chrome.close();
    await remove();
  }
});
