// Every panel alone and the whole console, in both themes and every mode: axe finds nothing, each says which mode it is in, nothing is
// wider than the screen from 320 px to 4K; live against recorded is shown octet by octet; the script is as small as was promised.
import assert from 'node:assert/strict';
import { readFile, readdir } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { madeUpCampaign } from './made_up_campaign.mjs';
import { comparePicture } from './picture.mjs';
import { findings, focused, root, waitFor, workplace } from './support.mjs';

const PANELS = ['timeline', 'descent', 'phases', 'tones', 'plots', 'events', 'waiting', 'commands', 'channels', 'alarms', 'notes', 'packets', 'verdicts', 'links', 'flown', 'recorded', 'rehearsal', 'campaigns', 'users'];
const SCRIPT_KB = 150;

const { open, serve } = workplace();
let server;

before(async () => {
    server = await serve(undefined, 'panels', ['--scenario', 'nominal_auto', '--pace', '0']);
    await waitFor(async () => (await server.get('/runs')).runs[0]?.state, (state) => state === 'finished', 60_000);
});
after(() => server?.stop());

test('axe finds nothing on any panel in both themes, and each panel says its mode', { timeout: 400_000 }, async () => {
    const found = [];
    const { page, problems, shows } = await open(server.address);
    await madeUpCampaign(page);
    for (const name of ['dark', 'light']) {
        await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), name);
        for (const panel of [...PANELS, undefined]) {
            await page.goto(panel === undefined ? server.address : `${server.address}/?panel=${panel}`);
            await shows('badge', /ENDED RUN/);
            if (panel === 'verdicts') await shows('verdict-sentence', /bit for bit/);
            if (panel === 'flown') await shows('flown-summary', /timepoints fired/);
            if (panel === 'campaigns') await shows('campaign-ellipse', /azimuth/);
            if (panel !== 'phases') assert.match((await page.getByTestId('mode-mark').allInnerTexts()).join(), /ended, rehearsal/, `${panel} does not say its mode`);
            found.push(...(await findings(page, name)).map((line) => `${panel ?? 'console'}, ${name}: ${line}`));
        }
        for (const [panel, reach] of [
            ['packets', async () => {
                await shows('unit-table', /UHF live/);
                await page.getByTestId('units').focus();
                await page.keyboard.press('ArrowDown');
                await shows('packet', /unit \d/);
            }],
            ['commands', async () => {
                await page.getByRole('button', { name: /EDL_SET_PARAMETERS #/ }).first().click();
                await shows('read-back', /held as sent/);
            }],
        ]) {
            await page.goto(`${server.address}/?panel=${panel}`);
            await shows('badge', /ENDED RUN/);
            await reach();
            found.push(...(await findings(page, name)).map((line) => `${panel} opened, ${name}: ${line}`));
        }
        await page.goto(server.address);
        await shows('badge', /ENDED RUN/);
        for (const [key, title] of [['y', /REPLAY, NOT LIVE/], ['r', /ENDED RUN/], ['?', /ENDED RUN/]]) {
            await page.keyboard.press(key);
            await shows('badge', title);
            found.push(...(await findings(page, name)).map((line) => `console after ${key}, ${name}: ${line}`));
            await page.keyboard.press('Escape');
            await page.keyboard.press('Escape');
        }
    }
    assert.deepEqual(found, []);
    assert.deepEqual(problems, []);
    await page.close();
});

test('each panel looks as its stored picture does, within a tolerance', { timeout: 120_000 }, async () => {
    const { page, problems, shows } = await open(server.address, { width: 1000, height: 640 });
    await madeUpCampaign(page);
    const different = [];
    const compare = async (name, what) => different.push(...await comparePicture(page, name, await what.screenshot({ animations: 'disabled' })));
    for (const [theme, panels] of [['dark', PANELS.filter((panel) => panel !== 'phases')], ['light', ['timeline', 'plots', 'commands', 'campaigns']]]) {
        await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), theme);
        for (const panel of panels) {
            await page.goto(`${server.address}/?panel=${panel}`);
            await shows('badge', /ENDED RUN/);
            await shows('stream-state', /connected/);
            if (panel === 'verdicts') await shows('verdict-sentence', /bit for bit/);
            if (panel === 'flown') await shows('flown-summary', /timepoints fired/);
            if (panel === 'campaigns') await shows('campaign-ellipse', /azimuth/);
            if (panel === 'channels') await waitFor(() => page.getByTestId('channel-altitude_m').innerText(), /\d/);
            await page.waitForTimeout(700); // history, and a draw after it
            await compare(`${panel}_${theme}`, page.locator('main'));
        }
    }
    await page.setViewportSize({ width: 1600, height: 900 });
    for (const theme of ['dark', 'light']) {
        await page.evaluate((wanted) => localStorage.setItem('aeolis-theme', wanted), theme);
        await page.goto(server.address);
        await shows('waiting', /Landed/);
        await shows('stream-state', /connected/);
        await page.waitForTimeout(1500);
        await compare(`console_${theme}`, page);
    }
    assert.deepEqual(different, []);
    assert.deepEqual(problems, []);
    await page.close();
});

test('a replay shows nothing of what came later, in every panel, and the way back is one key', { timeout: 40_000 }, async () => {
    const { page, problems, text, shows } = await open(server.address);
    await shows('waiting', /Landed/);
    await page.keyboard.press('y');
    await shows('badge', /REPLAY, NOT LIVE/);
    await page.keyboard.press('p');
    const marks = await page.getByTestId('mode-mark').allInnerTexts();
    assert.ok(marks.length >= 10, `${marks.length} panels are marked`);
    for (const mark of marks) assert.match(mark, /replay, rehearsal/i);
    assert.doesNotMatch(await text('phases'), /✓\s*Entry/);
    assert.equal(await page.locator('[data-event="TOUCHDOWN"]').count(), 0, 'an event that came later is shown');
    assert.ok(await page.getByTestId('command-line').isDisabled());
    await page.keyboard.press('Escape');
    await shows('badge', /ENDED RUN/);
    await shows('phases', /▶\s*Landed/);
    assert.deepEqual(problems, []);
    await page.close();
});

test('live is proven against the recording, by packet and by link, and a packet that differs has its octets marked', { timeout: 40_000 }, async () => {
    const { page, problems, text, shows } = await open(server.address);
    await shows('badge', /ENDED RUN/);
    await page.keyboard.press('v');
    const { streams, tones } = await server.get('/runs/latest/proof');
    const live = streams.reduce((sum, row) => sum + Number(row.realtime), 0);
    await waitFor(async () => (await text('verdict-sentence')).replaceAll(/\D/g, ''), (digits) => digits === String(live));
    assert.match(await text('verdict-sentence'), /✓ All .* bit for bit/);
    const shown = await page.locator('[data-testid="verdicts-by-packet"] tbody tr').count();
    assert.equal(shown, streams.length + 1);
    const identical = tones.filter((tone) => tone.verdict === 'identical').length;
    assert.match(await text('tone-verdicts'), new RegExp(`\\b${identical} identical`));
    await shows('verdict-count', /^none$/);

    // No landing of ours brings one that differs, so the answer of the server is altered on its way.
    await page.route('**/packets?verdict=never_seen_live*', async (route) => {
        const answer = await (await route.fetch()).json();
        const [packet] = answer.packets;
        packet.verdict = 'differs';
        packet.other_hex = packet.hex.slice(0, -2) + (packet.hex.endsWith('00') ? 'ff' : '00');
        await route.fulfill({ json: answer });
    });
    await page.getByTestId('verdict-choice').selectOption('never_seen_live');
    await page.getByTestId('verdict-packets').getByRole('button').first().click();
    await shows('difference', /1 of \d+ octets differ/);
    assert.equal(await page.getByTestId('difference').locator('mark').count(), 2, 'the octet is marked on both sides');
    await page.keyboard.press('Escape');

    await page.getByTestId('tab-links').click();
    await waitFor(() => page.getByTestId('link-row-uhf_live').innerText(), /UHF live[^]*%/);
    assert.deepEqual(problems.filter((problem) => !/favicon/.test(problem)), []);
    await page.close();
});

test('a packet is read by keyboard: its fields light their octets, an octet lights its fields, and a packet can be chosen alone', { timeout: 40_000 }, async () => {
    const { page, problems, text, shows } = await open(`${server.address}/?panel=packets`);
    await shows('badge', /ENDED RUN/);
    const { streams } = await server.get('/runs/latest/proof');
    const live = streams.filter((row) => Number(row.realtime) > 0).map((row) => row.name).sort();
    await waitFor(async () => (await page.locator('[data-testid="packet-streams"] tbody button').allInnerTexts()).sort().join(), (names) => names === live.join());
    await page.getByRole('button', { name: 'GncNavigation', exact: true }).focus();
    await page.keyboard.press('Enter');
    await waitFor(async () => new Set(await page.locator('[data-testid="unit-table"] tbody tr td:nth-child(4)').allInnerTexts()), (names) => names.size === 1 && names.has('GncNavigation'));
    assert.equal(await focused(page), 'units');
    await page.keyboard.press('ArrowDown');
    await shows('packet', /GncNavigation over [^]*octets/);
    const first = await text('packet');
    await page.keyboard.press('ArrowDown');
    await waitFor(() => text('packet'), (now) => now !== first);

    const unit = /unit (\d+)/.exec(await text('packet'))[1];
    const { packets } = await server.get(`/runs/latest/packets?name=GncNavigation&limit=1000`);
    const packet = packets.find((each) => each.unit.unit === unit);
    const shown = (await page.locator('[data-octet]').allInnerTexts()).join('');
    if (packet) assert.equal(shown, packet.hex);
    const litOctets = () => page.locator('[data-octet].lit').evaluateAll((all) => all.map((each) => Number(each.dataset.octet)));
    const litFields = () => page.locator('[data-field].lit').evaluateAll((all) => all.map((each) => each.dataset.field));

    await page.getByTestId('packet-fields').focus();
    for (let field = 0; field < 4; ++field) await page.keyboard.press('ArrowDown');
    const [name] = await litFields();
    const octets = await litOctets();
    assert.ok(octets.length > 0, `${name} lights no octet`);
    await shows('packet-place', new RegExp(`${name}: (bits? [^]* of )?octets? ${octets[0]}`));
    await page.locator(`[data-octet="${octets[0]}"]`).hover();
    await waitFor(litFields, (fields) => fields.includes(name));
    await page.getByTestId('packet-fields').focus();
    await page.keyboard.press('Escape');
    await waitFor(() => page.getByTestId('packet').count(), (count) => count === 0);
    assert.equal(await focused(page), 'units');
    assert.deepEqual(problems, []);
    await page.close();
});

test('from 320 px to 4K nothing is wider than the screen', { timeout: 60_000 }, async () => {
    const { page, shows } = await open(server.address);
    await shows('badge', /ENDED RUN/);
    for (const [width, height] of [[320, 640], [768, 1024], [1024, 768], [1366, 768], [1920, 1080], [3840, 2160]]) {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(150);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(wide <= width, `${wide} px wide on ${width}`);
    }
    await page.close();
});

test('the script is at most 150 kB, compressed', async () => {
    const assets = path.join(root, 'web/dist/assets');
    const scripts = (await readdir(assets)).filter((name) => name.endsWith('.js'));
    const sizes = await Promise.all(scripts.map(async (name) => gzipSync(await readFile(path.join(assets, name))).length / 1000));
    const sum = sizes.reduce((total, size) => total + size, 0);
    assert.ok(scripts.length >= 2 && sum > 1, 'no built scripts');
    assert.ok(sum <= SCRIPT_KB, `${sum.toFixed(1)} kB`);
});
