// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { afterEach, describe, expect, it } from 'vitest';
import { AnchorRowSchema, TimepointRowSchema } from '../gen/aeolis/v1/run_pb';
import { anchors, store, timepoints } from '../run/shown';
import { aRun, aStore } from '../testing/fixtures';
import { predicted } from './now';

afterEach(() => {
  [store.value, timepoints.value, anchors.value] = [undefined, [], []];
});

describe('the prediction of the run that is shown', () => {
  it('is by the anchors that the run began with', () => {
    store.value = aStore(
      [],
      aRun({ clocks: { sclk: 900, seenSclk: 900, eS: -100, ert: '2012-219T05:00:00.0', scet: '2012-219T05:00:00.0' } }),
    );
    timepoints.value = [
      create(TimepointRowSchema, { id: 0, name: 'mortar', anchor: 'parachute', desiredOffsetS: 0, minimumOffsetS: 0 }),
    ];
    anchors.value = [
      create(AnchorRowSchema, { id: 0, name: 'root' }),
      create(AnchorRowSchema, { id: 1, name: 'parachute', parent: 'root', predictedES: 250 }),
    ];
    expect(predicted.value).toMatchObject([{ name: 'mortar', e_s: 250 }]);
    anchors.value = [create(AnchorRowSchema, { id: 1, name: 'parachute', parent: 'root' })];
    expect(predicted.value).toEqual([]);
  });
});
