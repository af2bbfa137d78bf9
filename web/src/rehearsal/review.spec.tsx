// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { expect, it, vi } from 'vitest';
import { useForTest } from '../run/session';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { Review, scoreText } from './review';
import type { Score } from './review';

const server = aServer();
const SCORE: Score = {
  facts: [
    { of: 'landing', text: 'touchdown', e_s: 431 },
    { of: 'landing', text: '4.7 km from the target, by the vehicle’s own navigation' },
  ],
  terms: [{ name: 'landing', worth: 40, points: 40, why: 'touchdown' }],
  sum: 100,
  rule: 'A rule of Aeolis',
};
const NOTES = [{ e_s: 20, note: { text: 'slow', by: 'Ida' } }];

it('the review shows the facts, terms and rule of the server, and asks once it is opened', async () => {
  server.routes['GET /runs/1/score'] = { json: SCORE };
  server.routes['GET /runs/1/interventions'] = { json: { interventions: NOTES } };
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
  expect(root.querySelector('[data-testid=review-terms]')?.textContent).toBe('landing40.0 of 40touchdown');
  expect(root.textContent).toContain('A rule of Aeolis');
});

it('the review as a text has the facts, the instructor’s notes, the terms and the rule', () => {
  const text = scoreText('run 1', SCORE, NOTES);
  for (const part of [
    'landing: E+7:11.0 touchdown',
    '4.7 km from the target',
    "instructor's note: E+0:20.0 Ida: slow",
    'score: 100 of 100',
    '  landing: 40.0 of 40 (touchdown)',
    'A rule of Aeolis',
  ])
    expect(text).toContain(part);
});
