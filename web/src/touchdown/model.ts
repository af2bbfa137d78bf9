// SPDX-License-Identifier: Apache-2.0
// A touchdown in the three steps that flown landings used, each with its evidence: reported until all three are there,
// then confirmed. Pure; from what was received by the instant shown.
import { LAYOUT } from '../layout';
import { predictedEvent, prediction } from '../prediction/model';
import { outages } from '../timeline/model';
import { heardOf } from '../timeline/heard';
import { duration, fromEntry } from '../run/time';
import { TOUCHDOWN, VEHICLE } from '../vehicle/layout';
import { sampleOf, targetOf } from '../vehicle/model';
import type { Look } from '../vehicle/model';
import { length, overGround } from '../vehicle/vectors';
import type { Vector } from '../vehicle/vectors';

/**
 * `unknown`: what would tell does not come, or has not come. `never`: nothing of this vehicle tells it. `contradicted`: one
 * source says yes, a newer one no.
 */
export interface Step {
  name: string;
  state: 'done' | 'waiting' | 'unknown' | 'never' | 'contradicted';
  words: string;
  /** SCLK from which on it holds. */
  sclk: number | undefined;
}
export interface Touchdown {
  /** SCLK of the touchdown as first told. */
  sclk: number;
  steps: Step[];
  verdict: 'reported' | 'confirmed' | 'contradicted';
}

export type Rules = Omit<typeof TOUCHDOWN, 'roverRates_dps' | 'roverAcceleration_g'> & {
  roverRates_dps: readonly string[];
  roverAcceleration_g: readonly string[];
};

const BY = { uhf: 'by UHF', recording: 'by the recording', tone: 'by tone' } as const;

function eventStep(look: Look, rules: Rules): Step | undefined {
  const { run, plan, cutoff } = look;
  const at = (sclk: number) => fromEntry(sclk - run.entrySclk, { tenths: true });
  const told: { sclk: number; words: string }[] = [];
  const row = plan.find((each) => each.name === rules.timepoint);
  const heard = row && heardOf(run, plan, cutoff).get(row.id);
  if (heard) told.push({ sclk: heard.fired_sclk, words: `timepoint ${rules.timepoint} ${BY[heard.by]}` });
  const event = run.events.find(({ fact }) => fact.name === rules.event && fact.sclk <= cutoff);
  if (event) told.push({ sclk: event.fact.sclk, words: `event ${rules.event} ${event.live ? BY.uhf : BY.recording}` });
  const flag = sampleOf(look, [rules.flag]);
  if (flag && flag.value !== 0) told.push({ sclk: flag.sclk, words: `${rules.flag} is ${flag.value}` });
  told.sort((a, b) => a.sclk - b.sclk);
  const first = told[0];
  if (!first) return undefined;
  const name = 'touchdown told by the vehicle';
  if (flag && flag.value === 0 && flag.sclk > first.sclk + rules.gap_s)
    return {
      name,
      state: 'contradicted',
      words: `${first.words} at ${at(first.sclk)}, but ${rules.flag} is 0 at ${at(flag.sclk)}`,
      sclk: first.sclk,
    };
  return {
    name,
    state: 'done',
    words: `${at(first.sclk)}: ${told.map(({ words }) => words).join(', ')}`,
    sclk: first.sclk,
  };
}

/** Samples of a channel from either source after `from`, oldest first. */
function samplesAfter({ run, words, cutoff }: Look, name: string, from: number): { sclk: number; value: number }[] {
  const channel = words.pick([name]);
  if (!channel) return [];
  const found: { sclk: number; value: number }[] = [];
  for (const series of [run.live.get(channel.id), run.recorded.get(channel.id)]) {
    if (!series) continue;
    for (let i = series.firstAfter(from), end = series.firstAfter(cutoff); i < end; ++i)
      found.push({ sclk: series.sclk[i] as number, value: series.value[i] as number });
  }
  return found.sort((a, b) => a.sclk - b.sclk);
}

function stillStep(look: Look, rules: Rules, since: number): Step {
  const name = 'rover’s own IMU is still';
  const at = (sclk: number) => fromEntry(sclk - look.run.entrySclk, { tenths: true });
  const channels = [
    ...rules.roverRates_dps.map((channel) => ({ channel, middle: 0, bound: rules.stillRate_dps, unit: '°/s' })),
    ...rules.roverAcceleration_g.map((channel) => ({
      channel,
      middle: rules.gravity_g,
      bound: rules.stillAcceleration_g,
      unit: 'g',
    })),
  ];
  const unknown = (words: string): Step => ({ name, state: 'unknown', words: `not known: ${words}`, sclk: undefined });
  if (channels.length === 0 || channels.some(({ channel }) => !look.words.pick([channel])))
    return {
      name: `${name}: this vehicle never tells`,
      state: 'never',
      words:
        'flight sends no channel of it; after touchdown the IMU told of is the descent stage’s: so this touchdown stays reported',
      sclk: undefined,
    };
  const samples = channels
    .flatMap((each) => samplesAfter(look, each.channel, since).map((sample) => ({ ...each, ...sample })))
    .sort((a, b) => a.sclk - b.sclk);
  const last = samples.at(-1);
  if (!last) return unknown(`nothing of it has come since ${at(since)}`);
  // The stretch in which all are still; it begins anew with each motion and after each gap.
  let from: number | undefined;
  let before = since;
  let held: number | undefined;
  let moved = '';
  const seen = new Set<string>();
  for (const { channel, middle, bound, unit, sclk, value } of samples) {
    if (sclk - before > rules.gap_s) {
      from = undefined;
      seen.clear();
    }
    before = sclk;
    if (!(Math.abs(value - middle) <= bound)) {
      [from, held] = [undefined, undefined];
      seen.clear();
      moved = `${channel} ${value.toFixed(3)} ${unit} at ${at(sclk)}`;
      continue;
    }
    seen.add(channel);
    if (seen.size === channels.length) from ??= sclk;
    if (from !== undefined && held === undefined && sclk - from >= rules.still_s) held = sclk;
  }
  if (held !== undefined)
    return {
      name,
      state: 'done',
      words: `${at(held)}: within ${rules.stillRate_dps} °/s and ${rules.stillAcceleration_g} g of rest for ${rules.still_s} s`,
      sclk: held,
    };
  if (from === undefined)
    return {
      name,
      state: 'waiting',
      words: moved === '' ? 'not all of it has come yet' : `it moves: ${moved}`,
      sclk: undefined,
    };
  return {
    name,
    state: 'waiting',
    words: `still for ${duration(last.sclk - from)} of ${rules.still_s} s${moved === '' ? '' : `; last moved: ${moved}`}`,
    sclk: undefined,
  };
}

function linkStep(look: Look, rules: Rules, since: number): Step {
  const { run, words, cutoff } = look;
  const name = `UHF came for ${rules.uhf_s} s without a break after it`;
  const now = Math.min(run.seenSclk, cutoff);
  const at = (sclk: number) => fromEntry(sclk - run.entrySclk, { tenths: true });
  const channel = words.pick(LAYOUT.phase);
  const series = channel && run.live.get(channel.id);
  const times: number[] = [];
  for (let i = series?.firstAfter(since) ?? 0; series && i < series.firstAfter(now); ++i)
    times.push(series.sclk[i] as number);
  const silences = outages(run, rules.link, now - run.entrySclk, cutoff).map(({ from, to, words: why }) => ({
    from: from + run.entrySclk,
    to: to + run.entrySclk,
    why,
  }));
  const isSilent = (from: number, to: number) => silences.find((each) => each.from < to && each.to > from);
  let from: number | undefined;
  let before: number | undefined;
  for (const sclk of times) {
    if (before === undefined || sclk - before > rules.gap_s || isSilent(before, sclk)) from = sclk;
    before = sclk;
    if (from !== undefined && sclk - from >= rules.uhf_s)
      return {
        name,
        state: 'done',
        words: `${at(sclk)}: ${channel?.name} came over ${rules.link} each second or more often since ${at(from)}`,
        sclk,
      };
  }
  const silent = silences.find((each) => each.from <= now && each.to >= now);
  if (before === undefined)
    return {
      name,
      state: 'unknown',
      words: `not known: no UHF since ${silent ? `${at(silent.from)}: ${silent.why}` : `touchdown at ${at(since)}`}`,
      sclk: undefined,
    };
  if (silent ?? now - before > rules.gap_s)
    return {
      name,
      state: 'unknown',
      words: `not known: no UHF since ${at(silent?.from ?? before)}${silent ? `: ${silent.why}` : ''}; ${duration(before - (from ?? before))} had come without a break`,
      sclk: undefined,
    };
  return {
    name,
    state: 'waiting',
    words: `${duration(before - (from ?? before))} of ${rules.uhf_s} s since ${at(from ?? before)}`,
    sclk: undefined,
  };
}

/** Undefined until a touchdown has been told. */
export function touchdownOf(look: Look, rules: Rules = TOUCHDOWN): Touchdown | undefined {
  const event = eventStep(look, rules);
  if (event?.sclk === undefined) return undefined;
  const steps = [event, stillStep(look, rules, event.sclk), linkStep(look, rules, event.sclk)];
  return {
    sclk: event.sclk,
    steps,
    verdict:
      event.state === 'contradicted'
        ? 'contradicted'
        : steps.every(({ state }) => state === 'done')
          ? 'confirmed'
          : 'reported',
  };
}

export interface Result {
  name: string;
  value: string;
  unit: string;
  note: string;
}

const AT_TOUCHDOWN_S = 2; // chosen: an older sample is not the value of the touchdown

/** The newest value not after the touchdown; undefined if it is too old for that. */
function thenOf(
  look: Look,
  touchdown: number,
  names: readonly string[],
): { value: number; name: string; before_s: number } | undefined {
  const sample = sampleOf({ ...look, cutoff: Math.min(look.cutoff, touchdown) }, names);
  return sample && touchdown - sample.sclk <= AT_TOUCHDOWN_S
    ? { value: sample.value, name: sample.channel.name, before_s: touchdown - sample.sclk }
    : undefined;
}

/** The place of the touchdown by navigation on board, from Mars's centre. */
export function placeThen(look: Look, touchdown: number): Vector | undefined {
  const parts = VEHICLE.position.map((name) => thenOf(look, touchdown, [name])?.value);
  return parts.every((part) => part !== undefined) ? (parts as unknown as Vector) : undefined;
}

export function missOf(look: Look, touchdown: number): { east_m: number; north_m: number } | undefined {
  const [place, target] = [placeThen(look, touchdown), targetOf(look.run)];
  return place && target && length(place) > 0 ? overGround(place, target) : undefined;
}

const POINTS = ['north', 'north-east', 'east', 'south-east', 'south', 'south-west', 'west', 'north-west'];
export const compass = ({ east_m, north_m }: { east_m: number; north_m: number }): string =>
  POINTS[Math.round(((Math.atan2(east_m, north_m) * 180) / Math.PI + 360) / 45) % 8] ?? '';

/** The figures of the touchdown. What is not known says so, and why. */
export function resultsOf(look: Look, touchdown: number): Result[] {
  const { run, words, plan } = look;
  const figure = (name: string, names: readonly string[], unit: string, digits: number): Result => {
    const then = thenOf(look, touchdown, names);
    return then
      ? {
          name,
          value: then.value.toFixed(digits).replace('-', '−'),
          unit,
          note: `${then.name}, ${then.before_s < 0.05 ? 'at touchdown' : `${then.before_s.toFixed(1)} s before`}`,
        }
      : {
          name,
          value: '—',
          unit: '',
          note: `not known: ${words.pick(names)?.name ?? name} did not come within ${AT_TOUCHDOWN_S} s`,
        };
  };
  const miss = missOf(look, touchdown);
  const e_s = touchdown - run.entrySclk;
  const nominal = predictedEvent(TOUCHDOWN.timepoint);
  const last = plan.find((row) => row.name === TOUCHDOWN.timepoint)?.predictedES;
  const against = (at: number) => `${e_s - at < 0 ? '−' : '+'}${Math.abs(e_s - at).toFixed(1)}`;
  const byLast =
    last === undefined
      ? ''
      : `; ${against(last)} s on the last prediction before it, ${fromEntry(last, { tenths: true })}`;
  return [
    figure('down', VEHICLE.descentRate, 'm/s', 2),
    figure('across', VEHICLE.horizontalSpeed, 'm/s', 2),
    miss
      ? {
          name: 'from the target',
          value: Math.hypot(miss.east_m, miss.north_m).toFixed(0),
          unit: 'm',
          note: `to the ${compass(miss)}, by navigation on board; its uncertainty is not told`,
        }
      : {
          name: 'from the target',
          value: '—',
          unit: '',
          note: `not known: ${targetOf(run) ? `navigation did not come within ${AT_TOUCHDOWN_S} s` : 'no target in the ground’s solution'}`,
        },
    figure('propellant left', VEHICLE.propellant, 'kg', 1),
    {
      name: 'against predicted',
      value: nominal === undefined ? '—' : against(nominal),
      unit: nominal === undefined ? '' : 's',
      note: `${nominal === undefined ? (prediction.value ? 'not known: the server has no nominal flight of this run' : 'not known yet: the nominal flight is asked for') : `of ${fromEntry(nominal, { tenths: true })} in the nominal flight`}${byLast}`,
    },
  ];
}

/** What still comes, in words. `present`: the instant shown is the newest. */
export function restOf({ run, cutoff }: Look, present: boolean): { words: string; part: number | undefined }[] {
  if (!present) return [{ words: 'What came later is not shown in this past view.', part: undefined }];
  const part = run.run.relayProgress;
  const relay = run.links.get(TOUCHDOWN.recordingLink)?.findLast(({ ert_s }) => run.knownBy(ert_s, cutoff))?.fact;
  const pass =
    part >= 1
      ? ''
      : relay?.up
        ? ` The relay is received${run.run.state === 'paused' ? '; the rehearsal is paused' : ''}.`
        : relay?.reason
          ? ` Relay: ${relay.reason}.`
          : part > 0
            ? ' When the next pass is has not been told.'
            : '';
  return [
    {
      words:
        part >= 1
          ? 'The recording is complete.'
          : `${part > 0 ? `${Math.floor(part * 100)} % of the recording has come.` : 'Nothing is told of the recording yet.'}${run.going ? pass : ' The run has ended: no more comes.'}`,
      part,
    },
  ];
}
