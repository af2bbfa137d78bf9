// SPDX-License-Identifier: Apache-2.0
// Campaigns: dispersed landings that the server flies in the background, and their results. They are statistics of
// rehearsals; nothing here is telemetry of the vehicle.
import { signal } from '@preact/signals';
import { call, wordsFor } from '../run/api';
import { readAll } from '../run/pages';

export interface CampaignState {
  campaign: string;
  scenario: string;
  seed: string;
  cases: number;
  kept: number;
  state: 'preparing' | 'flying' | 'cancelling' | 'complete' | 'incomplete' | 'unreadable';
  jobs: number;
  rate_per_s: number;
  remaining_s?: number;
  fault: string;
}
interface Spread {
  count: number;
  min: number;
  p1: number;
  p50: number;
  p99: number;
  max: number;
  mean: number;
  sigma: number;
}
interface Ellipse {
  east_m: number;
  north_m: number;
  major_m: number; // full axes
  minor_m: number;
  azimuth_deg: number; // of the major axis, from north to east
}
export interface CampaignReport {
  state: CampaignState;
  outcomes: { outcome: string; count: number }[];
  miss_m?: Spread;
  vertical_mps?: Spread;
  horizontal_mps?: Spread;
  propellant_kg?: Spread;
  ellipse?: Ellipse;
  parachute_mach?: Spread;
  parachute_pressure_Pa?: Spread;
  peak_deceleration_mps2?: Spread;
  least_margin?: { margin_s: number; timepoint: string; case: number };
  recontacts: number;
  failed: number;
  failures: Failure[];
  outside_limits: number; // landed, and not within the scenario's limits
  outside: Failure[];
}
export interface Failure {
  case: number;
  outcome: string;
  reason: string;
}
export interface Touchdown {
  place: number; // position in the order of completion
  case: number;
  outcome: string;
  east_m?: number; // east of the target; undefined: it did not touch down
  north_m?: number;
}

export const campaigns = signal<CampaignState[]>([]);
export const limits = signal({ cases_max: 10_000, jobs_max: 1 });
/** The selected campaign. */
export const chosen = signal<string | undefined>(undefined);
export const report = signal<CampaignReport | undefined>(undefined);
/** Touchdowns of the selected campaign, in the order of arrival. */
export const touchdowns = signal<readonly Touchdown[]>([]);
/** The number of the case whose landing is looked at. */
export const openedCase = signal<number | undefined>(undefined);
export const message = signal<{ good: boolean; text: string } | undefined>(undefined);
export const busy = signal(false);

/** Whether a campaign flies or is being cancelled. No other can start until its cases have ended. */
export const flies = (state: CampaignState | undefined): boolean =>
  state !== undefined && ['preparing', 'flying', 'cancelling'].includes(state.state);
export const flyingNow = (): CampaignState | undefined => campaigns.value.find(flies);
const at = (campaign: string) => `/campaigns/${encodeURIComponent(campaign)}`;

export function choose(campaign: string | undefined): void {
  if (chosen.value === campaign) return;
  chosen.value = campaign;
  report.value = undefined;
  touchdowns.value = [];
  openedCase.value = undefined;
}

let under: Promise<void> | undefined;

type Campaigns = { campaigns: CampaignState[]; cases_max: number; jobs_max: number };

/** Asks for the list and for news of the selected campaign; one request at a time. */
export function look(): Promise<void> {
  under ??= lookNow().finally(() => (under = undefined));
  return under;
}

async function lookNow(): Promise<void> {
  try {
    const list = await readAll<Campaigns, 'campaigns'>('/campaigns', 'campaigns');
    campaigns.value = list.campaigns;
    limits.value = { cases_max: list.cases_max, jobs_max: list.jobs_max };
    if (!campaigns.value.some((each) => each.campaign === chosen.value)) choose(undefined);
    choose(chosen.value ?? (flyingNow() ?? campaigns.value.find((each) => each.state !== 'unreadable'))?.campaign);
    await lookAtChosen();
    if (message.value?.text.startsWith(NO_LOOK)) message.value = undefined;
    sayHowItEnded();
  } catch (error) {
    message.value = { good: false, text: `${NO_LOOK}${wordsFor(error)}` };
  }
}
const NO_LOOK = 'campaigns cannot be read now: ';

let cancelledHere: string | undefined; // the campaign cancelled on this page, whose end is reported here

function sayHowItEnded(): void {
  const state = campaigns.value.find((each) => each.campaign === cancelledHere);
  if (flies(state)) return;
  cancelledHere = undefined;
  if (state) message.value = { good: state.fault === '', text: endWords(state) };
}

async function lookAtChosen(): Promise<void> {
  const campaign = chosen.value;
  const state = campaigns.value.find((each) => each.campaign === campaign);
  if (campaign === undefined || !state || state.state === 'unreadable') return;
  const shown = report.value?.state;
  const news = !shown || shown.kept !== state.kept || shown.cases !== state.cases || shown.state !== state.state;
  if (!news && !flies(state)) return;
  const found = await call<CampaignReport>('GET', at(campaign));
  // Fewer than shown: another file has taken its name, or fewer cases were requested.
  const before = touchdowns.value.length > found.state.kept ? [] : touchdowns.value;
  const page = await call<{ touchdowns?: Touchdown[] }>(
    'GET',
    `${at(campaign)}/touchdowns?after=${before.at(-1)?.place ?? 0}`,
  );
  if (chosen.value !== campaign) return;
  report.value = found;
  if (before !== touchdowns.value || (page.touchdowns ?? []).length > 0)
    touchdowns.value = [...before, ...(page.touchdowns ?? [])];
}

async function act(what: () => Promise<string>): Promise<void> {
  if (busy.value) return;
  busy.value = true;
  message.value = undefined;
  try {
    message.value = { good: true, text: await what() };
    await under;
    await look();
  } catch (error) {
    message.value = { good: false, text: wordsFor(error) };
  } finally {
    busy.value = false;
  }
}

export const start = (scenario: string, cases: number, seed: string): Promise<void> =>
  act(async () => {
    const state = await call<CampaignState>('POST', '/campaigns', { scenario, cases, seed });
    choose(state.campaign);
    return state.kept > 0
      ? `${state.campaign} goes on; ${state.kept} cases had been kept`
      : `${state.campaign} has begun`;
  });
export const cancel = (campaign: string): Promise<void> =>
  act(async () => {
    const state = await call<CampaignState>('POST', `${at(campaign)}/cancel`);
    campaigns.value = campaigns.value.map((each) => (each.campaign === campaign ? state : each));
    cancelledHere = campaign;
    return `${campaign} is being cancelled`;
  });

/** What is wrong with the typed form; undefined: nothing. */
export function orderProblem(cases: string, seed: string, cases_max: number): string | undefined {
  if (!/^\d{1,9}$/.test(cases) || Number(cases) < 1 || Number(cases) > cases_max)
    return `cases: a whole number from 1 to ${cases_max}`;
  if (!/^\d{1,18}$/.test(seed)) return 'a seed is a whole number';
  return undefined;
}

/** "1 h 4 min", "3 min 20 s", "8 s". */
export function lengthWords(seconds: number): string {
  const whole = Math.round(seconds);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  if (hours > 0) return `${hours} h ${minutes} min`;
  return minutes > 0 ? `${minutes} min ${whole % 60} s` : `${whole} s`;
}

export function stateWords(state: CampaignState): string {
  const kept = `${state.kept} of ${state.cases} cases`;
  if (state.fault !== '') return `✖ ${state.state === 'unreadable' ? '' : `${kept}; it ended: `}${state.fault}`;
  switch (state.state) {
    case 'preparing':
      return `… ${kept}; what all cases have in common is flown, up to where the errors are drawn`;
    case 'flying': {
      const rate = state.rate_per_s > 0 ? `, ${state.rate_per_s.toFixed(2)} a second` : '';
      const remains = state.remaining_s === undefined ? '' : `, ${lengthWords(state.remaining_s)} remain`;
      return `▶ ${kept}${rate}${remains}`;
    }
    case 'cancelling':
      return `◌ cancelling, ${kept} so far; it is over once those that fly now have ended`;
    case 'complete':
      return `✓ all ${state.cases} cases are kept`;
    default:
      return `▲ ${kept}: not complete; starting it again goes on`;
  }
}

/** Result of a cancelled campaign, in words. */
export function endWords({ campaign, kept, cases, state, fault }: CampaignState): string {
  if (fault !== '') return `${campaign} ended: ${fault}; ${kept} of its cases are kept`;
  if (state === 'complete') return `too late to cancel: all ${cases} cases of ${campaign} had been flown, and are kept`;
  return `cancelled: ${kept} cases of ${campaign} are kept; starting it again goes on with them`;
}

const STANDARD_GRAVITY_MPS2 = 9.80665;
const SPREADS = [
  ['miss distance', 'km', 'miss_m', 1e-3, 2],
  ['touchdown, vertical', 'm/s', 'vertical_mps', 1, 3],
  ['touchdown, horizontal', 'm/s', 'horizontal_mps', 1, 3],
  ['parachute', 'Mach', 'parachute_mach', 1, 3],
  ['parachute, dynamic pressure', 'Pa', 'parachute_pressure_Pa', 1, 0],
  ['peak deceleration', 'g', 'peak_deceleration_mps2', 1 / STANDARD_GRAVITY_MPS2, 2],
  ['propellant left', 'kg', 'propellant_kg', 1, 1],
] as const;

interface SpreadRow {
  name: string;
  unit: string;
  numbers: string[]; // least, 1 %, 50 %, 99 %, largest, mean, sigma
  count: number;
}

export function spreadRows(of: CampaignReport): SpreadRow[] {
  return SPREADS.flatMap(([name, unit, field, factor, digits]) => {
    const spread = of[field];
    if (!spread || spread.count === 0) return [];
    const numbers = [spread.min, spread.p1, spread.p50, spread.p99, spread.max, spread.mean, spread.sigma].map(
      (value) => (value * factor).toFixed(digits),
    );
    return [{ name, unit, numbers, count: spread.count }];
  });
}

export function ellipseWords({ major_m, minor_m, azimuth_deg, east_m, north_m }: Ellipse): string {
  const km = (metres: number) => (Math.abs(metres) / 1000).toFixed(2);
  return `${km(major_m)} × ${km(minor_m)} km, major axis at azimuth ${azimuth_deg.toFixed(0)}°, its centre ${km(east_m)} km ${east_m < 0 ? 'west' : 'east'} and ${km(north_m)} km ${north_m < 0 ? 'south' : 'north'} of the target`;
}

/** Half-width of the picture about the target, km east and north. It grows in steps until all touchdowns fit. */
export function reach_km(points: readonly Touchdown[], ellipse: Ellipse | undefined): { east: number; north: number } {
  let [east, north] = [0, 0];
  for (const { east_m, north_m } of points) {
    if (east_m === undefined || north_m === undefined) continue;
    east = Math.max(east, Math.abs(east_m));
    north = Math.max(north, Math.abs(north_m));
  }
  if (ellipse) {
    const azimuth = (ellipse.azimuth_deg * Math.PI) / 180;
    const half = (along: number, across: number) =>
      Math.hypot((ellipse.major_m / 2) * along, (ellipse.minor_m / 2) * across);
    east = Math.max(east, Math.abs(ellipse.east_m) + half(Math.sin(azimuth), Math.cos(azimuth)));
    north = Math.max(north, Math.abs(ellipse.north_m) + half(Math.cos(azimuth), Math.sin(azimuth)));
  }
  const step = (metres: number) => Math.max(2, Math.ceil((metres * 1.08) / 2000) * 2);
  return { east: step(east), north: step(north) };
}

/** What is known of a case, and how to fly it alone. */
export function caseWords(point: Touchdown, state: CampaignState): { words: string; command: string } {
  const { east_m, north_m } = point;
  const km = (value: number) => (Math.abs(value) / 1000).toFixed(2);
  const where =
    east_m === undefined || north_m === undefined
      ? 'its place is not known'
      : `${km(east_m)} km ${east_m < 0 ? 'west' : 'east'} and ${km(north_m)} km ${north_m < 0 ? 'south' : 'north'} of the target, ${km(Math.hypot(east_m, north_m))} km from it`;
  return {
    words: `Case ${point.case}: ${point.outcome.replace('_', ' ')}, ${where}.`,
    command: `aeolis rehearse --scenario ${state.scenario} --seed ${state.seed} --case ${point.case}`,
  };
}
