// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { expect, it } from 'vitest';
import { PredictionSchema } from '../gen/aeolis/v1/prediction_pb';
import { predictForTest } from '../prediction/model';
import { useForTest } from '../run/session';
import { lookAt, vehicleDictionary } from '../testing/vehicle';
import { sceneOf } from './model';
import { predictedLook } from './predicted';

it('the predicted vehicle is that of the instant, by the nominal flight’s own channels, and none after its touchdown', () => {
  const look = (e_s: number) => lookAt(e_s, []);
  useForTest(look(0).run, vehicleDictionary);
  expect(predictedLook(look(0)), 'nothing is predicted yet').toBeUndefined();
  const id = (name: string) => vehicleDictionary.pick([name])?.id ?? -1;
  const flags = ['cruise_stage_gone', 'parachute_out', 'heatshield_gone', 'backshell_gone', 'rover_separated'];
  predictForTest(
    create(PredictionSchema, { state: 'ready', events: [{ name: 'touchdown', timepoint: true, eS: 431 }] }),
    {
      ...Object.fromEntries(
        flags.map((name, i) => [
          id(name),
          [
            [-60, i === 0 ? 1 : 0],
            [255, i < 2 ? 1 : 0],
          ] as [number, number][],
        ]),
      ),
      [id('altitude_m')]: [
        [0, 130000],
        [255, 11000],
      ],
    },
  );
  const at = (e_s: number) => {
    const predicted = predictedLook(look(e_s));
    return predicted && [sceneOf(predicted).scenery, sceneOf(predicted).motion.altitude_m];
  };
  expect([0, 254, 256, 432].map(at)).toEqual([['entry', 130000], ['entry', 130000], ['parachute', 11000], undefined]);
});
