// SPDX-License-Identifier: Apache-2.0
// The touchdown as the server judges it, its figures in words, and what still comes.
import { LAYOUT } from '../layout';
import { predictedEvent, prediction } from '../prediction/model';
import { asHeard, cutoff, runNow } from '../run/shown';
import { read } from '../run/connection';
import { fromEntry } from '../run/time';
import { entriesAt } from '../situation/model';
import { RECORDING_LINK } from '../vehicle/layout';
import type { Look } from '../vehicle/model';
import { touchdownAnswer, touchdownKnown } from './shown';
import type { TouchdownReport } from './shown';

const EVERY_MS = 1000; // chosen: while the run or a replay goes on, so do its steps
let underWay = false;
let last = { question: '', said: '', at_ms: -Infinity };

/** Asks for the touchdown at the instant shown, if that has another question or the run goes on. */
export async function refreshTouchdown(): Promise<void> {
  const run = runNow();
  if (!run || underWay) return;
  const [at, live] = [cutoff.value, asHeard.value];
  const parts = [at === Infinity ? '' : `at=${at}`, live ? 'recorded=false' : ''].filter((part) => part !== '');
  const path = `/runs/${run.id}/touchdown?${parts.join('&')}`;
  const question = `${path} ${run.going} ${run.run.relayProgress === 1}`;
  // What the banner says of it is asked for at once, so that the card says the same.
  const said = entriesAt(run, at).find(({ subject }) => subject === 'landed')?.sentence ?? '';
  const isFresh = said === last.said && performance.now() - last.at_ms < EVERY_MS;
  if (touchdownKnown.value && (question === last.question ? isFresh || !run.going : isFresh)) return;
  underWay = true;
  try {
    const report = await read<TouchdownReport>(path);
    last = { question, said, at_ms: performance.now() };
    if (runNow()?.id === run.id) touchdownAnswer.value = { at, live, report };
  } catch {
    // the next round asks again
  } finally {
    underWay = false;
  }
}

export interface Result {
  name: string;
  value: string;
  unit: string;
  note: string;
  /** What the note has no room for. */
  more?: string;
}

const POINTS = ['north', 'north-east', 'east', 'south-east', 'south', 'south-west', 'west', 'north-west'];
export const compass = ({ east_m, north_m }: { east_m: number; north_m: number }): string =>
  POINTS[Math.round(((Math.atan2(east_m, north_m) * 180) / Math.PI + 360) / 45) % 8] ?? '';

const SPEED_DIGITS = 2;

/** The figures of the touchdown. What is not known says so, and why. */
export function resultsOf(
  { run, plan }: Look,
  { sclk = NaN, figures, place, place_unknown }: TouchdownReport,
): Result[] {
  const told = figures.map(({ name, channel, unit, value, before_s }): Result => {
    if (value === undefined) return { name, value: '—', unit: '', note: `not known: ${channel} did not come near it` };
    const note = `${channel}, ${before_s < 0.05 ? 'at touchdown' : `${before_s.toFixed(1)} s before`}`;
    return { name, value: value.toFixed(unit === 'm/s' ? SPEED_DIGITS : 1).replace('-', '−'), unit, note };
  });
  const e_s = sclk - run.entrySclk;
  const nominal = predictedEvent(LAYOUT.landed);
  const expected = plan.find((row) => row.name === LAYOUT.landed)?.predictedES;
  const against = (at: number) => `${e_s - at < 0 ? '−' : '+'}${Math.abs(e_s - at).toFixed(1)}`;
  const byLast =
    expected === undefined
      ? ''
      : `; ${against(expected)} s on the last prediction before it, ${fromEntry(expected, { tenths: true })}`;
  return [
    ...told.slice(0, 2),
    place
      ? {
          name: 'from the target',
          value: Math.hypot(place.east_m, place.north_m).toFixed(0),
          unit: 'm ± ?',
          note: `to the ${compass(place)}, by navigation on board, uncertainty not known`,
          more: `It rests on ${place.rests_on}.`,
        }
      : { name: 'from the target', value: '—', unit: '', note: `not known: ${place_unknown}` },
    ...told.slice(2),
    {
      name: 'against predicted',
      value: nominal === undefined ? '—' : against(nominal),
      unit: nominal === undefined ? '' : 's',
      note: `${nominal === undefined ? (prediction.value ? 'not known: the server has no nominal flight of this run' : 'not known yet: the nominal flight is asked for') : `of ${fromEntry(nominal, { tenths: true })} in the nominal flight`}${byLast}`,
    },
  ];
}

/** What still comes, in words. `present`: the instant shown is the newest. */
export function restOf({ run, cutoff: until }: Look, present: boolean): { words: string; part: number | undefined }[] {
  if (!present) return [{ words: 'What came later is not shown in this past view.', part: undefined }];
  const part = run.run.relayProgress;
  const relay = run.links.get(RECORDING_LINK)?.findLast(({ ert_s }) => run.knownBy(ert_s, until))?.fact;
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
