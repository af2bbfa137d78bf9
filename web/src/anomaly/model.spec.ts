// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { describe, expect, it } from 'vitest';
import type { AlarmState } from '../alarms/model';
import type { RunStore } from '../run/store';
import { situationOf } from '../situation/model';
import {
  aDictionary,
  aRun,
  aStore,
  alarm,
  link,
  samples,
  silent,
  situation,
  stage,
  staleness,
} from '../testing/fixtures';
import { lineOf } from '../procedures/model';
import { aStep, anExecution } from '../testing/procedures';
import { firstLine, fitted, reportOf } from './model';
import type { Instant } from './model';

// The fixtures' run: SCLK 900 is heard at 05:00:00, entry is at 1000.
const instant = (run: RunStore, more: Partial<Instant> = {}): Instant => ({
  run,
  dictionary: aDictionary,
  mode: 'rehearsal',
  past: undefined,
  withRecording: false,
  lost: false,
  catchingUp: false,
  situation: situationOf(
    run,
    more.past ? run.entrySclk + more.past.to : Infinity,
    more.lost ? { attempt: 2 } : undefined,
  ),
  alarms: [],
  armed: [],
  procedures: [],
  inSight: [],
  ...more,
});
const linesOf = (of: Instant) => reportOf(of).text.split('\n');
const an = (name: string, more: Partial<AlarmState> = {}): AlarmState => ({
  name,
  kind: 'limit',
  state: 'unacknowledged',
  severity: 'watch',
  worst: 'watch',
  ...more,
});

describe('the text of an anomaly report', () => {
  it('begins with the instant by the run’s clocks, the run, and the banner with its evidence', () => {
    const run = aStore([
      situation(
        '2012-219T04:59:55.0',
        {
          rank: 'danger',
          subject: 'computer',
          sentence: 'Flying on backup computer B',
          evidence: 'event SECOND_CHANCE_TAKES_OVER',
          awaited: 'A back',
          at: '2012-219T05:00:40.0',
          since: '2012-219T04:59:50.0',
        },
        { rank: 'lasting', subject: 'computer', sentence: 'Flying on backup computer B since E−1:50' },
      ),
    ]);
    expect(linesOf(instant(run))).toEqual([
      'At E−1:40.0, on Earth (ERT) 2012-219T05:00:00.0, SCLK 900.000',
      'REHEARSAL: nominal · run 1 · 1×',
      'Banner: Flying on backup computer B [A back in ≈ 40 s] (evidence: event SECOND_CHANCE_TAKES_OVER, E−1:50)',
      'Lasting: Flying on backup computer B since E−1:50',
      'Alarms: none is raised',
      'Links: none was heard of yet',
      'Values in view: none',
    ]);
    expect(reportOf(instant(run))).toMatchObject({ at: 'E−1:40.0', sclk: 900, view: '' });
  });
  it('has each alarm with limit, value, since and whether it is acknowledged; ten of them, the others counted', () => {
    const first = [
      an('altitude_m', { severity: 'warning', limit: '> 200000 m', value: 250000, sclk: 870 }),
      an('Navigation', { kind: 'staleness', reason: 'due and missing', state: 'acknowledged', by: 'Ann', sclk: 880 }),
      an('speed_mps', { severity: 'none', worst: 'distress', state: 'returned', limit: '> 120 m/s' }),
      an('uhf_live', { kind: 'link', state: 'shelved', shelved_until: '2012-219T05:05:00', reason: 'no carrier' }),
    ];
    const over = [an('edl_phase', { severity: 'none', state: 'acknowledged' })]; // within its limits, and seen
    const many = Array.from({ length: 9 }, (_, i) => an(`more_${i}`, { acknowledged: true }));
    const lines = linesOf(instant(aStore(), { alarms: [...first, ...over, ...many] }));
    expect(lines.slice(3, 9)).toEqual([
      'Alarms: 13',
      '- altitude_m: warning, limit > 200000 m, value 250000 m, since E−2:10, not acknowledged',
      '- Navigation: watch, stale, due and missing, since E−2:00, acknowledged by Ann',
      '- speed_mps: over, was distress, limit > 120 m/s, not acknowledged',
      '- uhf_live: watch, lost, no carrier, shelved until 2012-219T05:05:00',
      '- more_0: watch, acknowledged',
    ]);
    expect(lines).toContain('+3 more');
  });
  it('has each procedure under way with the steps that it is at', () => {
    const steps = [aStep('poll', { state: 'active' }), aStep('done', { state: 'ticked' })];
    const procedures = [lineOf(anExecution({ steps })), lineOf(anExecution({ number: 2, held: 'Ann: wait' }))];
    expect(linesOf(instant(aStore(), { procedures })).slice(5, 8)).toEqual([
      'Procedures under way:',
      '- #1 A poll, under way: poll',
      '- #2 A poll, held',
    ]);
  });
  it('says of each link whether it is up, silent as predicted, or lost', () => {
    const run = aStore([
      link({
        link: 'uhf_live',
        up: false,
        reason: 'plasma blackout: predicted from E−2:00',
        ert: '2012-219T04:59:40.0',
      }),
      link({ link: 'x_band', up: true, reason: 'nominal', ert: '2012-219T04:59:00.0' }),
      link({ link: 'uhf_mro', up: false, lost: true, reason: 'no carrier', ert: '2012-219T04:59:50.0' }),
    ]);
    const links = (more: Partial<Instant>) => linesOf(instant(run, more)).filter((line) => /^- (UHF|X)/.test(line));
    expect(links({})).toEqual([
      '- UHF: silent since E−2:00, as predicted: plasma blackout: predicted from E−2:00',
      '- UHF MRO: lost since E−1:50, not predicted: no carrier',
      '- X-band: up since E−2:40',
    ]);
    expect(links({ lost: true })[0]).toBe('- UHF: not known: no connection');
  });
  it('has what is armed, what waits on the ground and what is under way', () => {
    const run = aStore([
      stage({ command: 1n, name: 'NO_OP', stage: 'released', status: 'ok', evidence: 'left' }),
      stage({ command: 1n, name: 'NO_OP', stage: 'accepted', status: 'pending', evidence: 'due' }),
      stage({ command: 2n, name: 'EDL_SET_PARAMETERS', stage: 'released', status: 'pending', evidence: 'held by Ann' }),
      stage({ command: 3n, name: 'NO_OP', stage: 'released', status: 'failed', evidence: 'cancelled' }),
    ]);
    const lines = linesOf(instant(run, { armed: ['EDL_DO_EDL'] }));
    expect(lines.slice(-5, -1)).toEqual([
      'Commands armed, waiting or under way:',
      '- EDL_DO_EDL: armed, not sent',
      '- NO_OP #1: under way, released: left',
      '- EDL_SET_PARAMETERS #2: waits, released pending: held by Ann',
    ]);
  });
  it('has the values in view, in the order of the table, with unit and age; what is stale, undefined or never came says so', () => {
    const run = aStore([samples(899.95, { 1: 4 }), samples(880, { 3: 1234.5, 4: NaN }), silent('Navigation')]);
    run.addHistory([], ['parameters_received']);
    const inSight = ['speed_mps', 'parameters_received', 'next_desired_sclk', 'altitude_m', 'edl_phase', 'altitude_m'];
    expect(linesOf(instant(run, { inSight })).slice(-6)).toEqual([
      'Values in view: 5',
      '- edl_phase: range control, now',
      '- altitude_m: 1234.5 m, stale, 20.0 s old',
      '- speed_mps: undefined, stale, 20.0 s old',
      '- parameters_received: not received',
      '- next_desired_sclk: not asked for yet',
    ]);
  });
  it('calls every value stale without a connection, also one that is in alarm', () => {
    const run = aStore([
      samples(899, { 3: 250000 }),
      alarm({ channel: 3, severity: 'warning', value: 250000, sclk: 899, limit: '> 200000 m' }),
    ]);
    const lines = linesOf(instant(run, { lost: true, inSight: ['altitude_m'] }));
    expect(lines.at(-1)).toBe('- altitude_m: 250000 m, stale, 1.0 s old');
    expect(lines).toContain('Banner: NO CONNECTION: everything here is old. Trying again, attempt 2.');
  });
  it('is of the past where a past is shown, in its first line and in each value', () => {
    const run = aStore([
      samples(850, { 3: 300000 }),
      alarm({ channel: 3, severity: 'warning', value: 300000, sclk: 850, limit: '> 200000 m' }),
      samples(899, { 3: 100 }),
      alarm({ channel: 3, sclk: 899 }),
      link({ link: 'uhf_live', up: true, reason: 'nominal', ert: '2012-219T04:59:00.0' }),
      link({ link: 'uhf_live', up: false, lost: true, reason: 'no carrier', ert: '2012-219T04:59:55.0' }),
      link({ link: 'x_band', up: false, lost: true, reason: 'no carrier', ert: '2012-219T04:59:10.0' }),
      staleness({
        packet: 'Status',
        stale: true,
        missing: true,
        reason: 'due and missing',
        ert: '2012-219T04:59:15.0',
      }),
      staleness({ packet: 'Navigation', stale: true, reason: 'not expected here', ert: '2012-219T04:59:55.0' }),
      stage({ command: 1n, name: 'NO_OP', stage: 'released', status: 'pending', ert: '2012-219T04:59:55.0' }),
    ]);
    const past = { from: -200, to: -140 };
    const of = instant(run, { past, mode: 'range', alarms: undefined, inSight: ['altitude_m'] });
    const { view, sclk } = reportOf(of);
    expect([firstLine('', view), sclk]).toEqual([
      'Anomaly report: cause not known (PAST, NOT LIVE: E−2:20.0, as it was heard then)',
      860,
    ]);
    expect(linesOf(of)).toEqual([
      'At E−2:20.0, on Earth (ERT) 2012-219T04:59:20.0, SCLK 860.000',
      'PAST, NOT LIVE: rehearsal, nominal · run 1 · E−3:20 … E−2:20',
      'Banner: nothing has been told yet',
      'Alarms: 3; whether they were acknowledged is not known here',
      '- altitude_m: warning, limit > 200000 m, value 300000 m, since E−2:30',
      '- Status: stale, due and missing, since E−2:25',
      '- x_band: lost, no carrier, since E−2:30',
      'Links:',
      '- UHF: up since E−2:40',
      '- X-band: lost since E−2:30, not predicted: no carrier',
      'Values in view: 1',
      '- altitude_m: 300000 m, 10.0 s old',
    ]);
    expect(reportOf({ ...of, mode: 'replay', withRecording: true }).view).toBe(
      'REPLAY, NOT LIVE: E−2:20.0, with the recording',
    );
  });
  it('says so while the page has yet to receive a part of the run', () => {
    expect(linesOf(instant(aStore(), { catchingUp: true }))[2]).toMatch(/^Not all of the run had arrived/);
  });
  it('says so where the run has ended', () => {
    const run = aStore([], aRun({ state: 'finished', outcome: 'touchdown' }));
    expect(firstLine('', reportOf(instant(run, { mode: 'ended' })).view)).toBe(
      'Anomaly report: cause not known (ENDED RUN)',
    );
  });
});

describe('the length', () => {
  it('leaves out whole values, the last first, and says how many; then whole lines', () => {
    const values = ['a', 'b', 'c'].map((name) => `- ${name}: ${'1'.repeat(60)}`);
    const words = 'left out: a note has at most 4000 octets';
    expect(fitted(['At'], values, 4000)).toBe(`At\nValues in view: 3\n${values.join('\n')}`);
    expect(fitted(['At'], values, 150)).toBe(`At\nValues in view: 3\n${values[0]}\n+2 values ${words}`);
    expect(fitted(['At', 'ä'.repeat(40)], values, 80)).toBe(`At\n+1 line and 3 values ${words}`);
  });
  it('keeps room for the first line with the longest cause', () => {
    const run = aStore();
    const alarms = Array.from({ length: 10 }, (_, i) => an(`channel_${i}`, { reason: 'x'.repeat(400) }));
    const { text, view } = reportOf(instant(run, { alarms }));
    const all = `${firstLine('€'.repeat(150), view)}\n${text}`;
    expect(new TextEncoder().encode(all).length).toBeLessThanOrEqual(4000);
    expect(text).toMatch(/^At .*\n[^]*\n\+\d+ lines and 0 values left out: a note has at most 4000 octets$/);
  });
  it('puts a cause on one line', () => {
    expect(firstLine(' radar\n late ', '')).toBe('Anomaly report: radar late');
  });
});
