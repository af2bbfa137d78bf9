// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { LinkCountersSchema, ProofReportSchema } from '../gen/aeolis/v1/run_pb';
import { aStore, link } from '../testing/fixtures';
import { framesKept, linkTitle, linkViews, sequenceRows } from './model';

describe('the links', () => {
  it('have names that people say', () => {
    expect(
      ['uhf_live', 'uhf_mro', 'relay', 'relay_mex', 'x_band', 'x_band_telemetry', 'downlink'].map(linkTitle),
    ).toEqual(['UHF', 'UHF MRO', 'Relay', 'Relay MEX', 'X-band', 'X-band telemetry', 'downlink']);
  });
  it('take a silence that nothing predicted for a loss, and say why', () => {
    const store = aStore([
      link({
        link: 'uhf_live',
        up: false,
        reason: 'unexplained: nothing is predicted to silence it now',
        lost: true,
        ert: '2012-219T04:59:00.0',
      }),
      link({ link: 'x_band', up: false, reason: 'Earth set: predicted at E+297 s', ert: '2012-219T04:59:00.0' }),
    ]);
    expect(linkViews(store, undefined, Infinity).map((each) => each.state)).toEqual(['lost', 'down']);
  });
  it('show what is down with its reason and its silences, and never up what told nothing', () => {
    const store = aStore([
      link({ link: 'uhf_live', up: true, ert: '2012-219T04:58:00.0' }),
      link({ link: 'uhf_live', up: false, reason: 'plasma blackout', ert: '2012-219T04:59:00.0' }),
    ]);
    const proof = create(ProofReportSchema, { counters: [{ link: 'uhf_mro', frames: 3n }] });
    const [live, orbiter] = linkViews(store, proof, Infinity);
    expect(live).toMatchObject({
      link: 'uhf_live',
      state: 'down',
      reason: 'plasma blackout',
      silences: [{ words: 'plasma blackout', from: -160, to: -100 }],
    });
    expect(orbiter).toMatchObject({ link: 'uhf_mro', state: 'unknown' });
  });
  it('in a past view have the state of then', () => {
    const store = aStore([
      link({ link: 'uhf_live', up: true, ert: '2012-219T04:58:00.0' }),
      link({ link: 'uhf_live', up: false, reason: 'plasma blackout', ert: '2012-219T04:59:00.0' }),
    ]);
    expect(linkViews(store, undefined, 830)[0]?.state).toBe('up');
  });
  it('list their sequences, those first whose counts are not in order', () => {
    const proof = create(ProofReportSchema, {
      counters: [
        { link: 'uhf_live', sequences: [{ name: 'virtual channel 0', received: 9n }] },
        {
          link: 'downlink',
          sequences: [{ name: 'APID 1', packets: true, received: 3n, late: 1n }, { name: 'APID 2' }],
        },
      ],
    });
    expect(sequenceRows(linkViews(aStore([]), proof, Infinity)).map((row) => row.counted.name)).toEqual([
      'APID 1',
      'APID 2',
      'virtual channel 0',
    ]);
  });
  it('count the part of the frames that came', () => {
    expect(framesKept(create(LinkCountersSchema, { frames: 90n, missingFrames: 10n }))).toBe(0.9);
    expect(framesKept(create(LinkCountersSchema, {}))).toBeUndefined();
  });
});
