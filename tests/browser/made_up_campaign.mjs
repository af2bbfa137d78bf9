// SPDX-License-Identifier: Apache-2.0
// A campaign computed from its case numbers, in place of the server's, so that its picture is always the same.
const CASES = 240;

const touchdowns = Array.from({ length: CASES }, (_, i) => {
  const place = i + 1;
  const away = 1 + (place % 13) / 4;
  const row = {
    place,
    case: place,
    outcome: 'touchdown',
    east_m: 1500 * away * Math.sin(7 * place) + 300,
    north_m: 700 * away * Math.cos(3 * place) - 200,
  };
  if (place === 50) return { place, case: place, outcome: 'lost' };
  return place % 100 === 0 ? { ...row, outcome: 'impact', east_m: row.east_m * 1.6 } : row;
});
const spread = (p50, sigma) => ({
  count: CASES - 3,
  min: p50 - 3 * sigma,
  p1: p50 - 2.3 * sigma,
  p50,
  p99: p50 + 2.3 * sigma,
  max: p50 + 3 * sigma,
  mean: p50,
  sigma,
});
const state = {
  campaign: 'campaign-1',
  scenario: 'campaign',
  seed: '1',
  cases: 400,
  kept: CASES,
  state: 'flying',
  jobs: 1,
  rate_per_s: 1.25,
  remaining_s: 128,
  fault: '',
};
const report = {
  state,
  failed: 3,
  recontacts: 1,
  outcomes: [
    { outcome: 'touchdown', count: CASES - 3 },
    { outcome: 'impact', count: 2 },
    { outcome: 'lost', count: 1 },
  ],
  miss_m: spread(2900, 800),
  vertical_mps: spread(0.75, 0.01),
  horizontal_mps: spread(0.1, 0.03),
  propellant_kg: spread(41, 6),
  parachute_mach: spread(1.75, 0.05),
  parachute_pressure_Pa: spread(520, 40),
  peak_deceleration_mps2: spread(118, 4),
  margins: [],
  ellipse: { east_m: 300, north_m: -200, major_m: 13400, minor_m: 6200, azimuth_deg: 98 },
  least_margin: { margin_s: 0.484, timepoint: 'powered_approach', case: 17 },
  failures: [
    { case: 50, outcome: 'lost', reason: 'the simulation ended: a quaternion has no length' },
    { case: 100, outcome: 'impact', reason: 'touched the ground at 31.2 m/s' },
    { case: 200, outcome: 'impact', reason: 'touched the ground at 44.9 m/s' },
  ],
  outside_limits: 0,
  outside: [],
};
const former = {
  ...state,
  campaign: 'gnc_alone-7',
  scenario: 'gnc_alone',
  seed: '7',
  cases: 1000,
  kept: 311,
  state: 'incomplete',
  jobs: 0,
  rate_per_s: 0,
  remaining_s: undefined,
};
const unreadable = {
  ...former,
  campaign: 'campaign-3',
  state: 'unreadable',
  fault: 'run-data/campaign-campaign-3.db: schema_version: 3 there, 4 here',
};

/** Makes the page see this campaign from now on. */
export async function madeUpCampaign(page) {
  await page.route(/\/api\/v1\/campaigns/, (route) => {
    const { pathname, searchParams } = new URL(route.request().url());
    if (pathname.endsWith('/touchdowns'))
      return route.fulfill({
        json: {
          touchdowns: touchdowns.filter(({ place }) => place > Number(searchParams.get('after'))),
          next_after: CASES,
        },
      });
    return route.fulfill({
      json: pathname.endsWith('/campaigns')
        ? { campaigns: [state, former, unreadable], cases_max: 10000, jobs_max: 2 }
        : report,
    });
  });
}
