// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { aRun, aStore, ertUs, event, link, tone } from '../testing/fixtures';
import { LinkChange_Silence } from '../gen/aeolis/v1/items_pb';
import { readReleaseAt } from '../commands/model';
import { badgeOf, clocksOf, headerLinks, latestSend, linksOf, streamLine } from './model';

describe('the header', () => {
  it('shows one instant on every clock, a light time apart', () => {
    const run = aRun({ lightTimeS: 100 });
    if (run.clocks) run.clocks = { ...run.clocks, lightTimeS: 100, seenSclk: 800, sclk: 900, eS: -100 };
    const { entry, others } = clocksOf(aStore([], run), undefined);
    const of = (id: string) => others.find((clock) => clock.id === id)?.value;
    expect(entry).toBe('E−3:20');
    expect([of('ert'), of('scet'), of('sclk'), of('mars-now')]).toEqual([
      '2012-219T05:00:00.0',
      '2012-219T04:58:20.0',
      '800.000',
      'E−1:40',
    ]);
  });
  it('counts down to the latest time to send, as the ground has it', () => {
    const run = aRun({ lightTimeS: 10 });
    if (run.clocks)
      run.clocks = {
        ...run.clocks,
        lightTimeS: 10,
        eS: -90,
        latestUsefulUs: ertUs('2012-219T05:02:44.000'),
        usefulBefore: 'coolant_vent',
      };
    const store = aStore([], run);
    const send = latestSend(store);
    expect(send).toEqual({ next: { name: 'coolant_vent', at: 'E+1:04', left_s: 164 } });
    expect(readReleaseAt(send?.next?.at ?? '', store), 'as it is typed for a command that waits').toMatch(
      /^2012-219T05:02:44/,
    );
  });
  it('has no deadline where nothing useful can arrive, and none where the run has no clocks', () => {
    expect(latestSend(aStore())).toEqual({ next: undefined });
    const run = aRun({ state: 'finished' });
    delete (run as { clocks?: unknown }).clocks;
    expect(latestSend(aStore([], run))).toBeUndefined();
  });
  it('has a dash for every clock that nobody knows, of another mission that is followed', () => {
    const run = aRun({ venue: 'downlink', entrySclk: 0 });
    const of = (clocks: Partial<NonNullable<typeof run.clocks>>) => {
      const store = aStore([], {
        ...run,
        clocks: run.clocks && { ...run.clocks, ertUs: undefined, scetUs: undefined, ...clocks },
      });
      const { entry, others } = clocksOf(store, undefined);
      return [entry, ...others.map((clock) => clock.value), latestSend(store)];
    };
    expect(of({ sclk: 0, seenSclk: 0 })).toEqual(['E —', '—', '—', '—', '—', undefined]);
    expect(of({ sclk: 397500668, seenSclk: 397500668 })).toEqual(['E —', '—', '—', '397500668.000', '—', undefined]);
  });
  it('knows nothing of a link while nothing comes, but of the past what it was', () => {
    const store = aStore([link({ link: 'uhf_live', up: true, ert: '2012-219T04:59:00.0' })]);
    expect([linksOf(store, Infinity, true)[0], linksOf(store, 890, true)[0]?.look]).toEqual([
      { name: 'UHF', look: 'unknown', detail: 'not known: no connection', short: 'not known' },
      'up',
    ]);
  });
  it('cannot be taken for another mode', () => {
    const titles = [
      badgeOf(undefined, undefined),
      badgeOf(aStore(), undefined),
      badgeOf(aStore(), { from: 0, to: 10 }),
      badgeOf(aStore([], aRun({ state: 'finished', outcome: 'touchdown' })), undefined),
      badgeOf(aStore([], aRun({ state: 'interrupted' })), undefined),
    ].map((badge) => badge.title);
    expect(titles).toEqual(['NO RUN', 'REHEARSAL', 'PAST, NOT LIVE', 'ENDED RUN', 'INTERRUPTED RUN']);
  });
  it('says why a link is silent, and that there is no connection', () => {
    const store = aStore([link({ link: 'uhf_live', up: false, reason: 'plasma outage', ert: '2012-219T04:59:00.0' })]);
    expect(linksOf(store, Infinity)).toEqual([
      { name: 'UHF', look: 'down', detail: 'silent: plasma outage', short: 'silent: plasma outage' },
    ]);
    const [whole] = linksOf(
      aStore([
        link({ link: 'uhf_live', up: false, reason: 'Earth set: predicted at E+4:57', ert: '2012-219T04:59:00.0' }),
      ]),
      Infinity,
    );
    expect([whole?.short, whole?.detail]).toEqual(['silent: Earth set', 'silent: Earth set: predicted at E+4:57']);
    expect(streamLine('lost', 0)).toMatchObject({ name: 'NO CONNECTION', look: 'lost', detail: '' });
  });
  it('keeps a link that the plan has off out of the header, until it is due or lost', () => {
    const kindOf = (reason: string) =>
      reason.startsWith('not begun')
        ? LinkChange_Silence.not_begun
        : reason.startsWith('switched off')
          ? LinkChange_Silence.switched_off
          : LinkChange_Silence.unexplained;
    const of = (uhf: string, telemetry: string, lost = false) =>
      headerLinks(
        aStore(
          [
            { name: 'uhf_live', reason: uhf },
            { name: 'x_band_telemetry', reason: telemetry },
          ].map(({ name, reason }) =>
            link({ link: name, up: reason === '', reason, silence: kindOf(reason), ert: '2012-219T04:59:00.0' }),
          ),
        ),
        Infinity,
        lost,
      ).map((line) => line.name);
    expect(of('not begun: planned at E−13:20', '')).toEqual(['X-band telemetry']);
    expect(of('', 'switched off: X-band sends tones from E−12:30')).toEqual(['UHF']);
    expect(of('', 'switched off: X-band sends tones from E−12:30', true)).toEqual(['UHF']); // nor when lost
    expect(of('switched off: planned at E+7:30', 'unexplained: nothing is predicted to silence it now')).toEqual([
      'UHF',
      'X-band telemetry',
    ]);
  });
  it('has room for the links of a pass: those of orbiters are one entry that names what is up', () => {
    const ert = '2012-219T04:59:00.0';
    const store = aStore(
      ['uhf_live', 'x_band', 'relay', 'uhf_mro', 'uhf_mex'].map((name) =>
        link({
          link: name,
          up: name !== 'relay' && name !== 'uhf_mex',
          reason: name === 'relay' ? 'below the horizon' : '',
          ert,
        }),
      ),
    );
    expect(headerLinks(store, Infinity).map((line) => [line.name, line.look, line.detail])).toEqual([
      ['UHF', 'up', 'received'],
      ['X-band', 'up', 'received'],
      ['3 relay links', 'up', 'received: UHF MRO'],
    ]);
    const failed = aStore(
      ['uhf_live', 'x_band', 'relay', 'uhf_mro', 'uhf_mex'].map((name) =>
        link({
          link: name,
          up: name === 'uhf_mex',
          reason: name === 'relay' ? 'ground fault: the station is silent' : '',
          lost: name === 'relay',
          ert,
        }),
      ),
    );
    expect(headerLinks(failed, Infinity)[2], 'one that is missed comes before those that are up').toEqual({
      name: '3 relay links',
      look: 'lost',
      detail: 'Relay lost: ground fault: the station is silent',
      short: 'Relay lost: ground fault: the station is silent',
    });
  });
  it('says first that nothing is stored, in the words of the disk', () => {
    expect(headerLinks(aStore([], aRun({ archiveFault: 'a.db: the disk is full' })), Infinity)).toEqual([
      { name: 'NOT STORED', look: 'lost', detail: 'a.db: the disk is full', short: 'a.db: the disk is full' },
    ]);
  });
  it('says that this server follows another, whether that one is heard, and what followers do not have', () => {
    const follows = 'follows the archive 01234567; 12 items behind';
    expect(headerLinks(aStore([], aRun({ follows })), Infinity)).toEqual([
      { name: 'FOLLOWER', look: 'up', detail: follows, short: 'follows' },
    ]);
    expect(headerLinks(aStore([], aRun({ follows, originLost: true })), Infinity)).toEqual([
      { name: 'FOLLOWER', look: 'lost', detail: follows, short: 'origin lost' },
    ]);
    expect(headerLinks(aStore([], aRun({ unpublished: '12 items wait' })), Infinity)).toEqual([
      { name: 'NOT PUBLISHED', look: 'lost', detail: '12 items wait', short: '12 items wait' },
    ]);
  });
  it('of a run of the day before, which has no clocks any more, go by what it holds', () => {
    const run = aRun({ state: 'finished', lightTimeS: 100 });
    delete (run as { clocks?: unknown }).clocks;
    const store = aStore(
      [
        tone({ sclk: 900, tone: 7, ertStart: '2012-219T05:00:00.0' }),
        event({ id: 1, name: 'TOUCHDOWN', sclk: 1431, ert: '2012-219T05:08:52.0' }),
        link({ link: 'uhf_live', up: false, reason: 'plasma blackout', ert: '2012-219T05:02:30.0' }),
      ],
      run,
    );
    const { entry, others } = clocksOf(store, undefined);
    expect([
      entry,
      others.find((clock) => clock.id === 'ert')?.value,
      others.find((clock) => clock.id === 'scet')?.value,
    ]).toEqual(['E+7:11', '2012-219T05:08:51.0', '2012-219T05:07:11.0']);
    expect(linksOf(store, 1000)[0]?.look).toBe('unknown');
    expect(linksOf(store, 1050)[0]?.look).toBe('down');
  });
});
