// SPDX-License-Identifier: Apache-2.0
import { LinkChange_Silence } from '../gen/aeolis/v1/items_pb';
import { describe, expect, it } from 'vitest';
import {
  aDictionary,
  aPlan,
  aStore,
  event,
  explanation,
  firing,
  link,
  samples,
  situation,
  tone,
} from '../testing/fixtures';
import { create } from '@bufbuild/protobuf';
import { ConditionSchema } from '../gen/aeolis/v1/items_pb';
import { DictionaryReplySchema } from '../gen/aeolis/v1/run_pb';
import { Dictionary } from '../run/dictionary';
import { silenceStatus } from '../design/status';
import { firedCount, lanesOf, nextTimepoint, liveOutages, outages, pointDetail, shortTitle } from './model';
import { momentsOf } from './moments';

const FAULT = LinkChange_Silence.ground_fault;

describe('the timeline', () => {
  it('has no plan for a timepoint whose anchor is undefined', () => {
    expect(lanesOf(aStore(), aPlan, Infinity).plan.map((mark) => mark.name)).toEqual([
      'coolant_vent',
      'entry_interface',
    ]);
  });
  it('marks a tone where it begins and not each symbol of it', () => {
    const store = aStore([
      tone({ tone: 7, sclk: 700 }),
      tone({ tone: 7, sclk: 710 }),
      tone({ sclk: 720 }),
      tone({ tone: 8, sclk: 730 }),
    ]);
    expect(lanesOf(store, aPlan, Infinity).tones.map((mark) => mark.e_s)).toEqual([-300, -270]);
  });
  it('has what the Doppler shows on a lane of its own, with the time at which ground had recognised it', () => {
    const text = 'heatshield seen by Doppler';
    const store = aStore([
      event({ sclk: 850, name: 'SEEN_BY_DOPPLER', text, ert: '2012-219T04:59:12.0' }),
      event({ sclk: 851, name: 'HEATSHIELD_SEPARATION', ert: '2012-219T04:59:12.0' }),
    ]);
    expect(lanesOf(store, aPlan, Infinity).doppler).toEqual([{ e_s: -150, told_e_s: expect.closeTo(-148), text }]);
    expect(lanesOf(store, aPlan, 851).doppler).toEqual([]);
  });
  it('marks what went amiss on board at its instant once it was told, and no link, which has its lane', () => {
    const since = '2012-219T04:59:50.000';
    const backup = { rank: 'danger' as const, subject: 'computer', since };
    const store = aStore([
      link({ link: 'uhf_live', up: false, reason: 'unexplained', ert: '2012-219T04:59:40.0' }),
      situation(
        '2012-219T04:59:55.0',
        { ...backup, sentence: 'Flying on backup computer B since E−1:50' },
        { ...backup, subject: 'uhf_live', sentence: 'UHF lost' },
        { ...backup, subject: 'station', sentence: 'A fault on the ground' },
        { ...backup, subject: 'vehicle', sentence: 'Not heard' },
        { ...backup, rank: 'news', subject: 'landed', sentence: 'Touchdown confirmed' },
      ),
    ]);
    expect(lanesOf(store, aPlan, Infinity).amiss).toEqual([
      { e_s: expect.closeTo(-110), words: 'on backup computer B', danger: true },
    ]);
    expect(lanesOf(store, aPlan, 894).amiss).toEqual([]);
  });
  it('names a silence by its reason, and ends it', () => {
    const store = aStore([
      link({ link: 'uhf_live', up: false, reason: 'plasma', ert: '2012-219T04:59:00.0' }),
      link({ link: 'uhf_live', up: true, ert: '2012-219T04:59:30.0' }),
    ]);
    expect(outages(store, 'uhf_live', -100, Infinity)).toEqual([
      { from: expect.closeTo(-160), to: expect.closeTo(-130), words: 'plasma', lost: false },
    ]);
  });
  it('has live telemetry silent where the link that the plan has on is, with its reason', () => {
    const change = (name: string, up: boolean, at: string, reason = '', silence?: LinkChange_Silence) =>
      link({ link: name, up, reason, lost: silence === FAULT, silence, ert: `2012-219T04:${at}.0` });
    const store = aStore([
      change('uhf_live', false, '50:00', 'not begun: planned at E−13:20', LinkChange_Silence.not_begun),
      change('x_band_telemetry', true, '50:00'),
      change('x_band_telemetry', false, '51:00', 'ground fault: nothing comes from the station', FAULT),
      change('x_band_telemetry', true, '52:00'),
      change('uhf_live', true, '54:00'),
      change('x_band_telemetry', false, '55:00', 'switched off: X-band sends tones from E−12:30'),
      change('uhf_live', false, '59:00', 'plasma blackout', LinkChange_Silence.blackout),
    ]);
    expect(liveOutages(store, -100, Infinity)).toEqual([
      {
        from: -640,
        to: -580,
        words: 'ground fault: nothing comes from the station',
        silence: 'ground_fault',
        lost: true,
      },
      { from: -160, to: -100, words: 'plasma blackout', silence: 'blackout', lost: false },
    ]);
    const older = aStore([change('uhf_live', false, '59:00', 'plasma blackout')]);
    expect(liveOutages(older, -100, Infinity)).toEqual([
      { from: -160, to: -100, words: 'plasma blackout', lost: false },
    ]);
  });
  it('shows a silence that nothing predicted as an alarm, as its link does', () => {
    expect([true, false].map((lost) => silenceStatus({ lost }).token)).toEqual(['alarm', 'caution']);
  });
  it('shows nothing later than the past view', () => {
    const store = aStore([
      firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500 }),
      firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
    ]);
    expect(lanesOf(store, aPlan, 600).live.map((mark) => mark.name)).toEqual(['coolant_vent']);
    expect(nextTimepoint(store, aPlan, 600)?.name).toBe('entry_interface');
    expect(nextTimepoint(store, aPlan, Infinity)?.name).toBe('parachute_deploy');
  });
  it('says what state a timepoint is in, each verdict with its own word', () => {
    const states = (...items: Parameters<typeof aStore>[0] & object) =>
      [0, 1, 2].map((id) => pointDetail(aStore(items), aDictionary, aPlan, id, Infinity)?.state);
    const vent = (verdict: NonNullable<Parameters<typeof firing>[0]['verdict']>) =>
      firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500, verdict });
    expect(states(vent('unverified'))).toEqual(['unverified', 'next', 'undefined']);
    expect([states(vent('refused'))[0], states(vent('verified'))[0], states(vent('no_operation'))[0]]).toEqual([
      'refused',
      'fired',
      'fired',
    ]);
    expect(states(firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }))).toEqual([
      'passed',
      'fired',
      'next',
    ]);
  });
  it('says that a reply is waited for by the vehicle’s own word, of its current timepoint only', () => {
    const words = new Dictionary(
      create(DictionaryReplySchema, {
        channels: [
          { id: 11, name: 'timepoint_index', packet: 'Timeline' },
          {
            id: 12,
            name: 'timepoint_state',
            packet: 'Timeline',
            labels: [
              { value: 0n, label: 'pending' },
              { value: 2n, label: 'waiting_reply' },
            ],
          },
        ],
      }),
    );
    const state = (index: number, told: number) =>
      pointDetail(aStore([samples(899, { 11: index, 12: told })]), words, aPlan, 0, Infinity)?.state;
    expect([state(0, 2), state(0, 0), state(1, 2)]).toEqual(['waiting for reply', 'next', 'next']);
  });
  it('has of a timepoint what flight said of it, and not what it said of another at that moment', () => {
    const told = (decision: string, text: string) =>
      explanation({
        sclk: 890,
        decision,
        verdict: 'fired',
        text,
        conditions: [
          create(ConditionSchema, { quantity: 'speed_mps', value: 404, comparison: '<=', bound: 405, holds: true }),
        ],
      });
    const store = aStore([
      firing({ timepoint: 2, name: 'parachute_deploy', firedSclk: 890 }),
      told('parachute_deploy', 'the mortar'),
      told('tone', 'a tone'),
    ]);
    expect(pointDetail(store, aDictionary, aPlan, 2, Infinity)?.why?.text).toBe('the mortar');
    expect(pointDetail(store, aDictionary, aPlan, 1, Infinity)?.why).toBeUndefined();
  });
  it('counts what tones told where UHF is silent, goes on from there, and says so', () => {
    const plan = aPlan.map((row) => ({ ...row, tone: row.name }));
    const store = aStore([
      firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500 }),
      tone({ sclk: 890, tone: 29, name: 'entry_interface' }),
    ]);
    expect(firedCount(store, plan, Infinity)).toEqual({ all: 2, byTone: 1 });
    expect(nextTimepoint(store, plan, Infinity)?.name).toBe('parachute_deploy');
    expect(pointDetail(store, aDictionary, plan, 1, Infinity)).toMatchObject({
      state: 'fired',
      by: 'tone',
      tone_e_s: -110,
      verdict: '',
    });
  });
  it('has a timepoint that only its tone told in the lane of tones, by its own number and name', () => {
    const plan = aPlan.map((row) => ({ ...row, tone: row.name }));
    const store = aStore([
      tone({ sclk: 174, tone: 28, name: 'coolant_vent' }),
      firing({ timepoint: 1, name: 'entry_interface', firedSclk: 890 }),
      tone({ sclk: 890, tone: 29, name: 'entry_interface' }),
    ]);
    expect(lanesOf(store, plan, Infinity).heardByTone).toEqual([
      { id: 0, name: 'coolant_vent', e_s: -826, important: true, bad: false },
    ]);
  });
  it('has the short form of a name where a picture has little room', () => {
    expect(['sufr', 'entry_guidance'].map(shortTitle)).toEqual(['SUFR', 'entry guidance']);
  });
  it('knows a moment between timepoints by event or tone, and as passed once the timepoint after it is', () => {
    const plan = [...aPlan, { ...aPlan[1], id: 9, name: 'sufr', anchor: 'sufr_start' } as (typeof aPlan)[number]];
    const moments = (...items: Parameters<typeof aStore>[0] & object) =>
      momentsOf(aStore(items), plan, Infinity).map(({ e_s, done }) => [e_s, done]);
    expect(moments(event({ name: 'PEAK_DECELERATION', sclk: 1080 }))).toEqual([
      [80, true],
      [undefined, false],
    ]);
    expect(moments(tone({ sclk: 1150, tone: 35, name: 'heading_alignment' }))).toEqual([
      [undefined, false],
      [150, true],
    ]);
    expect(moments(firing({ timepoint: 9, name: 'sufr', firedSclk: 1239 }))).toEqual([
      [undefined, true],
      [undefined, true],
    ]);
    expect(momentsOf(aStore(), aPlan, Infinity)).toEqual([]);
  });
  it('as it was heard has nothing that only the recording told, and a tone once it was decided', () => {
    const store = aStore([
      firing({ timepoint: 0, name: 'coolant_vent', firedSclk: 500 }),
      firing({ timepoint: 1, name: 'entry_interface', firedSclk: 600, source: 2 }),
      samples(600, { 3: 1, 4: 1 }, 2),
      tone({ sclk: 640, tone: 29, name: 'entry_interface', ert: '2012-219T04:55:50.0' }), // SCLK 650
    ]);
    const heard = store.asHeardBy(Infinity, () => undefined);
    expect(lanesOf(store, aPlan, 645).recorded.length).toBe(1);
    expect([lanesOf(heard, aPlan, 645).recorded.length, firedCount(heard, aPlan, 645).all, heard.latest(3)]).toEqual([
      0,
      1,
      undefined,
    ]);
    expect([645, 655].map((cutoff) => lanesOf(heard, aPlan, cutoff).tones.length)).toEqual([0, 1]);
    expect(heard.entrySclk).toBe(store.entrySclk);
  });
});
