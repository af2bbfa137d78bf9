// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { aRun } from '../testing/fixtures';
import { MODES, isReal, modeOf, panelMark, resumedWords } from './model';
import css from './style.css?raw';

const going = (venue: string) => ({ run: aRun({ venue }), going: true });

describe('the mode', () => {
  it('is a rehearsal unless the run follows a real downlink, whatever its venue is called', () => {
    expect(
      ['rehearsal', '', 'performance', 'LIVE', 'flight'].map((venue) => modeOf(going(venue), false, false)),
    ).toEqual(Array(5).fill('rehearsal'));
    expect(modeOf(going('downlink'), false, false)).toBe('live');
    expect(isReal(aRun({ venue: 'downlink' }))).toBe(true);
  });
  it('of a past view comes before all else: neither a rehearsal nor the real thing looks live in it', () => {
    for (const venue of ['rehearsal', 'downlink']) {
      expect(modeOf(going(venue), true, false)).toBe('range');
      expect(modeOf(going(venue), true, true)).toBe('replay');
      expect(modeOf({ ...going(venue), going: false }, true, false)).toBe('range');
      expect(modeOf({ ...going(venue), going: false }, false, false)).toBe('ended');
    }
    expect(modeOf(undefined, false, false)).toBe('none');
  });
  it('differs in badge, mark, shape, colour and pattern of border from every other', () => {
    for (const part of ['badge', 'mark', 'shape'] as const)
      expect(new Set(Object.values(MODES).map((each) => each[part])).size).toBe(6);
    for (const mode of ['live', 'rehearsal', 'ended', 'range', 'replay'])
      expect(css).toMatch(new RegExp(`\\.mode-${mode} \\{\\s*--mode: var\\(--mode-${mode}\\);`));
    const border = (mode: string) => new RegExp(`\\.mode-${mode} \\{[^}]*\\}`).exec(css)?.[0].replaceAll(mode, '');
    expect(new Set(['range', 'replay', 'ended', 'live'].map(border)).size).toBe(4);
  });
  it('in a panel says of the past where it happened', () => {
    expect(panelMark('replay', aRun())).toBe('replay, rehearsal');
    expect(panelMark('range', aRun({ venue: 'downlink' }))).toBe('past, real venue');
    expect(panelMark('rehearsal', aRun())).toBe('rehearsal');
  });
});

describe('a break of the connection', () => {
  it('says since when, what was filled in, and whether the server went on without us', () => {
    const break_ = { after: 1200, through: 1612, attempts: 3 };
    expect(resumedWords(break_, aRun(), 80)).toBe(
      'The connection was lost at E+1:20 and is back at attempt 3: numbers 1201 to 1612, which came meanwhile, were filled in from the archive, none is missing.',
    );
    expect(resumedWords({ ...break_, through: 1200 }, aRun(), 80)).toContain('nothing had come meanwhile');
    expect(resumedWords(break_, aRun({ state: 'interrupted' }), 80)).toContain(
      'this run was cut off at number 1612; continue it under Runs',
    );
    expect(resumedWords(break_, aRun({ state: 'interrupted', venue: 'downlink' }), 80)).toMatch(
      /cut off at number 1612, and cannot be continued: what is followed after it is another run\.$/,
    );
  });
});
