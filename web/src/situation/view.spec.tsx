// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { describe, expect, it } from 'vitest';
import { useForTest } from '../run/session';
import { aDictionary, aRun, aStore, situation } from '../testing/fixtures';
import { aBoard, aSeat } from '../testing/positions';
import { countdownWords, roughly } from './countdown';
import { listShown, lookOf, situationOf } from './model';
import { Lasting, Situation } from './view';

// The fixtures' run: SCLK 900 is heard at 05:00:00, entry is at 1000, that is at 05:01:40.
const BLACKOUT = {
  rank: 'silence' as const,
  subject: 'uhf_live',
  sentence: 'UHF silent: plasma blackout, predicted from E−1:30 to E−1:00',
  awaited: 'UHF back',
  at: '2012-219T05:00:40.000',
  since: '2012-219T04:59:50.000',
};
const BACKUP = {
  rank: 'news' as const,
  subject: 'computer',
  sentence: 'Flying on computer B since E−1:50',
  evidence: 'event SECOND_CHANCE_TAKES_OVER',
  evidenceSeq: 7n,
  since: '2012-219T04:59:50.000',
};
const CLOSED = {
  rank: 'lasting' as const,
  subject: 'commanding',
  sentence: 'Too late for planned steps since E−2:00: what',
};

describe('the banner', () => {
  it('says what the server put first, with the others behind it, and the states that last beside the badge', () => {
    const store = aStore([situation('2012-219T04:59:55.0', BACKUP, BLACKOUT, CLOSED)]);
    const now = situationOf(store, Infinity, undefined);
    expect(now.first).toMatchObject({ sentence: BACKUP.sentence, since_e_s: -110, countdown: '' });
    expect(now.more.map((line) => [line.rank, line.countdown])).toEqual([['silence', 'UHF back in ≈ 40 s']]);
    expect(now.lasting).toEqual([
      { subject: 'commanding', words: 'Too late for planned steps', sentence: CLOSED.sentence },
    ]);
  });
  it('puts news aside but loses nothing, and shows it again when it changes; a silence cannot be put aside', () => {
    const store = aStore([situation('2012-219T04:59:55.0', BACKUP, BLACKOUT)]);
    const { first } = situationOf(store, Infinity, undefined);
    const put = new Set([first?.key ?? '', `silence uhf_live 0 ${BLACKOUT.sentence}`]);
    const after = situationOf(store, Infinity, undefined, put);
    expect(after.first?.sentence).toBe(BLACKOUT.sentence);
    expect(after.more.map((line) => [line.sentence, line.aside])).toEqual([[BACKUP.sentence, true]]);
    const changed = aStore([situation('2012-219T04:59:55.0', { ...BACKUP, evidenceSeq: 9n }, BLACKOUT)]);
    expect(situationOf(changed, Infinity, undefined, put).first?.rank).toBe('news');
  });
  it('lets danger be put aside only where it also stands beside the badge', () => {
    const danger = { ...BACKUP, rank: 'danger' as const };
    const lasting = { ...BACKUP, rank: 'lasting' as const };
    const [alone, beside] = [[danger], [danger, lasting]].map(
      (entries) => situationOf(aStore([situation('2012-219T04:59:55.0', ...entries)]), Infinity, undefined).first,
    );
    expect([alone?.mayGo, beside?.mayGo, beside && lookOf(beside)]).toEqual([false, true, 'alarm']);
  });
  it('has a lost connection above everything, also before there is a run', () => {
    const store = aStore([situation('2012-219T04:59:55.0', { ...BACKUP, rank: 'danger' })]);
    const lost = situationOf(store, Infinity, { attempt: 3 });
    expect(lost.first?.sentence).toBe('NO CONNECTION: everything here is old. Trying again, attempt 3.');
    expect(lost.more).toHaveLength(1);
    expect(situationOf(undefined, Infinity, { attempt: 1 }).first?.rank).toBe('lost');
    expect(situationOf(undefined, Infinity, undefined).first).toBeUndefined();
  });
  it('shows at a past instant what was said then, and counts from there', () => {
    const store = aStore([
      situation('2012-219T04:59:55.0', BLACKOUT),
      situation('2012-219T04:59:58.0', { ...BLACKOUT, rank: 'waiting', sentence: 'Waiting', awaited: '', at: '' }),
    ]);
    expect(situationOf(store, Infinity, undefined).first?.sentence).toBe('Waiting');
    expect(situationOf(store, 896, undefined).first).toMatchObject({
      sentence: BLACKOUT.sentence,
      countdown: 'UHF back in ≈ 44 s',
    });
    expect(situationOf(store, 890, undefined).first, 'before the first word').toBeUndefined();
  });
  it('counts nothing down while time stands still: without a connection, or after the end of the run', () => {
    const items = [situation('2012-219T04:59:55.0', BLACKOUT)];
    expect(situationOf(aStore(items), Infinity, { attempt: 1 }).more[0]?.countdown).toBe('UHF back predicted E−1:00');
    const ended = aStore(items, aRun({ state: 'finished' }));
    expect(situationOf(ended, Infinity, undefined).first?.countdown).toBe('UHF back predicted E−1:00');
  });
  it('marks each rank by a shape, and landed as good', () => {
    const store = aStore([
      situation('2012-219T04:59:55.0', { ...BACKUP, subject: 'landed' }, BLACKOUT, { ...BLACKOUT, rank: 'calm' }),
    ]);
    const { first, more } = situationOf(store, Infinity, undefined);
    expect([first, ...more].map((line) => line && lookOf(line))).toEqual(['holds', 'quiet', 'quiet']);
  });
});

it('commanding that the room has closed is a mark beside the badge, and a sentence in the list', () => {
  const run = aStore();
  run.positions = { seq: 3, board: aBoard([aSeat('flight_director', 'Ben')], { closed: 'no poll was called' }) };
  const root = document.createElement('div');
  act(() => {
    useForTest(run, aDictionary);
    render(<Lasting />, root);
  });
  const mark = () => [...root.querySelectorAll('li')].map(({ textContent, title }) => [textContent, title]);
  expect(mark()).toEqual([['Commanding is closed', 'Commanding is closed: no poll was called']]);
  act(() => {
    run.positions = { seq: 4, board: aBoard([aSeat('flight_director', 'Ben')]) };
    useForTest(run, aDictionary);
    render(<Lasting />, root);
  });
  expect(mark()).toEqual([]);
  act(() => render(null, root));
});

describe('the list of what else matters', () => {
  const listed = (...entries: Parameters<typeof situation>[1][]) => {
    const root = document.createElement('div');
    act(() => {
      useForTest(aStore([situation('2012-219T04:59:55.0', ...entries)]), aDictionary);
      listShown.value = true;
      render(<Situation />, root);
    });
    const said = [...root.querySelectorAll('[data-testid="situation-list"] li')].map((li) => li.textContent);
    act(() => {
      listShown.value = false;
      render(null, root);
    });
    return said;
  };
  it('ends with what lasts, as a whole sentence, and says none twice', () => {
    expect(listed(BLACKOUT, CLOSED)).toEqual([
      expect.stringContaining(BLACKOUT.sentence),
      expect.stringContaining(CLOSED.sentence),
    ]);
    expect(listed(CLOSED)).toEqual([expect.stringContaining(CLOSED.sentence)]);
    const lasting = { ...BACKUP, rank: 'lasting' as const };
    expect(listed(BACKUP, BLACKOUT, lasting)).toEqual([
      expect.stringContaining(BACKUP.sentence),
      expect.stringContaining(BLACKOUT.sentence),
    ]);
    expect(listed(BACKUP, lasting)).toEqual([]);
  });
});

describe('a countdown', () => {
  it('never counts to what is past', () => {
    expect([60, 99.4, 99.6, 120].map((now) => countdownWords('UHF back', 100, now, false))).toEqual([
      'UHF back in ≈ 40 s',
      'UHF back in ≈ 1 s',
      'UHF back is due',
      'UHF back is due',
    ]);
    expect(countdownWords('UHF back', 100, 120, true)).toBe('UHF back overdue since E+1:40');
    expect(countdownWords('', NaN, 120, false)).toBe('');
  });
  it('has whole seconds, as a prediction deserves', () => {
    expect([23.4, 59.6, 80, 7380].map(roughly)).toEqual(['23 s', '1 m 00 s', '1 m 20 s', '2 h 03 m']);
  });
});
