// SPDX-License-Identifier: Apache-2.0
// The knowledge of a replay "as it was heard" at an instant: ERT 05:00:00 is SCLK 900, without light time.
import { describe, expect, it } from 'vitest';
import { aStore, event, explanation, firing, samples, unit } from '../testing/fixtures';
import { LATE_LIMIT } from './store';

const packetOf = (channel: number) => (channel === 3 ? 'Navigation' : 'Status');
const ert = (s: number) =>
  `2012-219T05:${String(Math.floor(s / 60)).padStart(2, '0')}:${(s % 60).toFixed(1).padStart(4, '0')}`; // of SCLK 900 + s
const navigation = (sclk: number, heard_s: number, link = 'uhf_live') => [
  unit({ name: 'Navigation', sclk, ert: ert(heard_s), link }),
  samples(sclk, { 3: sclk }),
];

describe('a past as it was heard', () => {
  const store = aStore([
    ...navigation(910, 10.2),
    ...navigation(911, 11.2),
    event({ id: 1, name: 'EARLY', text: 'a', sclk: 911, ert: ert(11.3) }),
    ...navigation(930, 30.2),
    // Five minutes later an orbiter delivers the lost samples between them.
    ...navigation(920, 330, 'uhf_mro'),
    event({ id: 2, name: 'LATE', text: 'b', sclk: 920, ert: ert(330) }),
    explanation({ sclk: 920, text: 'why', decision: 'fire' }),
    firing({ timepoint: 1, name: 'entry_interface', firedSclk: 920 }),
    ...navigation(921, 332, 'uhf_mro'),
  ]);
  const known = (cutoff: number) => {
    const run = store.asHeardBy(cutoff, packetOf);
    const series = run.live.get(3);
    return {
      altitude: run.latest(3, Math.min(cutoff, 925))?.sclk,
      samples: series?.length,
      events: run.events.map((row) => row.fact.name),
      explanations: run.explanations.length,
      fired: [...run.firings.keys()],
    };
  };
  it('has what an orbiter recorded only from when it was brought on', () => {
    expect(known(940)).toEqual({ altitude: 911, samples: 3, events: ['EARLY'], explanations: 0, fired: [] });
    expect(known(1231)).toEqual({ altitude: 920, samples: 4, events: ['EARLY', 'LATE'], explanations: 1, fired: [1] });
    expect(known(1233)).toMatchObject({ altitude: 921, samples: 5 });
    expect(known(940).samples).toBe(3); // back again
  });
  it('has each event from when it was heard, not from when it happened', () => {
    expect(known(911.1).events).toEqual([]);
    expect(known(911.4).events).toEqual(['EARLY']);
  });
  it('says of which packet it no longer knows what was still under way, once more came late than is kept, and for as long as that matters', () => {
    const lateOnes = Array.from({ length: LATE_LIMIT + 1 }, (_, i) =>
      unit({ name: 'Navigation', sclk: 901 + i / 1000, ert: ert(330), link: 'uhf_mro' }),
    ); // heard at 1230
    const few = aStore([...navigation(1235, 335.2), ...lateOnes.slice(1)]);
    const many = aStore([...navigation(1235, 335.2), ...lateOnes]);
    expect(few.notTold(1000)).toEqual([]);
    expect([900, 1000, 1231].map((cutoff) => many.asHeardBy(cutoff, packetOf).notTold(cutoff))).toEqual([
      [],
      [{ packet: 'Navigation', packets: LATE_LIMIT / 2 }],
      [],
    ]);
  });
  it('changes nothing of the run itself, and what was in time stays the very series that is drawn', () => {
    expect([store.live.get(3)?.length, store.events.length]).toEqual([5, 2]);
    const early = aStore([...navigation(910, 10.2)]);
    expect(early.asHeardBy(911, packetOf).live.get(3)).toBe(early.live.get(3));
  });
});
