// SPDX-License-Identifier: Apache-2.0
// What is known of the vehicle at an instant: what it looks like, how it lies and moves. Pure; from what was received.
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import { staleWords } from '../channels/model';
import { LAYOUT } from '../layout';
import type { Dictionary } from '../run/dictionary';
import { inWords } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { fromEntry } from '../run/time';
import { heardOf } from '../timeline/heard';
import { VEHICLE } from './layout';
import type { Happening, Telling } from './layout';
import { attitudeInPicture, liftDirection, overGround, placeOf, toPicture } from './vectors';
import type { Quaternion, Vector } from './vectors';

/** What is looked at: a run as of an instant, with the words to read it. */
export interface Look {
  run: RunStore;
  words: Dictionary;
  plan: readonly TimepointRow[];
  cutoff: number;
  lost: boolean;
}

/** `contradicted`: one channel tells that it happened, a newer one that it did not. Then it is not known. */
export interface Known {
  state: 'yes' | 'no' | 'unknown' | 'contradicted';
  why: string;
}

// chosen: a flag is told each second, and each telling takes its own way; sooner than this they may well differ
const AGREE_WITHIN_S = 3;

interface Told {
  yes: boolean;
  sclk: number;
  words: string;
}

export function sampleOf({ run, words, cutoff }: Look, names: readonly string[]) {
  const channel = words.pick(names);
  const sample = channel && run.latest(channel.id, cutoff);
  return sample && Number.isFinite(sample.value) ? { ...sample, channel } : undefined;
}

export const newestOf = (look: Look, names: readonly string[]): number | undefined => sampleOf(look, names)?.value;

function tellings(look: Look, { flag, pyros = [], timepoint, verified = false }: Telling): Told[] {
  const { run, words, plan, cutoff } = look;
  const told: Told[] = [];
  const at = (sclk: number) => fromEntry(sclk - run.entrySclk, { tenths: true });
  const flagged = flag === undefined ? undefined : sampleOf(look, [flag]);
  if (flag !== undefined && flagged)
    told.push({
      yes: flagged.value !== 0,
      sclk: flagged.sclk,
      words: `${flag} is ${flagged.value} at ${at(flagged.sclk)}`,
    });
  for (const name of pyros) {
    const sample = sampleOf(look, [name]);
    const label = sample && words.label(sample.channel, sample.value);
    if (!sample || label === undefined) continue;
    const yes = label === VEHICLE.fired;
    if (yes || (VEHICLE.notFired as readonly string[]).includes(label))
      told.push({ yes, sclk: sample.sclk, words: `${name} is ${inWords(label)} at ${at(sample.sclk)}` });
  }
  const row = plan.find((each) => each.name === timepoint);
  const heard = row && heardOf(run, plan, cutoff).get(row.id);
  if (heard && (verified ? heard.verdict === 'verified' : heard.verdict !== 'refused'))
    told.push({
      yes: true,
      sclk: heard.fired_sclk,
      words: `timepoint ${row.name} ${heard.by === 'tone' ? 'by tone' : 'fired'} at ${at(heard.fired_sclk)}`,
    });
  return told;
}

/** Whether something has happened, by everything that can tell of it. */
export function happened(look: Look, which: Happening): Known {
  const told = tellings(look, VEHICLE.happenings[which]);
  const yes = told.filter((each) => each.yes).sort((a, b) => a.sclk - b.sclk);
  const first = yes[0];
  const no = told.filter((each) => !each.yes).sort((a, b) => b.sclk - a.sclk)[0];
  if (!first) return no ? { state: 'no', why: no.words } : { state: 'unknown', why: 'nothing received tells' };
  if (no && no.sclk > first.sclk + AGREE_WITHIN_S)
    return { state: 'contradicted', why: `${first.words}, but ${no.words}` };
  return { state: 'yes', why: first.words };
}

export type Configuration = Record<Happening, Known>;

export function configurationOf(look: Look): Configuration {
  const all = {} as Configuration;
  for (const which of Object.keys(VEHICLE.happenings) as Happening[]) all[which] = happened(look, which);
  return all;
}

/** A part is there, gone, or it is not known. */
export type Presence = 'there' | 'gone' | 'unknown';
export interface Parts {
  cruiseStage: Presence;
  cruiseMasses: readonly Presence[];
  entryMasses: readonly Presence[];
  parachute: Presence;
  heatshield: Presence;
  backshell: Presence;
  descentStage: Presence;
  rover: Presence;
}

const until = ({ state }: Known): Presence => (state === 'no' ? 'there' : state === 'yes' ? 'gone' : 'unknown');
/** Present from `from` until `to`. */
function between(from: Known, to: Known): Presence {
  if (from.state === 'no' || to.state === 'yes') return 'gone';
  return from.state === 'yes' && to.state === 'no' ? 'there' : 'unknown';
}

/** The parts of the vehicle by what has happened to it. What sits on a part goes with it. */
export function partsOf(of: Configuration): Parts {
  const backshell = until(of.backshellGone);
  const on = (carrier: Presence, part: Presence): Presence =>
    carrier === 'there' ? part : carrier === 'gone' ? 'gone' : part === 'gone' ? 'gone' : 'unknown';
  return {
    cruiseStage: until(of.cruiseStageGone),
    cruiseMasses: [of.cruiseMass1Gone, of.cruiseMass2Gone].map((each) => on(backshell, until(each))),
    entryMasses: [of.entryMasses1Gone, of.entryMasses2Gone, of.entryMasses3Gone].map((each) =>
      on(backshell, until(each)),
    ),
    parachute: between(of.parachuteOut, of.backshellGone),
    heatshield: until(of.heatshieldGone),
    backshell,
    // it flies away and falls, and never ceases to be the vehicle that is told of
    descentStage: Object.values(of).every(({ state }) => state === 'unknown') ? 'unknown' : 'there',
    rover: until(of.bridleGone),
  };
}

/** The configuration in words, and the facts that are not known or contradict each other. */
export function configurationWords(of: Configuration): { words: string; doubts: string[] } {
  const parts = partsOf(of);
  const doubts = (Object.keys(of) as Happening[]).flatMap((which) =>
    of[which].state === 'contradicted' ? [`${happeningWords(which)}: contradicted, ${of[which].why}`] : [],
  );
  const is = (which: Happening) => of[which].state === 'yes';
  const names = [
    ...(parts.cruiseStage === 'there' ? ['cruise stage'] : []),
    ...(parts.parachute === 'there' ? ['parachute'] : []),
    ...(parts.backshell === 'there' ? ['backshell'] : []),
    ...(parts.heatshield === 'there' && parts.backshell === 'there' ? ['heatshield'] : []),
  ];
  if (parts.descentStage === 'unknown') return { words: 'not received yet', doubts };
  if (is('bridleGone')) return { words: 'descent stage alone; the rover is on its own', doubts };
  if (is('roverSeparated')) return { words: 'descent stage, the rover below it on its bridle', doubts };
  if (is('backshellGone')) return { words: 'descent stage with the rover', doubts };
  const unknown = Object.entries(parts).flatMap(([name, part]) =>
    part === 'unknown' ? [name.replace(/[A-Z]/g, (capital) => ` ${capital.toLowerCase()}`)] : [],
  );
  return {
    words: `${names.length > 0 ? names.join(', ') : 'what is left of it'}${unknown.length > 0 ? `; not known: ${unknown.join(', ')}` : ''}`,
    doubts,
  };
}

/** "heatshieldGone" → "heatshield gone". */
export const happeningWords = (which: Happening): string =>
  which.replace(/[A-Z]|\d+/g, (part) => ` ${part.toLowerCase()}`);

/** How the vehicle lies and moves, in the picture's frame. */
export interface Motion {
  attitude: Quaternion | undefined;
  velocity: Vector | undefined;
  lift: Vector | undefined;
  altitude_m: number | undefined;
  speed_mps: number | undefined;
  bank_deg: number | undefined;
  /** East and north of the target, or of the first known place. */
  over: { east_m: number; north_m: number } | undefined;
  /** SCLK of the sample of attitude. */
  sclk: number | undefined;
}

// chosen: the parts of a thinned history need not be of one instant; apart by more, or with another norm, they are
// not one attitude
const TOGETHER_S = 0.6;
const NORM_OFF = 0.1;

/** Several channels as one quantity: their newest values, if those are of one instant. */
function together(look: Look, names: readonly string[]): { values: number[]; sclk: number } | undefined {
  const samples = names.map((name) => sampleOf(look, [name]));
  const times = samples.map((sample) => sample?.sclk ?? NaN);
  const [first, last] = [Math.min(...times), Math.max(...times)];
  if (!(last - first <= TOGETHER_S)) return undefined;
  return { values: samples.map((sample) => sample?.value ?? NaN), sclk: last };
}

export function positionOf(look: Look): Vector | undefined {
  const found = together(look, VEHICLE.position);
  return found && (found.values as unknown as Vector);
}

/** The target by the ground's solution, from Mars's centre. */
export function targetOf(run: RunStore): Vector | undefined {
  const { latitude_deg, longitude_deg, radius_m } = LAYOUT.landing.target;
  const [latitude, longitude, radius] = [latitude_deg, longitude_deg, radius_m].map(
    (name) => run.run.solution.find((each) => each.name === name)?.value,
  );
  return latitude === undefined || longitude === undefined || radius === undefined
    ? undefined
    : placeOf(latitude, longitude, radius);
}

export function motionOf(look: Look): Motion {
  const [position, velocity, attitude] = [VEHICLE.position, VEHICLE.velocity, VEHICLE.attitude].map((names) =>
    together(look, names),
  );
  const p_M = position?.values as unknown as Vector | undefined;
  const q = attitude?.values as unknown as Quaternion | undefined;
  const norm = q ? Math.hypot(...q) : 0;
  const bank_deg = newestOf(look, VEHICLE.bank);
  const v_S = p_M && velocity ? toPicture(velocity.values as unknown as Vector, p_M) : undefined;
  const target = targetOf(look.run) ?? p_M;
  return {
    attitude:
      p_M && q && Math.abs(norm - 1) < NORM_OFF
        ? attitudeInPicture(q.map((each) => each / norm) as unknown as Quaternion, p_M)
        : undefined,
    velocity: v_S,
    lift: v_S && bank_deg !== undefined ? liftDirection(v_S, bank_deg) : undefined,
    altitude_m: newestOf(look, LAYOUT.altitude),
    speed_mps: newestOf(look, LAYOUT.speed),
    bank_deg,
    over: p_M && target && overGround(p_M, target),
    sclk: attitude?.sclk,
  };
}

/** The age of what the picture shows, if that is stale. */
export function staleOf({ run, words, cutoff, lost }: Look): string | undefined {
  const of = (names: readonly string[]) => staleWords(run, words.pick(names), cutoff, lost);
  return of(VEHICLE.attitude) ?? of(LAYOUT.altitude) ?? of(LAYOUT.speed);
}

/** Throttles, 0 … 1, one for each engine; undefined: not received, or the engines are not the vehicle's yet. */
export function throttlesOf(look: Look, of: Configuration): number[] | undefined {
  if (of.enginesOff.state === 'yes') return VEHICLE.throttles.map(() => 0);
  if (of.backshellGone.state !== 'yes') return undefined;
  const found = together(look, VEHICLE.throttles);
  return found?.values.map((each) => Math.max(0, Math.min(1, each / 100)));
}

/** What to look at, in order of the landing. */
export type Scenery = 'cruise' | 'entry' | 'parachute' | 'descent' | 'crane';
export function sceneryOf(of: Configuration): Scenery {
  if (of.roverSeparated.state === 'yes') return of.bridleGone.state === 'yes' ? 'descent' : 'crane';
  if (of.backshellGone.state === 'yes') return 'descent';
  if (of.parachuteOut.state === 'yes') return 'parachute';
  return of.cruiseStageGone.state === 'yes' ? 'entry' : 'cruise';
}

/** All that a picture is drawn from: numbers and words, so that a worker can have it. */
export interface Scene {
  parts: Parts;
  scenery: Scenery;
  motion: Motion;
  throttles: number[] | undefined;
  bridle_m: number | undefined;
  /** Direction of the approach from north to east, in radians: the picture looks across it. */
  heading: number;
  stale: boolean;
}

const LEAST_ACROSS_MPS = 50; // chosen: slower, the direction of motion is no direction of approach

/** The direction from the first known place to the present one; by the velocity where they are one. */
export function headingOf(look: Look, motion: Motion): number {
  const first = firstPlace(look);
  const now = positionOf(look);
  if (first && now) {
    const back = overGround(first, now);
    if (Math.hypot(back.east_m, back.north_m) > 1000) return Math.atan2(-back.east_m, -back.north_m);
  }
  const [east = 0, , south = 0] = motion.velocity ?? [];
  return Math.hypot(east, south) >= LEAST_ACROSS_MPS ? Math.atan2(east, -south) : Math.PI / 2;
}

function firstPlace({ run, words }: Look): Vector | undefined {
  const parts = VEHICLE.position.map((name) => {
    const channel = words.pick([name]);
    const all = channel ? [run.live.get(channel.id), run.recorded.get(channel.id)] : [];
    const oldest = all
      .filter((each) => each && each.length > 0)
      .sort((a, b) => (a?.sclk[0] ?? 0) - (b?.sclk[0] ?? 0))[0];
    return oldest?.value[0] ?? NaN;
  });
  return parts.every(Number.isFinite) ? (parts as unknown as Vector) : undefined;
}

export function sceneOf(look: Look): Scene {
  const of = configurationOf(look);
  const motion = motionOf(look);
  return {
    parts: partsOf(of),
    scenery: sceneryOf(of),
    motion,
    throttles: throttlesOf(look, of),
    bridle_m: of.roverSeparated.state === 'yes' ? newestOf(look, VEHICLE.bridle) : 0,
    heading: headingOf(look, motion),
    stale: staleOf(look) !== undefined,
  };
}

/** What is missing for a picture, in words; empty: nothing. */
export function missingOf({ parts, motion, bridle_m }: Scene): string[] {
  return [
    ...(parts.descentStage === 'unknown' ? ['configuration not received yet'] : []),
    ...(motion.attitude ? [] : ['attitude not received yet: drawn upright and hollow']),
    ...(motion.altitude_m === undefined ? ['altitude not received yet: no ground is drawn'] : []),
    ...(motion.velocity ? [] : ['velocity not received yet']),
    ...(bridle_m === undefined ? ['bridle not received: the rover is not drawn'] : []),
  ];
}

const MOST_POINTS = 300; // chosen: a point every few pixels

/** The path over ground, east and north of the target in metres, oldest first. */
export function pathOf(look: Look): { east_m: number; north_m: number; recorded: boolean }[] {
  const { run, words, cutoff } = look;
  const target = targetOf(run) ?? positionOf(look);
  const channels = VEHICLE.position.map((name) => words.pick([name])?.id);
  if (!target || channels.some((id) => id === undefined)) return [];
  const points: { sclk: number; east_m: number; north_m: number; recorded: boolean }[] = [];
  for (const [recorded, series] of [
    [false, run.live],
    [true, run.recorded],
  ] as const) {
    const [x, y, z] = channels.map((id) => series.get(id as number));
    if (!x || !y || !z) continue;
    const end = x.firstAfter(cutoff);
    const stride = Math.max(1, Math.ceil(end / MOST_POINTS));
    for (let i = (end - 1) % stride; i >= 0 && i < end; i += stride) {
      const sclk = x.sclk[i] as number;
      const [by, bz] = [y.at(sclk), z.at(sclk)];
      if (by?.sclk !== sclk || bz?.sclk !== sclk) continue; // thinned: not one place
      points.push({ sclk, recorded, ...overGround([x.value[i] as number, by.value, bz.value], target) });
    }
  }
  return points.sort((a, b) => a.sclk - b.sclk);
}
