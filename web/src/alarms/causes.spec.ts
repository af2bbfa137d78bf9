// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { grouped, worstOf } from './causes';
import type { AlarmState } from './model';

const an = (name: string, fields: Partial<AlarmState> = {}): AlarmState => ({
  name,
  kind: 'limit',
  state: 'unacknowledged',
  severity: 'warning',
  worst: 'warning',
  sclk: 1100,
  ...fields,
});
const stale = (name: string, reason: string, cause = '') =>
  an(name, { kind: 'staleness', reason, cause, severity: 'watch' });
const lines = (...all: AlarmState[]) =>
  grouped(all, (name) => /^([a-z]+)_/.exec(name)?.[1], 1000).map(({ words, alarms }) => [
    words,
    alarms.map(({ name }) => name).join(' '),
  ]);

describe('alarms of one cause', () => {
  it('are one line where the ground names the cause: a lost link and the packets that are stale for it', () => {
    const link = an('uhf_live', { kind: 'link', severity: 'distress', reason: 'unexplained: nothing is predicted' });
    const lost = 'the link is lost: unexplained: nothing is predicted';
    expect(lines(an('gnc_a'), stale('Status', lost, 'uhf_live'), link, stale('Navigation', lost, 'uhf_live'))).toEqual([
      [undefined, 'gnc_a'],
      ['uhf_live is lost; 2 packets stale for it', 'uhf_live Status Navigation'],
    ]);
    const [group] = grouped([stale('Status', lost, 'uhf_live'), link], () => undefined, 1000);
    expect([group?.cause?.name, group && worstOf(group).name]).toEqual(['uhf_live', 'uhf_live']);
  });
  it('without that alarm say what the ground says of them, and no cause', () => {
    const lost = 'the link is lost: unexplained: nothing is predicted';
    const link = an('x_band', { kind: 'link', reason: 'another reason' });
    expect(lines(link, stale('Status', lost), stale('Navigation', lost))).toEqual([
      [undefined, 'x_band'],
      [`2 packets stale: ${lost}`, 'Status Navigation'],
    ]);
    expect(lines(stale('Status', ''), stale('Navigation', ''))).toEqual([
      ['2 packets stale: no reason is known', 'Status Navigation'],
    ]);
  });
  it('of one packet and one moment are named by these alone', () => {
    expect(lines(an('pyro_a'), an('gnc_a'), an('pyro_b', { sclk: 1101.5 }), an('pyro_c', { sclk: 1140 }))).toEqual([
      ['2 channels of pyro since E+1:40', 'pyro_a pyro_b'],
      [undefined, 'gnc_a'],
      [undefined, 'pyro_c'],
    ]);
  });
  it('that are over, shelved or of an unknown time stay by themselves, as one alone does', () => {
    const all = [
      an('pyro_a'),
      an('pyro_b', { state: 'shelved' }),
      an('pyro_c', { severity: 'none', state: 'returned' }),
      { ...an('pyro_d'), sclk: undefined } as unknown as AlarmState,
    ];
    expect(lines(...all).map(([words]) => words)).toEqual([undefined, undefined, undefined, undefined]);
  });
  it('lose none and double none', () => {
    const all = Array.from({ length: 40 }, (_, i) => an(`pyro_${i}`, { sclk: 1100 + ((i * 7) % 11) }));
    const found = grouped(all, () => 'pyro', 1000).flatMap(({ alarms }) => alarms);
    expect([found.length, new Set(found).size]).toEqual([40, 40]);
  });
});
