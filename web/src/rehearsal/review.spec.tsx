// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { expect, it, vi } from 'vitest';
import { useForTest } from '../run/session';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import type { Plan } from './plan';
import { Review, scoreText } from './review';
import { shareWords } from './score';
import type { Score } from './score';

const server = aServer();
const SCORE: Score = {
  facts: [
    { of: 'landing', text: 'touchdown', e_s: 431 },
    { of: 'landing', text: '4.7 km from the target, by the vehicle’s own navigation' },
  ],
  terms: [
    { name: 'landing', worth: 40, points: 40, why: 'touchdown', judged: [] },
    {
      name: 'team',
      worth: 30,
      points: 15,
      why: '3 of 3 judged',
      judged: [
        { expected: 'say it was seen', evidence: 'nothing was done', share: 0, inject: '' },
        { expected: 'switch to radar B', evidence: 'Bob, 12 s later', share: 1, e_s: 40, inject: 'a' },
        { expected: 'log it', evidence: 'Bob wrote “radar?”', share: 0.5, e_s: 20, inject: 'gone' },
      ],
    },
  ],
  sum: 100,
  rule: 'A rule of Aeolis',
  faults: [],
  acts: [],
};
const PLAN: Plan = {
  name: 'radar',
  title: 'The radar goes',
  purpose: 'Whether the room sees it.',
  scenario: '',
  injects: [
    {
      inject: 'a',
      title: 'Radar B silent',
      when: 'at E+0:12',
      does: 'radar B silent',
      shows: 'no slant ranges',
      team: ['say so'],
      state: 'done',
      e_s: 12.25,
    },
    { inject: 'b', title: 'Reset', when: '', does: '', shows: '', team: [], state: 'waiting' },
  ],
};
const NOTES = [{ e_s: 20, note: { text: 'slow', by: 'Ida' } }];

it('the review shows the facts, plan, terms and rule of the server, and asks once it is opened', async () => {
  server.routes['GET /runs/1/score'] = { json: SCORE };
  server.routes['GET /runs/1/interventions'] = { json: { interventions: NOTES } };
  server.routes['GET /runs/1/plan'] = { json: PLAN };
  const root = document.createElement('div');
  await act(() => {
    useForTest(aStore([], aRun({ state: 'finished', lastSeq: 0n })), aDictionary);
    render(<Review />, root);
  });
  expect(server.asked).toEqual([]);
  await act(async () => {
    const details = root.querySelector('details');
    if (details) details.open = true;
    details?.dispatchEvent(new Event('toggle'));
  });
  await vi.waitFor(() => expect(root.querySelector('[data-testid=review-score]')?.textContent).toBe('100 of 100'));
  expect(root.querySelector('[data-testid=review-facts]')?.textContent).toContain('E+7:11.0touchdown');
  const rows = [...root.querySelectorAll('[data-testid=review-terms] tr')];
  expect(rows[0]?.textContent).toBe('landing40.0 of 40touchdown');
  expect([...rows[1]!.querySelectorAll('li')].map((each) => each.textContent)).toEqual([
    'E+0:20.0 half log it: Bob wrote “radar?” (gone)',
    'E+0:40.0 full switch to radar B: Bob, 12 s later (Radar B silent)',
    ' none say it was seen: nothing was done',
  ]);
  const plan = root.querySelector('[data-testid=plan]');
  expect([...plan!.querySelectorAll('.inject-head')].map((each) => each.textContent)).toEqual([
    '▲ done E+0:12.3 Radar B silent at E+0:12 ',
    '– not injected Reset by hand ',
  ]);
  // nothing of it is folded away or to be pressed: it is printed
  expect([plan!.querySelector('details, button'), plan!.textContent?.includes('say so')]).toEqual([null, true]);
  expect(root.textContent).toContain('A rule of Aeolis');
});

it('a plan that cannot be had takes no score away, and the review says why', async () => {
  server.routes['GET /runs/1/score'] = { json: SCORE };
  server.routes['GET /runs/1/interventions'] = { json: { interventions: NOTES } };
  server.routes['GET /runs/1/plan'] = { status: 500, json: { error: 'run 1: its plan breaks the rules' } };
  const root = document.createElement('div');
  await act(() => {
    useForTest(aStore([], aRun({ state: 'finished', lastSeq: 1n })), aDictionary);
    render(<Review />, root);
  });
  await vi.waitFor(() =>
    expect([
      root.querySelector('[data-testid=review-score]')?.textContent,
      root.querySelector('[data-testid=review-no-plan]')?.textContent,
    ]).toEqual(['100 of 100', '✖ the instructor’s plan: run 1: its plan breaks the rules']),
  );
});

it('a share is in words, and full or none only where it is', () => {
  expect([1, 0.999, 0.5, 0.333, 0.001, 0].map(shareWords)).toEqual(['full', '99 %', 'half', '33 %', '1 %', 'none']);
});

it('the review as a text has the facts, the instructor’s notes and plan, the terms and the rule', () => {
  const text = scoreText('run 1', SCORE, NOTES, PLAN);
  for (const part of [
    'landing: E+7:11.0 touchdown',
    '4.7 km from the target',
    "instructor's note: E+0:20.0 Ida: slow",
    'score: 100 of 100',
    "the instructor's plan: The radar goes",
    '  ▲ done E+0:12.3: Radar B silent (at E+0:12)',
    '  landing: 40.0 of 40 (touchdown)',
    '    E+0:20.0 half: log it: Bob wrote “radar?”',
    'A rule of Aeolis',
  ])
    expect(text).toContain(part);
});
