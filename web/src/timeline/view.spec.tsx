import { describe, expect, it } from 'vitest';
import { aPlan, aStore, firing, link, tone } from '../testing/fixtures';
import { lanesOf, nextTimepoint, outages, pointDetail } from './model';

describe('the timeline', () => {
  it('has no plan for a timepoint whose anchor is undefined', () => {
    expect(lanesOf(aStore(), aPlan, Infinity).plan.map((mark) => mark.name)).toEqual(['coolant_vent', 'entry_interface']);
  });
  it('marks a tone where it begins and not each symbol of it', () => {
    const store = aStore([tone({ tone: 7, sclk: 700 }), tone({ tone: 7, sclk: 710 }), tone({ sclk: 720 }), tone({ tone: 8, sclk: 730 })]);
    expect(lanesOf(store, aPlan, Infinity).tones.map((mark) => mark.e_s)).toEqual([-300, -270]);
  });
  it('names a silence by its reason, and ends it', () => {
    const store = aStore([
      link({ link: 'uhf_live', up: false, reason: 'plasma', ert: '2012-219T04:59:00.0' }), link({ link: 'uhf_live', up: true, ert: '2012-219T04:59:30.0' }),
    ]);
    expect(outages(store, 'uhf_live', -100, Infinity)).toEqual([{ from: expect.closeTo(-160), to: expect.closeTo(-130), words: 'plasma' }]);
  });
  it('shows nothing later than the past view', () => {
    const store = aStore([firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500 }), firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 })]);
    expect(lanesOf(store, aPlan, 600).live.map((mark) => mark.name)).toEqual(['coolant_vent']);
    expect(nextTimepoint(store, aPlan, 600)?.name).toBe('entry_interface');
    expect(nextTimepoint(store, aPlan, Infinity)?.name).toBe('parachute_deploy');
  });
  it('says what state a timepoint is in', () => {
    const store = aStore([firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500, verdict: 'timed_out' })]);
    expect([0, 1, 2].map((id) => pointDetail(store, aPlan, id, Infinity)?.state)).toEqual(['timed out', 'next', 'undefined']);
  });
});
