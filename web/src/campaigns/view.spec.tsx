// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { aServer } from '../testing/server';
import {
  campaigns,
  cancel,
  choose,
  openedCase,
  chosen,
  ellipseWords,
  endWords,
  flies,
  lengthWords,
  look,
  message,
  orderProblem,
  reach_km,
  report,
  spreadRows,
  start,
  stateWords,
  touchdowns,
} from './model';
import type { CampaignReport, CampaignState, Touchdown } from './model';
import { Campaigns } from './view';

const server = aServer();
const state = (fields: Partial<CampaignState> = {}): CampaignState => ({
  campaign: 'campaign-1',
  scenario: 'campaign',
  seed: '1',
  cases: 10,
  kept: 2,
  state: 'flying',
  jobs: 1,
  rate_per_s: 0.5,
  remaining_s: 16,
  fault: '',
  ...fields,
});
const spread = { count: 2, min: 100, p1: 101, p50: 1500, p99: 2900, max: 3000, mean: 1500, sigma: 1400 };
const aReport = (fields: Partial<CampaignReport> = {}): CampaignReport => ({
  state: state(),
  outcomes: [
    { outcome: 'touchdown', count: 1 },
    { outcome: 'lost', count: 1 },
  ],
  recontacts: 0,
  failed: 1,
  miss_m: spread,
  peak_deceleration_mps2: { ...spread, min: 98.0665 },
  failures: [{ case: 2, outcome: 'lost', reason: '<b>no</b> lift' }],
  outside_limits: 1,
  outside: [{ case: 7, outcome: 'touchdown', reason: 'propellant_left_min_kg 1.2 instead of at least 4' }],
  ...fields,
});
const landed = (place: number, fields: Partial<Touchdown> = {}): Touchdown => ({
  place,
  case: 10 - place,
  outcome: 'touchdown',
  east_m: 1000,
  north_m: -500,
  ...fields,
});

function serves(of: CampaignState[], then: CampaignReport, pages: Record<number, Touchdown[]>): void {
  server.routes['GET /campaigns'] = { json: { campaigns: of, cases_max: 100, jobs_max: 2 } };
  server.routes['GET /campaigns/campaign-1'] = { json: then };
  for (const [after, found] of Object.entries(pages))
    server.routes[`GET /campaigns/campaign-1/touchdowns?after=${after}`] = { json: { touchdowns: found } };
}

beforeEach(() => {
  choose(undefined);
  [campaigns.value, message.value, access.value] = [[], undefined, { state: 'open' }];
});

describe('a campaign', () => {
  it('is looked at from what is already known on, by place and not by case, and not at all once it stands', async () => {
    serves([state()], aReport(), { 0: [landed(1), landed(2)], 2: [landed(3)] });
    await look();
    expect([chosen.value, touchdowns.value.length]).toEqual(['campaign-1', 2]);
    await look();
    expect(touchdowns.value.map((each) => each.case)).toEqual([9, 8, 7]);
    const over = state({ state: 'complete', kept: 10 });
    serves([over], aReport({ state: over }), { 3: [] });
    await look();
    const before = server.asked.length;
    await look();
    expect(server.asked.slice(before).map((each) => each.path)).toEqual(['/campaigns']);
  });
  it('that another file has replaced is drawn anew', async () => {
    serves([state()], aReport(), { 0: [landed(1), landed(2)] });
    await look();
    const fresh = state({ kept: 1 });
    serves([fresh], aReport({ state: fresh }), { 0: [landed(1)] });
    await look();
    expect(touchdowns.value).toHaveLength(1);
  });
  it('is ordered once, by its own numbers, and what is refused says why', async () => {
    serves([state()], aReport(), { 0: [] });
    server.routes['POST /campaigns'] = { json: state({ kept: 0 }) };
    await start('campaign', 10, '1');
    expect(server.asked.filter((each) => each.method === 'POST')).toEqual([
      { method: 'POST', path: '/campaigns', body: { scenario: 'campaign', cases: 10, seed: '1' } },
    ]);
    expect(message.value).toEqual({ good: true, text: 'campaign-1 has begun' });
    server.routes['POST /campaigns/campaign-1/cancel'] = {
      status: 409,
      json: { error: 'the campaign campaign-1 does not fly' },
    };
    await cancel('campaign-1');
    expect(message.value).toEqual({ good: false, text: 'the campaign campaign-1 does not fly' });
  });
  it('that is cancelled is told of twice: that its cases still end, then what is kept', async () => {
    const of = state({ state: 'cancelling', kept: 3 });
    serves([of], aReport({ state: of }), { 0: [landed(1), landed(2), landed(3)], 3: [landed(4)] });
    server.routes['POST /campaigns/campaign-1/cancel'] = { status: 202, json: of };
    await cancel('campaign-1');
    expect(message.value).toEqual({ good: true, text: 'campaign-1 is being cancelled' });
    expect([stateWords(of), flies(of)]).toEqual([
      '◌ cancelling, 3 of 10 cases so far; it is over once those that fly now have ended',
      true,
    ]);
    const over = state({ state: 'incomplete', kept: 4 });
    serves([over], aReport({ state: over }), {});
    await look();
    expect(message.value).toEqual({
      good: true,
      text: 'cancelled: 4 cases of campaign-1 are kept; starting it again goes on with them',
    });
    message.value = undefined;
    await look();
    expect(message.value).toBeUndefined(); // reported once
  });
  it('that ended otherwise than it was cancelled says how', () => {
    expect(endWords(state({ state: 'complete', kept: 10 }))).toBe(
      'too late to cancel: all 10 cases of campaign-1 had been flown, and are kept',
    );
    expect(endWords(state({ state: 'incomplete', fault: 'disk full' }))).toBe(
      'campaign-1 ended: disk full; 2 of its cases are kept',
    );
  });
  it('is refused before it is sent where no server would take it', () => {
    expect(orderProblem('0', '1', 100)).toContain('1 to 100');
    expect(orderProblem('101', '1', 100)).toContain('cases');
    expect(orderProblem('1e2', '1', 100)).toContain('cases');
    expect(orderProblem('10', '-1', 100)).toContain('seed');
    expect(orderProblem('100', '0', 100)).toBeUndefined();
  });
  it('says how far it is in words', () => {
    expect([lengthWords(8.2), lengthWords(200), lengthWords(3840)]).toEqual(['8 s', '3 min 20 s', '1 h 4 min']);
    expect(stateWords(state())).toBe('▶ 2 of 10 cases, 0.50 a second, 16 s remain');
    expect(stateWords(state({ state: 'incomplete' }))).toContain('not complete');
    expect(stateWords(state({ state: 'incomplete', fault: 'disk full' }))).toBe('✖ 2 of 10 cases; it ended: disk full');
    expect(stateWords(state({ state: 'unreadable', fault: 'x.db: no' }))).toBe('✖ x.db: no');
  });
});

describe('its numbers', () => {
  it('have their units, and what no case has is left out', () => {
    expect(spreadRows(aReport()).map((row) => [row.name, row.unit, row.numbers[0], row.count])).toEqual([
      ['miss distance', 'km', '0.10', 2],
      ['peak deceleration', 'g', '10.00', 2],
    ]);
  });
  it('make a picture into which points and ellipse fit, that grows in steps', () => {
    expect(reach_km([], undefined)).toEqual({ east: 2, north: 2 });
    expect(
      reach_km(
        [landed(1, { east_m: -5000 }), landed(2, { east_m: 0, north_m: 2500 }), { place: 3, case: 3, outcome: 'lost' }],
        undefined,
      ),
    ).toEqual({ east: 6, north: 4 });
    const ellipse = { east_m: 1000, north_m: 0, major_m: 20000, minor_m: 6000, azimuth_deg: 90 };
    expect(reach_km([], ellipse)).toEqual({ east: 12, north: 4 });
    expect(ellipseWords(ellipse)).toBe(
      '20.00 × 6.00 km, major axis at azimuth 90°, its centre 1.00 km east and 0.00 km north of the target',
    );
  });
});

describe('the panel', () => {
  const shown = () => {
    const root = document.createElement('div');
    act(() => render(<Campaigns />, root));
    return root;
  };
  it('says that it shows rehearsals, and failures by shape and word, never as markup', () => {
    serves([state()], aReport(), { 0: [] });
    campaigns.value = [state()];
    choose('campaign-1');
    report.value = aReport();
    const root = shown();
    expect(root.textContent).toContain('Statistics of rehearsals');
    expect(root.querySelector('[data-testid="campaign-failures"]')?.textContent).toContain('✖ lost<b>no</b> lift');
    expect(root.querySelector('[data-testid="campaign-outside"]')?.textContent).toContain(
      '7✖ landed outside limitspropellant_left_min_kg 1.2',
    );
    expect(root.querySelector('[data-testid="campaign-cancel"]')?.textContent).toBe('cancel campaign-1');
    expect(root.querySelector<HTMLButtonElement>('[data-testid="campaign-start"]')?.disabled).toBe(true);
  });
  it('opens the case of a dot, in words and with the way to fly it alone', () => {
    serves([state()], aReport(), { 0: [] });
    campaigns.value = [state()];
    choose('campaign-1');
    report.value = aReport();
    touchdowns.value = [{ place: 1, case: 17, outcome: 'touchdown', east_m: -1200, north_m: 500 }];
    openedCase.value = 17;
    const told = () => shown().querySelector('[data-testid="campaign-case-told"]')?.textContent ?? '';
    expect(told()).toContain('Case 17: touchdown, 1.20 km west and 0.50 km north of the target, 1.30 km from it.');
    expect(told()).toContain('aeolis rehearse --scenario campaign --seed 1 --case 17');
    openedCase.value = 18;
    expect(told()).toBe('No case 18 is kept.');
  });
  it('lets nobody cancel twice, nor start while the cases of one that is cancelled end', () => {
    serves([state({ state: 'cancelling' })], aReport(), {});
    campaigns.value = [state({ state: 'cancelling' })];
    choose('campaign-1');
    const root = shown();
    const button = root.querySelector<HTMLButtonElement>('[data-testid="campaign-cancel"]');
    expect([button?.textContent, button?.disabled]).toEqual(['cancelling campaign-1', true]);
    expect(root.querySelector<HTMLButtonElement>('[data-testid="campaign-start"]')?.disabled).toBe(true);
    expect(root.querySelector('[data-testid="campaign-state"]')?.textContent).toContain('cancelling');
  });
  it('lets nobody start who may not, and says why', () => {
    serves([], aReport(), {});
    access.value = { state: 'in', user: 'eve', role: 'observer', rights: ['watch'] };
    const root = shown();
    expect(root.querySelector<HTMLButtonElement>('[data-testid="campaign-start"]')?.disabled).toBe(true);
    expect(root.textContent).toContain('need the right to rehearse; you are eve, observer');
  });
});
