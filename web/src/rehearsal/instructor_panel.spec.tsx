// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { uplink } from '../commands/line';
import { useForTest } from '../run/session';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { InstructorPanel } from './instructor_panel';
import { faultWords, injectionOf } from './faults';
import { Review } from './review';
import { interventions, message, ofRun, refreshInterventions } from './instructor';
import { refreshPlan } from './plan';
import type { Plan } from './plan';

const server = aServer();
const silent = {
  device_fault: { device: 'DEVICE_RADAR', unit: 'REDUNDANT_UNIT_B', kind: 'DEVICE_FAULT_KIND_SILENT', duration_s: 10 },
};
const PLAN: Plan = {
  name: 'radar',
  title: 'The radar goes',
  purpose: 'Whether the room sees it.',
  scenario: 'nominal',
  injects: [
    {
      inject: 'a',
      title: 'Radar B silent',
      when: 'at E+0:12',
      does: 'radar B silent, for 10 s',
      shows: 'no new slant ranges',
      team: ['say so on the loop', '<b>look</b>'],
      state: 'done',
      e_s: 12.25,
    },
    { inject: 'b', title: 'Reset', when: '', does: 'the prime computer', shows: '', team: [], state: 'waiting' },
    { inject: 'c', title: 'Outage', when: 'on link', does: '', shows: '', team: ['x'], state: 'skipped', e_s: 14 },
  ],
};
let page: HTMLElement;
const shown = (name: string) => page.querySelector<HTMLElement>(`[data-testid="${name}"]`);
const soon = () => act(() => new Promise<void>((done) => setTimeout(done, 10)));
const open = async () => {
  act(() => render(<InstructorPanel />, page));
  const fold = shown('instructor') as HTMLDetailsElement | null;
  if (!fold) return;
  act(() => {
    fold.open = true;
    fold.dispatchEvent(new Event('toggle'));
  });
  await soon();
};
const send = async (field: string) => {
  shown(field)
    ?.closest('form')
    ?.dispatchEvent(new Event('submit', { bubbles: true, cancelable: true }));
  await soon();
};

beforeEach(() => {
  access.value = { state: 'open' };
  interventions.value = message.value = undefined;
  page = document.createElement('div');
  document.body.append(page);
  useForTest(aStore(), aDictionary);
});
afterEach(() => {
  act(() => render(null, page));
  page.remove();
  access.value = { state: 'asking' };
});

describe('the instructor’s panel', () => {
  it('is folded away, and shows nothing of what was done until it is opened', () => {
    interventions.value = { run: 1, all: [{ e_s: 12.25, fault: silent }] };
    act(() => render(<InstructorPanel />, page));
    expect([shown('instructor')?.hasAttribute('open'), shown('interventions')]).toEqual([false, null]);
    expect(page.textContent).not.toContain('radar');
  });
  it('lists faults and notes with their instants, and says who else can read it', async () => {
    server.routes['GET /runs/1/interventions'] = {
      json: {
        interventions: [
          { e_s: 12.25, fault: silent },
          { e_s: 14, note: { text: '<b>no one looks</b>', by: 'Ida' } },
        ],
      },
    };
    await open();
    expect([...page.querySelectorAll('[data-testid="interventions"] li')].map((each) => each.textContent)).toEqual([
      'E+0:12.3 ▲ radar B silent, for 10 s',
      'E+0:14.0 Ida <b>no one looks</b>',
    ]);
    expect(page.textContent).toContain('no accounts: whoever opens this fold can read it');
  });
  it('asks for a fault in the words of the schema, and a refusal says why in place', async () => {
    const outage = injectionOf('the ground station', 'A', '', 30);
    expect([outage, faultWords(outage)]).toEqual([
      { station_outage: { duration_s: 30 } },
      'the ground station brings nothing, for 30 s',
    ]);
    expect([
      injectionOf('DEVICE_IMU', 'B', 'DEVICE_FAULT_KIND_DROPOUT', 3),
      faultWords({ computer_reset: true }),
    ]).toEqual([
      {
        device_fault: {
          device: 'DEVICE_IMU',
          unit: 'REDUNDANT_UNIT_B',
          kind: 'DEVICE_FAULT_KIND_DROPOUT',
          duration_s: 3,
        },
      },
      'the prime computer starts anew',
    ]);
    server.routes['POST /rehearsals/current'] = {
      status: 422,
      json: { error: 'device_faults[0].kind: is not possible for this device' },
    };
    await open();
    await send('fault-what');
    expect(server.asked.at(-1)?.body).toEqual({
      run: 1,
      inject: injectionOf('DEVICE_RADAR', 'A', 'DEVICE_FAULT_KIND_SILENT', 10),
    });
    expect(shown('instructor-message')?.textContent).toContain('not possible for this device');
  });
  it('has words for what happens to orbiters, link and wind, and asks for it with its amount', () => {
    const amount = { fraction: 0.2, east_mps: 20, north_mps: -5, off_by: 0, grows_per_s: 0 };
    expect(['the orbiters', 'octets on UHF', 'the wind'].map((each) => injectionOf(each, 'A', '', 60, amount))).toEqual(
      [
        { orbiter_outage: { duration_s: 60 } },
        { uhf_loss: { duration_s: 60, fraction: 0.2 } },
        { wind_shift: { duration_s: 60, east_mps: 20, north_mps: -5 } },
      ],
    );
    expect(
      ['the orbiters', 'octets on UHF', 'the wind'].map((each) => faultWords(injectionOf(each, 'A', '', 60, amount))),
    ).toEqual([
      'no orbiter relays, for 60 s',
      'UHF loses 20 % of its octets at least, for 60 s',
      'the wind changes by 20 m/s to the east and -5 m/s to the north, for 60 s',
    ]);
  });
  it('has words for air and for sensors that measure wrongly, and asks for them with their amounts', () => {
    const amount = { fraction: -0.1, east_mps: 0, north_mps: 0, off_by: 0.5, grows_per_s: 0.25 };
    const air = injectionOf('the air', 'A', '', 60, amount);
    const imu = injectionOf('DEVICE_IMU', 'B', 'MEASURES_WRONGLY', 9, amount);
    const radar = injectionOf('DEVICE_RADAR', 'A', 'MEASURES_WRONGLY', 9, { ...amount, off_by: 0 });
    expect(air).toEqual({ air_shift: { duration_s: 60, fraction: -0.1 } });
    expect(imu).toEqual({
      sensor_error: {
        device: 'DEVICE_IMU',
        unit: 'REDUNDANT_UNIT_B',
        duration_s: 9,
        off_by: 0.5,
        grows_per_s: 0.25,
      },
    });
    expect([air, imu, radar].map(faultWords)).toEqual([
      'the air is 10 % thinner, for 60 s',
      'imu B measures forces wrongly by 0.5 m/s² and 0.25 m/s² more each second, for 9 s',
      'radar A measures velocities wrongly by 0.25 m/s more each second, for 9 s',
    ]);
  });
  it('has words for a tone that says what is not so', () => {
    expect(faultWords({ false_tone: { tone: 1, duration_s: 20 } })).toBe(
      'the vehicle sends tone 1 in place of its own, for 20 s',
    );
  });
  it('injects what is chosen from the library, after showing what it does and what is to be done', async () => {
    server.routes['GET /plans'] = {
      json: {
        plans: [],
        library: [
          {
            name: 'safe_mode',
            title: 'The orbiter goes',
            does: 'no orbiter relays, for 60 s',
            shows: 'UHF ends',
            team: ['action: sends no command for 60 s'],
            fault: { orbiter_outage: { duration_s: 60 } },
          },
        ],
      },
    };
    server.routes['POST /rehearsals/current'] = { json: {} };
    await open();
    const choice = shown('library-choice') as HTMLSelectElement;
    await act(async () => {
      choice.value = 'safe_mode';
      choice.dispatchEvent(new Event('change', { bubbles: true }));
    });
    expect(shown('library-entry')?.textContent).toBe(
      '▲ no orbiter relays, for 60 sUHF endsaction: sends no command for 60 s',
    );
    await send('library-choice');
    expect(server.asked.find((each) => each.method === 'POST')?.body).toEqual({
      run: 1,
      inject: { orbiter_outage: { duration_s: 60 } },
    });
  });
  it('keeps a note once, in the instructor’s name, and apart from the shift log', async () => {
    uplink.value = { ...uplink.value, controller: 'Ida' };
    server.routes['POST /rehearsals/current'] = { json: {} };
    await open();
    await send('instructor-note');
    expect([shown('instructor-message')?.textContent, server.asked.some((each) => each.method === 'POST')]).toEqual([
      '✖ there is nothing to write down',
      false,
    ]);
    const field = shown('instructor-note') as HTMLInputElement;
    field.value = ' do they see it? ';
    act(() => void field.dispatchEvent(new Event('input', { bubbles: true })));
    await send('instructor-note');
    expect(server.asked.filter((each) => each.method === 'POST')).toEqual([
      { method: 'POST', path: '/rehearsals/current', body: { run: 1, note: { text: 'do they see it?', by: 'Ida' } } },
    ]);
    expect([field.value, shown('instructor-message')?.textContent]).toEqual(['', '● kept for the review']);
    uplink.value = { ...uplink.value, controller: '' };
  });
  it('has the plan in order, what became of each inject, and buttons for those that wait', async () => {
    server.routes['GET /runs/1/plan'] = { json: PLAN };
    await open();
    expect(shown('plan')?.querySelector('h3')?.textContent).toBe('Plan: The radar goes');
    expect(shown('plan')?.textContent).toContain('Whether the room sees it.');
    expect(
      [...page.querySelectorAll('.injects > li')].map((each) => each.querySelector('.inject-head')?.textContent),
    ).toEqual([
      '▲ done E+0:12.3 Radar B silent at E+0:12 ',
      '▷ waiting Reset by hand nowskip',
      '– skipped E+0:14.0 Outage on link ',
    ]);
    const first = page.querySelector('[data-inject="a"]');
    expect([...first!.querySelectorAll('p')].map((each) => each.textContent)).toEqual([
      'does radar B silent, for 10 s',
      'shows no new slant ranges',
    ]);
    expect([...first!.querySelectorAll('details li')].map((each) => each.textContent)).toEqual([
      'say so on the loop',
      '<b>look</b>',
    ]);
    expect(first!.querySelector('details')?.open).toBe(false);
    expect([...page.querySelectorAll('.injects button')].map((each) => each.getAttribute('aria-label'))).toEqual([
      'now: Reset',
      'skip: Reset',
    ]);
  });
  it('orders an inject now or not at all, keeps the keyboard at it, and says what came of it', async () => {
    server.routes['GET /runs/1/plan'] = { json: PLAN };
    server.routes['POST /rehearsals/current'] = { json: {} };
    await open();
    act(() => shown('inject-now-b')?.click());
    expect((document.activeElement as HTMLElement).dataset.inject).toBe('b');
    await soon();
    expect(shown('instructor-message')?.textContent).toBe('● “Reset” is injected with the next cycle');
    server.routes['POST /rehearsals/current'] = { status: 409, json: { error: 'b waits no more: it is done' } };
    act(() => shown('inject-skip-b')?.click());
    await soon();
    expect(shown('instructor-message')?.textContent).toBe('✖ b waits no more: it is done');
    const said = () => [...page.querySelectorAll('[data-inject] p')].filter((each) => /^[●✖]/.test(each.textContent));
    expect(said().map((each) => [each.closest('li')?.dataset.inject, each.textContent])).toEqual([
      ['b', '✖ b waits no more: it is done'],
    ]);
    await send('instructor-note'); // without a word in it: what is said then is not about the inject
    expect([shown('instructor-message')?.textContent, said()]).toEqual(['✖ there is nothing to write down', []]);
    expect(server.asked.filter((each) => each.method === 'POST').map((each) => each.body)).toEqual([
      { run: 1, plan: { inject: 'b' } },
      { run: 1, plan: { inject: 'b', skip: true } },
    ]);
    expect(server.asked.at(-1)?.path).toBe('/runs/1/plan');
  });
  it('has no plan where the run has none, and names injects in the list of what was done', async () => {
    server.routes['GET /runs/1/plan'] = { json: { name: '', title: '', purpose: '', scenario: '', injects: [] } };
    await open();
    expect(shown('plan')).toBe(null);
    server.routes['GET /runs/1/plan'] = { json: PLAN };
    server.routes['GET /runs/1/interventions'] = {
      json: {
        interventions: [
          { e_s: 12.25, fault: silent, inject: 'a' },
          { e_s: 14, skipped: true, inject: 'c' },
        ],
      },
    };
    await act(async () => {
      await refreshPlan();
      await refreshInterventions();
    });
    expect([...page.querySelectorAll('[data-testid="interventions"] li')].map((each) => each.textContent)).toEqual([
      'E+0:12.3 ▲ radar B silent, for 10 s as planned: Radar B silent',
      'E+0:14.0 – skipped: Outage',
    ]);
  });
  it('is not there for a director, who is told of the right and not of a plan, and nothing is asked', async () => {
    access.value = { state: 'in', user: 'dan', role: 'director', rights: ['watch', 'rehearse'] };
    await open();
    await refreshPlan();
    expect([shown('instructor'), server.asked.length]).toEqual([null, 0]);
    expect(page.textContent).toBe(
      '□ faults and notes of a rehearsal need the right to instruct; you are dan, director',
    );
  });
  it('is not there for who may not instruct, and what was done is not asked for before the end', async () => {
    access.value = { state: 'in', user: 'olga', role: 'observer', rights: ['watch'] };
    await open();
    await refreshInterventions();
    expect([page.textContent, server.asked.length]).toEqual(['', 0]);
    for (const state of ['finished', 'interrupted'] as const) {
      // a cut-off run is over as well
      interventions.value = undefined;
      const over = aStore([], aRun({ state }));
      useForTest(over, aDictionary);
      server.routes['GET /runs/1/interventions'] = { json: { interventions: [{ e_s: 1, note: { text: 'x' } }] } };
      await refreshInterventions();
      expect(ofRun(over), state).toHaveLength(1);
    }
  });
});

describe('the review', () => {
  const toggled = async (open: boolean) => {
    const fold = shown('review') as HTMLDetailsElement | null;
    if (!fold) return 'none';
    act(() => {
      fold.open = open;
      fold.dispatchEvent(new Event('toggle'));
    });
    await soon();
    return fold.querySelector('[role="status"]')?.textContent;
  };
  const shownFor = (run: ReturnType<typeof aStore>) => {
    useForTest(run, aDictionary);
    act(() => render(<Review />, page));
    return toggled(true);
  };
  it('is of a run that is over', async () => {
    expect(await shownFor(aStore())).toBe('none');
    expect(server.asked).toEqual([]);
  });
  it('has no score until the server gives one, says why, and asks again when it is opened again', async () => {
    server.routes['GET /runs/1/score'] = { status: 503, json: { error: 'too much waits' } };
    server.routes['GET /runs/1/interventions'] = { json: {} };
    server.routes['GET /runs/1/plan'] = { json: PLAN };
    expect(await shownFor(aStore([], aRun({ state: 'finished', outcome: 'touchdown' })))).toBe('✖ too much waits');
    const asked = () => server.asked.filter((each) => each.path === '/runs/1/score').length;
    expect(asked()).toBe(1);
    await toggled(false);
    await toggled(true);
    expect(asked()).toBe(2);
  });
});
