// SPDX-License-Identifier: Apache-2.0
// A dictionary with every channel of the vehicle's layout, and looks at runs made by the channels' names.
import { create } from '@bufbuild/protobuf';
import { DictionaryReplySchema, TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import type { Item } from '../gen/aeolis/v1/items_pb';
import { LAYOUT } from '../layout';
import { Dictionary } from '../run/dictionary';
import { VEHICLE } from '../vehicle/layout';
import type { Happening, Telling } from '../vehicle/layout';
import type { Look } from '../vehicle/model';
import { ENTRY_SCLK, aRun, aStore, samples } from './fixtures';

const pyroLabels = ['not_commanded', 'commanded', 'fired', 'refused', 'unanswered'];
const tellings: Telling[] = Object.values(VEHICLE.happenings);
const pyros = tellings.flatMap((each) => each.pyros ?? []);

const names = [
  ...LAYOUT.phase,
  ...LAYOUT.altitude,
  ...LAYOUT.speed,
  ...[
    VEHICLE.attitude,
    VEHICLE.position,
    VEHICLE.velocity,
    VEHICLE.bank,
    VEHICLE.mode,
    VEHICLE.thrust,
    VEHICLE.throttles,
    VEHICLE.bridle,
    VEHICLE.propellant,
    VEHICLE.descentRate,
    VEHICLE.horizontalSpeed,
  ].flat(),
  ...tellings.flatMap((each) => each.flag ?? []),
  ...pyros,
];

export const vehicleDictionary = new Dictionary(
  create(DictionaryReplySchema, {
    channels: names.map((name, i) => ({
      id: i + 1,
      name,
      packet: 'Vehicle',
      expectedRateHz: 1,
      labels: pyros.includes(name) ? pyroLabels.map((label, value) => ({ value: BigInt(value), label })) : [],
    })),
  }),
);

export const vehiclePlan = [...tellings.flatMap((each) => each.timepoint ?? []), LAYOUT.landed as string].map(
  (name, id) => create(TimepointRowSchema, { id, name, tone: name }),
);

export const timepointOf = (name: string): number => vehiclePlan.find((row) => row.name === name)?.id ?? -1;
export const of = (which: Happening): Telling => VEHICLE.happenings[which];

/** Samples by channel name, at seconds from entry. */
export const told = (e_s: number, values: Record<string, number>, recorded = false): Item =>
  samples(
    ENTRY_SCLK + e_s,
    Object.fromEntries(
      Object.entries(values).map(([name, value]) => [vehicleDictionary.pick([name])?.id ?? -1, value]),
    ),
    recorded ? 2 : 1,
  );

const clocks = (now_e_s: number) => {
  const run = aRun();
  if (run.clocks) run.clocks.seenSclk = run.clocks.sclk = ENTRY_SCLK + now_e_s;
  return run;
};

export function lookAt(
  now_e_s: number,
  items: Item[],
  more: Partial<Look> & { solution?: [string, number][] } = {},
): Look {
  const run = clocks(now_e_s);
  for (const [name, value] of more.solution ?? [])
    run.solution.push({ $typeName: 'aeolis.v1.CommandArgument', name, value });
  return {
    run: aStore(items, run),
    words: vehicleDictionary,
    plan: vehiclePlan,
    cutoff: Infinity,
    lost: false,
    ...more,
  };
}
