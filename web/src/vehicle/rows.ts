// SPDX-License-Identifier: Apache-2.0
// The facts of the picture as text: what it shows is never only there. Each with the age of an old value.
import { staleWords } from '../channels/model';
import { LAYOUT } from '../layout';
import { isLost } from '../run/connection';
import type { Dictionary } from '../run/dictionary';
import { inWords } from '../run/dictionary';
import { duration, fromEntry } from '../run/time';
import { DUE_S } from '../situation/countdown';
import { heardOf, lastHeard } from '../timeline/heard';
import { isImportant, title } from '../timeline/model';
import { VEHICLE } from './layout';
import { configurationOf, configurationWords, sampleOf, throttlesOf } from './model';
import type { Look } from './model';
import { dot, unit } from './vectors';
import type { Motion } from './model';
import { rotated } from './vectors';

export interface Row {
  name: string;
  text: string;
  /** "◌ 41 s" for a value that is old. */
  age: string | undefined;
}
/** The channel of a row or figure, where it is of one. */
export function channelOf(words: Dictionary, name: string): string | undefined {
  const names: Record<string, readonly string[]> = {
    altitude: LAYOUT.altitude,
    speed: LAYOUT.speed,
    mode: LAYOUT.phase,
    bank: VEHICLE.bank,
    thrust: VEHICLE.thrust,
  };
  return words.pick(names[name] ?? [])?.name;
}
export interface Figure {
  name: string;
  value: string;
  unit: string;
  note: string;
  age: string | undefined;
}

const ageOf = (look: Look, names: readonly string[]) =>
  staleWords(look.run, look.words.pick(names), look.cutoff, look.lost);
const NOT_YET = 'not received yet';
const signed = (value: number, digits: number) => value.toFixed(digits).replace('-', '−');

function labelOf(look: Look, names: readonly string[]): string | undefined {
  const sample = sampleOf(look, names);
  if (!sample) return undefined;
  const label = look.words.label(sample.channel, sample.value);
  return label === undefined ? String(sample.value) : inWords(label);
}

/** The phase, and the mode of guidance while that is told. */
function modeRow(look: Look): Row {
  const [phase, mode] = [labelOf(look, LAYOUT.phase), labelOf(look, VEHICLE.mode)];
  const age = ageOf(look, LAYOUT.phase);
  const isTold = mode !== undefined && ageOf(look, VEHICLE.mode) === undefined;
  return {
    name: 'mode',
    text: phase === undefined ? NOT_YET : isTold && mode !== phase ? `${phase}, ${mode}` : phase,
    age,
  };
}

const DOWN = [0, 0, 1] as const;

/** How the axis of the vehicle leans. Words for a reader who cannot see the picture. */
function attitudeText({ attitude, velocity }: Motion): string {
  if (!attitude) return NOT_YET;
  const axis = rotated(attitude, DOWN);
  const fromDown = (Math.acos(Math.max(-1, Math.min(1, -axis[1]))) * 180) / Math.PI;
  const fromMotion = velocity
    ? (Math.acos(Math.max(-1, Math.min(1, dot(axis, unit(velocity))))) * 180) / Math.PI
    : undefined;
  return `axis ${fromDown.toFixed(0)}° from straight down${fromMotion === undefined ? '' : `, ${fromMotion.toFixed(0)}° from the motion`}`;
}

export function rowsOf(look: Look, motion: Motion): Row[] {
  const of = configurationOf(look);
  const { words, doubts } = configurationWords(of);
  const thrust = sampleOf(look, VEHICLE.thrust);
  const throttles = throttlesOf(look, of);
  const lit = throttles?.filter((each) => each > 0.02) ?? [];
  const mean = lit.reduce((sum, each) => sum + each, 0) / (lit.length || 1);
  const flag = VEHICLE.happenings.cruiseStageGone.flag;
  return [
    modeRow(look),
    { name: 'configuration', text: words, age: ageOf(look, [flag]) },
    ...doubts.map((text) => ({ name: 'contradiction', text: `▲ ${text}`, age: undefined })),
    { name: 'attitude', text: attitudeText(motion), age: ageOf(look, VEHICLE.attitude) },
    {
      name: 'bank',
      text: motion.bank_deg === undefined ? NOT_YET : `${signed(motion.bank_deg, 1)}°, ${sideOf(motion.bank_deg)}`,
      age: ageOf(look, VEHICLE.bank),
    },
    {
      name: 'thrust',
      text:
        of.backshellGone.state === 'no'
          ? 'engines still inside the aeroshell'
          : !thrust
            ? NOT_YET
            : `${(thrust.value / 1000).toFixed(1)} kN${lit.length > 0 ? `, ${lit.length} engines at ${(mean * 100).toFixed(0)} %` : ', no engine runs'}`,
      age: of.backshellGone.state === 'no' ? undefined : ageOf(look, VEHICLE.thrust),
    },
  ];
}

const sideOf = (bank_deg: number): string => {
  const side =
    Math.abs(bank_deg) < 0.5 || Math.abs(bank_deg) > 179.5 ? '' : bank_deg > 0 ? ' to the right' : ' to the left';
  return `lift ${Math.abs(bank_deg) <= 90 ? 'up' : 'down'}${side}`;
};

/** The next moment that people know, by the plan and what was heard; its time only as far as it is predicted. */
export function nextEvent(look: Look): { name: string; e_s: number | undefined } | undefined {
  const { run, plan, cutoff } = look;
  const rest = plan.slice(lastHeard(plan, heardOf(run, plan, cutoff)) + 1);
  const next = rest.find((row) => isImportant(row.name));
  return next && { name: title(next.name), e_s: next.predictedES };
}

/** "≈ 12 s" ahead, "+3 s" past what was predicted: never a time that is not known, and no judgement. */
export function dueWords(e_s: number | undefined, now_e_s: number): { value: string; note: string } {
  if (e_s === undefined) return { value: '—', note: 'time not predicted' };
  const left = e_s - now_e_s;
  const note = `≈ ${fromEntry(e_s)}`;
  if (Number.isNaN(left)) return { value: fromEntry(e_s), note: 'predicted; the clock stands still' };
  if (left >= DUE_S) return { value: `≈ ${duration(left).replace(/\.\d s/, ' s')}`, note };
  if (left > -DUE_S) return { value: 'due', note };
  return { value: `+${duration(-left).replace(/\.\d s/, ' s')}`, note: `was predicted for ${note}` };
}

/** The three large numbers. */
export function figuresOf(look: Look, motion: Motion): Figure[] {
  const { altitude_m, speed_mps } = motion;
  const next = nextEvent(look);
  const stands = isLost.value && look.cutoff === Infinity;
  const now_e_s = stands ? NaN : Math.min(look.run.seenSclk, look.cutoff) - look.run.entrySclk;
  const due = next ? dueWords(next.e_s, now_e_s) : { value: '—', note: 'the plan has no more' };
  const far = (altitude_m ?? 0) >= 10000;
  return [
    {
      name: 'altitude',
      value:
        altitude_m === undefined
          ? '—'
          : far
            ? (altitude_m / 1000).toFixed(1)
            : altitude_m.toFixed(altitude_m < 100 ? 1 : 0),
      unit: far ? 'km' : 'm',
      note: altitude_m === undefined ? NOT_YET : '',
      age: ageOf(look, LAYOUT.altitude),
    },
    {
      name: 'speed',
      value: speed_mps === undefined ? '—' : speed_mps.toFixed(speed_mps < 10 ? 2 : 0),
      unit: 'm/s',
      note: speed_mps === undefined ? NOT_YET : '',
      age: ageOf(look, LAYOUT.speed),
    },
    { name: next ? next.name : 'next event', value: due.value, unit: '', note: due.note, age: undefined },
  ];
}
