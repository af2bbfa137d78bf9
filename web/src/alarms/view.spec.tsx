// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act as settled } from 'preact/test-utils';
import { beforeEach, describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { Header } from '../clocks/view';
import { useForTest } from '../run/session';
import { pastRange } from '../run/shown';
import { aDictionary, aStore, alarm } from '../testing/fixtures';
import { aServer } from '../testing/server';
import {
  acknowledgeAll,
  act,
  actionsOn,
  alarms,
  listed,
  lookOf,
  newAmong,
  note,
  problem,
  refreshAlarms,
  shelveFor,
  sorted,
  toAcknowledge,
} from './model';
import type { AlarmState } from './model';
import { Alarms } from './view';

const server = aServer();
const CURRENT = 'GET /runs/1/alarms?state=current';
const an = (fields: Partial<AlarmState>): AlarmState => ({
  name: 'altitude_m',
  kind: 'limit',
  state: 'unacknowledged',
  severity: 'warning',
  worst: 'warning',
  ...fields,
});

beforeEach(() => {
  alarms.value = undefined;
  problem.value = '';
  note.value = '';
  shelveFor.value = '300';
  access.value = { state: 'open' };
  useForTest(aStore(), aDictionary);
});

describe('alarms', () => {
  it('stand in the order of what no one has looked at, the worst first', () => {
    const all = [
      an({ name: 'c', state: 'shelved' }),
      an({ name: 'b', state: 'acknowledged', acknowledged: true }),
      an({ name: 'a' }),
      an({ name: 'd', worst: 'critical' }),
    ];
    expect(sorted(all).map((alarm) => alarm.name)).toEqual(['d', 'a', 'b', 'c']);
  });
  it('look by shape as severe as they are now, and quiet once they are shelved', () => {
    expect(
      [
        an({ severity: 'critical' }),
        an({}),
        an({ severity: 'none', state: 'returned' }),
        an({ state: 'shelved', severity: 'critical' }),
      ].map(lookOf),
    ).toEqual(['alarm', 'caution', 'good', 'quiet']);
  });
  it('of a lost link say that it is lost, and why', async () => {
    server.routes[CURRENT] = {
      json: {
        alarms: [
          an({
            name: 'x_band',
            kind: 'link',
            severity: 'distress',
            worst: 'distress',
            reason: 'unexplained: nothing is predicted to silence it now',
          }),
        ],
      },
    };
    await refreshAlarms();
    const page = document.createElement('main');
    await settled(() => render(<Alarms />, page));
    const row = page.querySelector('[data-alarm=x_band]');
    expect(row?.textContent).toContain('lost');
    expect(row?.textContent).toContain('unexplained');
    expect(listed.value.map(lookOf)).toEqual(['alarm']);
  });
  it('offer what can be done about each', () => {
    expect(
      [
        an({}),
        an({ state: 'acknowledged', acknowledged: true }),
        an({ state: 'shelved' }),
        an({ state: 'latched', severity: 'none', latches: true }),
      ].map(actionsOn),
    ).toEqual([['acknowledge', 'shelve'], ['shelve'], ['unshelve'], ['acknowledge', 'shelve', 'reset']]);
  });
  it('call once for what is new or has grown worse, and never again for the same', () => {
    const [one, worse] = [an({}), an({ worst: 'critical' })];
    expect(newAmong([], [one])).toEqual([one]);
    expect(newAmong([one], [one])).toEqual([]);
    expect(newAmong([one], [worse])).toEqual([worse]);
    expect(newAmong([], [an({ state: 'shelved' })])).toEqual([]);
  });
  it('are acted upon once, with the note, and are then what the server says', async () => {
    server.routes[CURRENT] = { json: { alarms: [an({})] } };
    await refreshAlarms();
    expect(toAcknowledge.value).toHaveLength(1);
    server.routes['POST /runs/1/alarms'] = { json: {} };
    server.routes[CURRENT] = { json: { alarms: [an({ state: 'shelved' })] } };
    note.value = ' seen ';
    await Promise.all([act('altitude_m', 'shelve'), act('altitude_m', 'shelve')]);
    expect(server.asked.filter((each) => each.method === 'POST').map((each) => each.body)).toEqual([
      { channel: 'altitude_m', action: 'shelve', shelve_s: 300, note: 'seen', by: '' },
    ]);
    expect([listed.value[0]?.state, toAcknowledge.value.length, note.value]).toEqual(['shelved', 0, '']);
  });
  it('that could not be acted upon say why, and keep the note', async () => {
    server.routes['POST /runs/1/alarms'] = { status: 403, json: { error: 'observers may not' } };
    note.value = 'mine';
    await act('altitude_m', 'acknowledge');
    expect([problem.value, note.value]).toEqual(['altitude_m was not acknowledged: observers may not', 'mine']);
    server.routes['POST /runs/1/alarms'] = { status: 0 };
    await act('altitude_m', 'acknowledge');
    expect(problem.value).toContain('whether it was taken is not known');
  });
  it('of links and of silence count in the header as long as they stand, acknowledged or not; what the stream told of limits, until the list is here', () => {
    const page = document.createElement('main');
    const count = () => {
      settled(() => render(<Header />, page));
      return page.querySelector('[data-testid=alarm-count]')?.textContent?.trim();
    };
    useForTest(aStore([alarm({ channel: 3, severity: 'warning' })]), aDictionary);
    expect(count()).toBe('▲ 1 alarm: warning');
    const standing = [
      an({ name: 'x_band', kind: 'link', severity: 'distress', worst: 'distress' }),
      an({ name: 'Status', kind: 'staleness', severity: 'watch', worst: 'watch' }),
    ];
    const over = [
      an({ name: 'a', state: 'returned', severity: 'none', acknowledged: true }),
      an({ name: 'b', state: 'shelved' }),
    ];
    alarms.value = { run: 1, all: [...standing, ...over] };
    expect(count()).toBe('⬢ 2 alarms: distress, watch2 to acknowledge a');
    alarms.value = {
      run: 1,
      all: [...standing.map((each) => ({ ...each, state: 'acknowledged', acknowledged: true })), ...over],
    };
    expect(count()).toBe('⬢ 2 alarms: distress, watch');
    alarms.value = { run: 1, all: over };
    expect(count()).toBeUndefined();
  });
  it('that could not be asked for are asked for again, and what was known stays', async () => {
    const known = { run: 1, all: [an({})] };
    alarms.value = known;
    await refreshAlarms();
    await refreshAlarms();
    expect([alarms.value, server.asked.length]).toEqual([known, 2]);
  });
});

describe('the panel', () => {
  const shown = () => {
    const root = document.createElement('div');
    settled(() => render(<Alarms />, root));
    return root;
  };
  it('shows names with markup as text, and buttons that name their alarm', () => {
    alarms.value = { run: 1, all: [an({ name: '<i>x</i>', limit: '> 1' })] };
    expect(shown().querySelector('td i')).toBeNull();
    expect(shown().querySelector('[aria-label="acknowledge <i>x</i>"]')).not.toBeNull();
  });
  it('acknowledges all that it shows, each with the note, and ends with the first that is refused', async () => {
    const all = [an({ name: 'a' }), an({ name: 'b' }), an({ name: 'c', acknowledged: true }), an({ name: 'd' })];
    server.routes[CURRENT] = { json: { alarms: all } };
    await refreshAlarms();
    let times = 0;
    server.routes['POST /runs/1/alarms'] = () =>
      ++times < 3 ? { json: {} } : { status: 409, json: { error: 'no such alarm any more' } };
    note.value = 'seen';
    await acknowledgeAll();
    const sent = server.asked.filter(({ method }) => method === 'POST').map(({ body }) => body);
    expect(sent).toMatchObject(['a', 'b', 'd'].map((channel) => ({ channel, action: 'acknowledge', note: 'seen' })));
    expect(problem.value).toMatch(/d was not acknowledged/);
  });
  it('gives observers nothing to press, and shows nothing of now in a view of the past', () => {
    alarms.value = { run: 1, all: [an({})] };
    access.value = { state: 'in', user: 'eve', role: 'observer', rights: [] };
    expect(shown().querySelectorAll('td button')).toHaveLength(0);
    pastRange.value = { from: -100, to: 0 };
    expect(shown().textContent).toMatch(/not shown in a view of the past/);
    pastRange.value = undefined;
  });
});
