// SPDX-License-Identifier: Apache-2.0
// What the page shows at this moment, for a report: its state, and which values are in sight.
import { alarms, listed } from '../alarms/model';
import { hazardous, stage } from '../commands/file';
import { chosen, step } from '../commands/line';
import { executions, lineOf, underWay } from '../procedures/model';
import { isLost, stream } from '../run/connection';
import { dictionary, modeNow, pastRange, shownRun, withRecording } from '../run/shown';
import { situationNow } from '../situation/model';
import type { Instant } from './model';

/** Undefined without a run. */
export function instantNow(): Instant | undefined {
  const [run, words] = [shownRun(), dictionary.value];
  if (!run || !words) return undefined;
  const past = pastRange.value;
  return {
    run,
    dictionary: words,
    mode: modeNow(),
    past,
    withRecording: withRecording.value,
    lost: isLost.value,
    catchingUp: !isLost.value && stream.value.state !== 'live',
    situation: situationNow(run),
    alarms: past || alarms.value?.run !== run.id ? undefined : listed.value,
    armed: [
      ...(step.value === 'armed' && chosen.value ? [chosen.value.name] : []),
      ...(stage.value === 'armed' ? hazardous.value : []),
    ],
    procedures: executions.value || run.proceduresVersion === 0 ? underWay.value.map(lineOf) : ['not known here'],
    inSight: channelsInSight(),
  };
}

/** Names of the channels whose values can be seen: each such place names its channel for its menu. */
function channelsInSight(): string[] {
  const places = [...document.querySelectorAll<HTMLElement>('[data-menu^="channel "]')].filter(isInSight);
  return [...new Set(places.map(({ dataset }) => dataset.menu?.slice('channel '.length) ?? ''))];
}

/** Whether the middle of a place lies within the window and within everything that cuts it off or scrolls it. */
function isInSight(place: HTMLElement): boolean {
  const box = place.getBoundingClientRect();
  const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
  if (box.width === 0 || box.height === 0 || x < 0 || y < 0 || x > innerWidth || y > innerHeight) return false;
  for (let around = place.parentElement; around && around !== document.body; around = around.parentElement) {
    const { overflowY, clipPath } = getComputedStyle(around);
    if (clipPath === 'inset(50%)') return false; // a place that has no room in a low window
    if (overflowY === 'visible') continue;
    const { left, right, top, bottom } = around.getBoundingClientRect();
    if (x < left || x > right || y < top || y > bottom) return false;
  }
  return true;
}
