// SPDX-License-Identifier: Apache-2.0
// The samples around a touchdown, whole: the page holds few of a channel that is not plotted.
import { useEffect } from 'preact/hooks';
import { asHeard, runNow, store } from '../run/shown';
import { fetchSamples, once } from '../vehicle/history';
import { TOUCHDOWN, VEHICLE } from '../vehicle/layout';

const BEFORE_S = 3;
const AFTER_S = 30; // longer than the steps take

const NAMES = [
  ...VEHICLE.position,
  ...VEHICLE.descentRate,
  ...VEHICLE.horizontalSpeed,
  ...VEHICLE.propellant,
  TOUCHDOWN.flag,
  ...TOUCHDOWN.roverRates_dps,
  ...TOUCHDOWN.roverAcceleration_g,
];

export function useTouchdownHistory(sclk: number | undefined): void {
  const run = runNow() && store.value;
  const live = asHeard.value;
  const complete = run?.run.relayProgress === 1;
  // The page's own history thins what it brings, so that of the run comes first.
  const known = run?.askedFor.has(TOUCHDOWN.flag) ?? false;
  useEffect(() => {
    if (!run || sclk === undefined) return;
    const part = `touchdown ${sclk} ${live} ${complete} ${known}`;
    once(run, part, () => fetchSamples(run, NAMES, sclk - BEFORE_S, sclk + AFTER_S, live));
  }, [run, sclk, live, complete, known]);
}
