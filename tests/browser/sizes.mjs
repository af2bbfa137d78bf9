// SPDX-License-Identifier: Apache-2.0
// The states in which the console is measured at each size of a window, and the measurement.
import { comesToRest, control, flyTo, focused, landed, stageLook, waitFor } from './support.mjs';
import { keepWhatIsWritten, notWhole } from './texts.mjs';

/** Inner sizes of browser windows that people have, scrollbars shown. */
export const SIZES = [
  [1280, 585],
  [1366, 650],
  [1536, 730],
  [1440, 790],
  [1920, 950],
  [2560, 1300],
  [3840, 2000],
  [390, 700],
];

/** Each state: a server in it, and the way of a page to it. */
export const STATES = {
  'first open': async (serve, t) => {
    const server = await serve(t, 'first', ['--scenario', 'nominal']);
    await control(server, { pause: true });
    return { server, reach: ({ shows }) => shows('waiting', /set edl parameters/) };
  },
  armed: async (serve, t) => {
    const server = await serve(t, 'armed', ['--scenario', 'nominal']);
    return {
      server,
      reach: async ({ page, shows }) => {
        await shows('waiting', /set edl parameters/);
        await page.keyboard.press('/');
        await page.keyboard.type('set edl parameters');
        await page.keyboard.press('Enter');
        await shows('dry-run', /✓ It would be sent/);
        await page.keyboard.press('Enter');
        await waitFor(() => stageLook(page, 'EDL_SET_PARAMETERS', 'verified'), /ok/);
        await shows('waiting', /ype “do edl”/);
        await control(server, { pause: true });
        await page.keyboard.type('do edl');
        await page.keyboard.press('Enter');
        await shows('dry-run', /✓ It would be sent once it is armed/);
        await page.keyboard.press('Enter');
        await shows('command-armed', /ARMED/);
        await shows('armed-here', /ARMED HERE: EDL_DO_EDL\s*latest to send in \d/);
      },
    };
  },
  'mid entry': async (serve, t) => {
    const server = await serve(t, 'entry', ['--scenario', 'nominal_auto', '--pace', '100']);
    await flyTo(server, 70);
    return { server, reach: ({ shows }) => shows('waiting', /peak deceleration/) };
  },
  'station lost': async (serve, t) => {
    const server = await serve(t, 'station', ['--scenario', 'nominal_auto', '--pace', '100']);
    await flyTo(server, 180);
    await control(server, { inject: { station_outage: { duration_s: 60 } } });
    await flyTo(server, 188);
    return {
      server,
      reach: ({ shows }) => shows('waiting', /Predicted: [^]*Not heard since [^]*no word of it can come/),
    };
  },
  landed: async (serve, t) => ({
    server: await landed(serve, t),
    reach: async ({ page, shows }) => {
      await shows('waiting', /Touchdown (reported|confirmed)/);
      await shows('reading-altitude', /\d/);
      await waitFor(
        () => page.locator('[data-event]').count(),
        (count) => count > 8,
      );
    },
  }),
};

/** The card of a touchdown in the place of the descent, and the notes with their tools in that of the data. */
STATES.touchdown = async (serve, t) => {
  const server = await serve(t, 'touchdown', ['--scenario', 'nominal_auto', '--pace', '100']);
  await flyTo(server, 441);
  return {
    server,
    reach: async ({ page, shows }) => {
      await shows('touchdown', /Touchdown reported/);
      await page.getByTestId('tab-notes').click();
      await shows('notes', /nothing is written down yet/);
    },
  };
};

/** Two procedures under way, beside the timeline and in the place of the data: one awaits its release, one is held. */
STATES.procedures = async (serve, t) => {
  const server = await serve(t, 'procedures', ['--scenario', 'nominal', '--pace', '10']);
  const post = async (route, body) => {
    const answer = await fetch(`${server.address}/api/v1/runs/1/procedures${route}`, {
      method: 'POST',
      body: JSON.stringify({ position: 'flight_director', by: 'A. Ng', ...body }),
    });
    if (!answer.ok) throw new Error(`${route}: ${answer.status} ${await answer.text()}`);
  };
  await waitFor(
    async () => (await server.get('/runs')).runs.length,
    (runs) => runs > 0,
  );
  await post('', { procedure: 'uhf_lost' });
  await post('/1/acts', { kind: 'hold', reason: 'The station asks for a minute.' });
  await post('', { procedure: 'start' });
  await post('/2/acts', { kind: 'sign', step: 'solution', position: 'navigation' });
  await waitFor(
    async () => (await server.get('/runs/1/procedures')).procedures[1].procedure.part,
    (part) => part === 'body',
  );
  await control(server, { pause: true });
  return {
    server,
    reach: async ({ page, shows }) => {
      await shows('under-way', /UHF lost[^]*Start of entry/);
      await page.getByTestId('tab-procedures').click();
      await page.getByTestId('position').selectOption('flight_director');
      await page.getByTestId('signature').fill('A. Ng');
      await page.getByTestId('signature').press('Enter');
      await shows('procedure', /release/);
    },
  };
};

/** A past view of the landed run: bar, marks and double borders take their room. */
STATES.past = async (serve, t) => {
  const { server, reach } = await STATES.landed((of, _name, more) => serve(of, 'past', more), t);
  return {
    server,
    reach: async (opened) => {
      const { page, shows } = opened;
      await reach(opened);
      await page.keyboard.press('r');
      await waitFor(() => focused(page), /range-from/);
      await page.keyboard.type('E+0:30');
      await page.getByTestId('range-to').fill('E+4:30');
      await page.keyboard.press('Enter');
      await shows('range-message', /✓/);
    },
  };
};

/** A poll that asks this person, from a position offered and taken: its line stands in the banner. */
STATES.poll = async (serve, t) => {
  const server = await serve(t, 'poll', ['--scenario', 'nominal_auto', '--pace', '10']);
  const post = async (body) => {
    const answer = await fetch(`${server.address}/api/v1/runs/1/positions`, {
      method: 'POST',
      body: JSON.stringify(body),
    });
    if (!answer.ok) throw new Error(`${body.kind}: ${answer.status} ${await answer.text()}`);
  };
  await flyTo(server, -700);
  await post({ kind: 'take', position: 'flight_director', by: 'A. Ng' });
  await post({ kind: 'take', position: 'command', by: 'Ida' });
  await post({ kind: 'poll', position: 'flight_director', by: 'A. Ng', subject: 'entry, descent and landing' });
  return {
    server,
    reach: async ({ page, shows }) => {
      await page.getByTestId('tab-procedures').click();
      await page.getByTestId('signature').fill('Ida');
      await page.getByTestId('signature').press('Enter');
      await page.getByTestId('tab-channels').click();
      await shows('asked-here', /Command, go or no go: “entry, descent and landing”\?/);
      await shows('lasting', /Commanding is closed/);
    },
  };
};

/** A row of the situation, where the page has none now: what is measured must hold with it. */
function takeItsRow() {
  if (document.querySelector('.situation')) return;
  const row = document.createElement('div');
  row.className = 'situation';
  document.querySelector('.console').append(row);
}

/**
 * Runs in the page: what draws the eye before what matters does, in words: a phase that is larger than the banner's
 * first words, and two scrollbars beside each other at the table of channels. (The tools of a range may be higher than
 * their panel.)
 */
function outOfOrder() {
  const px = (element) => parseFloat(getComputedStyle(element).fontSize);
  const [banner, phase] = ['.situation b', '.phase-now b'].map((each) => document.querySelector(each));
  const first = document.querySelector('.armed-here') ?? banner;
  const found = [];
  const isLong =
    document.querySelector('.situation')?.matches('.situation-long, :has(.asked-here)') && first === banner;
  if (first && phase && !isLong && px(phase) > px(first))
    found.push(`the phase has ${px(phase)} px, what matters most ${px(first)} px`);
  const scrolls = (element) =>
    /auto|scroll/.test(getComputedStyle(element).overflowY) && element.scrollHeight > element.clientHeight + 1;
  for (const inner of document.querySelectorAll('.panel .channels-scroll')) {
    const outer = inner.parentElement.closest('.table-box, .panel-body');
    if (outer && inner.checkVisibility() && scrolls(inner) && scrolls(outer))
      found.push(`${inner.ariaLabel} scrolls within a panel that scrolls`);
  }
  return found;
}

/** What is not whole or not in order of a page at each size, in words. */
async function measuredAt(page, state, sizes) {
  const found = [];
  for (const [width, height] of sizes) {
    await page.setViewportSize({ width, height });
    await comesToRest(page);
    const all = [...(await page.evaluate(notWhole)), ...(await page.evaluate(outOfOrder))];
    found.push(...all.map((words) => `${state}, ${width} × ${height}: ${words}`));
  }
  return found;
}

/** A page in a state, with all that it has asked for. */
async function pageIn({ open, serve }, t, state) {
  const { server, reach } = await STATES[state](serve, t);
  const opened = await open(server.address, { width: 1440, height: 790 }, keepWhatIsWritten);
  await reach(opened);
  await waitFor(
    () => opened.page.locator('body').innerText(),
    (all) => !/asking…|ground has not answered|connecting/.test(all),
  );
  await opened.page.evaluate(takeItsRow);
  return opened;
}

/** What is not whole in each state at each size, in words. */
export async function measured(workplace, t, states, sizes, themes = ['dark']) {
  const found = [];
  for (const state of states) {
    const { page, problems } = await pageIn(workplace, t, state);
    for (const theme of themes) {
      await page.evaluate((name) => (document.documentElement.dataset.theme = name), theme);
      found.push(...(await measuredAt(page, state, sizes)));
    }
    found.push(...problems);
    await page.close();
  }
  return found;
}

/** The same of each tab of the data panel, of a landing that has just touched down. */
export async function measuredTabs(workplace, t, sizes) {
  const { page, problems } = await pageIn(workplace, t, 'touchdown');
  const tabs = await page.getByRole('tab').evaluateAll((all) => all.map((each) => each.dataset.testid));
  const found = [];
  for (const tab of tabs) {
    await page.setViewportSize({ width: 1440, height: 790 });
    await page.getByTestId(tab).click();
    await waitFor(
      () => page.locator('body').innerText(),
      (all) => !/asking…|ground has not answered|Loading …/.test(all),
    );
    found.push(...(await measuredAt(page, tab, sizes)));
  }
  await page.close();
  return [...found, ...problems];
}
