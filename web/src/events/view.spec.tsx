// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { SOURCES, STATUS } from '../design/status';
import { aStore, event, explanation, situation } from '../testing/fixtures';
import { LEVELS, eventLines, levelShape, sourceWords } from './model';

const all = { from: 'DIAGNOSTIC', search: '', range: undefined } as const;

describe('events', () => {
  it('stand with the explanation of their moment', () => {
    const store = aStore([
      event({ name: 'PARACHUTE_DEPLOY', sclk: 900 }),
      explanation({ sclk: 900, decision: 'parachute', verdict: 'fired', text: 'speed 404.6 ≤ 405' }),
    ]);
    expect(eventLines(store, all, 10).lines).toMatchObject([{ name: 'PARACHUTE_DEPLOY', why: ['speed 404.6 ≤ 405'] }]);
  });
  it('are hidden below the chosen level, warnings counted', () => {
    const store = aStore([event({ name: 'A', level: 'DIAGNOSTIC' }), event({ name: 'B', level: 'WARNING_LO' })]);
    expect(eventLines(store, { ...all, from: 'ACTIVITY_LO' }, 10)).toMatchObject({
      lines: [{ name: 'B' }],
      warnings: 1,
    });
  });
  it('keep to the range of a past view and to the words searched', () => {
    const store = aStore([
      event({ name: 'EARLY', sclk: 800, text: 'one' }),
      event({ name: 'LATE', sclk: 950, text: 'two' }),
    ]);
    expect(eventLines(store, { ...all, range: { from: -250, to: -100 } }, 10).lines.map((line) => line.name)).toEqual([
      'EARLY',
    ]);
    expect(eventLines(store, { ...all, search: 'TWO' }, 10).lines.map((line) => line.name)).toEqual(['LATE']);
  });
  it('have levels whose shapes differ, and none of which says how something is known, or that it is good', () => {
    const shapes = [...LEVELS, 'why'].map(levelShape);
    expect(new Set(shapes).size).toBe(shapes.length);
    for (const { shape } of [...Object.values(SOURCES), STATUS.good, STATUS.unknown, STATUS.never])
      expect(shapes).not.toContain(shape);
    expect(
      [
        [true, false],
        [false, true],
        [true, true],
      ].map(([live = false, recorded = false]) => sourceWords({ live, recorded, ground: false }).shape),
    ).toEqual(['◆', '▣', '◆▣']);
    expect(sourceWords({ live: true, recorded: false, ground: true }).words).toBe('made on ground');
  });
  it('have what the ground itself lost or found among them, once, and not what it repeats of an event', () => {
    const lost = {
      rank: 'danger' as const,
      subject: 'station',
      sentence: 'A fault on the ground',
      evidence: 'the station',
    };
    const over = { rank: 'lasting' as const, subject: 'loss of station', sentence: 'Station was lost from E−1:50' };
    const landed = { rank: 'news' as const, subject: 'landed', sentence: 'Touchdown confirmed', evidence: 'told' };
    const told = { ...landed, subject: 'computer', sentence: 'On the backup', evidence: 'event SECOND_CHANCE' };
    const store = aStore([
      situation('2012-219T04:59:52.0', lost),
      situation('2012-219T04:59:55.0', { ...lost, sentence: 'A fault on the ground, and Earth sets meanwhile' }, told),
      situation('2012-219T04:59:58.0', landed, over, { rank: 'waiting', subject: 'recording', sentence: 'Waiting' }),
    ]);
    const { lines, alarms, warnings } = eventLines(store, { ...all, from: 'ACTIVITY_LO' }, 10);
    expect([alarms, warnings]).toEqual([1, 0]);
    expect(lines.map(({ text, level, e_s }) => [text, level, Math.round(e_s)])).toEqual([
      ['Touchdown confirmed', 'ACTIVITY_HI', -102],
      ['Station was lost from E−1:50', 'ACTIVITY_HI', -102],
      ['A fault on the ground', 'WARNING_HI', -108],
    ]);
    expect(eventLines(store, { ...all, range: { from: -300, to: -105 } }, 10).lines).toHaveLength(1);
  });
  it('are alarms where the banner has them so, by the banner’s name; the flight’s own words follow', () => {
    const told = event({ name: 'SECOND_CHANCE', sclk: 890, level: 'WARNING_HI', text: 'Prime is silent' });
    const backup = {
      rank: 'danger' as const,
      subject: 'computer',
      sentence: 'Flying on backup computer B since E−1:50: it took over',
      evidence: 'event SECOND_CHANCE',
      since: '2012-219T04:59:50.000',
    };
    const { lines, alarms, warnings } = eventLines(aStore([told, situation('2012-219T04:59:52.0', backup)]), all, 10);
    expect([alarms, warnings]).toEqual([1, 0]);
    expect(lines).toMatchObject([{ named: 'Flying on backup computer B', text: 'Prime is silent', alarm: true }]);
  });
  it('beyond what is shown are counted', () => {
    const store = aStore(['A', 'B', 'C'].map((name, i) => event({ name, sclk: 900 + i })));
    expect(eventLines(store, all, 2)).toMatchObject({ lines: [{ name: 'C' }, { name: 'B' }], found: 3 });
  });
});
