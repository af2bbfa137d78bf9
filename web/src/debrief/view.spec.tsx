// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { create } from '@bufbuild/protobuf';
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, expect, it, vi } from 'vitest';
import { ForkOriginSchema } from '../gen/aeolis/v1/run_pb';
import { notes } from '../notes/model';
import type { Score } from '../rehearsal/score';
import { useForTest } from '../run/session';
import { runs } from '../run/shown';
import { aDictionary, aRun, aStore, ertUs } from '../testing/fixtures';
import { aStep, anExecution, inItem } from '../testing/procedures';
import { aServer } from '../testing/server';
import { debrief, scoresOfForks } from './model';
import { Debrief } from './view';

const server = aServer();
beforeEach(() => {
  notes.value = debrief.value = undefined;
  scoresOfForks.value = new Map();
  runs.value = [];
});

const point = (inject: string, expected: string) => ({ expected, evidence: 'nobody did', share: 0, e_s: 55, inject });
const SCORE: Score = {
  facts: [{ of: 'landing', text: 'touchdown', e_s: 400 }],
  terms: [
    {
      name: 'action',
      worth: 20,
      points: 0,
      why: '2 points judged',
      judged: [point('radar', 'sends no command for 60 s'), point('', 'sends NO_OP so that it is carried out')],
    },
  ],
  sum: 31.4,
  rule: 'A rule of Aeolis',
  faults: [
    {
      text: 'radar A silent',
      inject: 'radar',
      e_s: 50,
      felt_e_s: 50,
      signs: [{ name: 'RADAR_LOST', on_board_e_s: 51 }],
      not_judged: ['writes of “radar” in the log within 60 s: no sign of it was received'],
    },
  ],
  acts: [{ kind: 'command', e_s: 70, by: 'Bob', text: 'sent NO_OP' }],
};
const PLAN = {
  name: 'radar',
  title: 'The radar goes',
  purpose: 'Whether the room sees it.',
  scenario: '',
  injects: [
    {
      inject: 'radar',
      title: 'Radar A silent',
      when: 'at E+0:50',
      does: '',
      shows: 'no ranges',
      team: [],
      state: 'done',
    },
    { inject: 'reset', title: 'Reset', when: '', does: '', shows: '', team: [], state: 'waiting' },
  ],
};
const asked = () => server.asked.map(({ path }) => path);

async function shown(run = aRun({ state: 'finished', outcome: 'touchdown' })): Promise<HTMLElement> {
  const root = document.createElement('div');
  await act(() => {
    useForTest(aStore([], run), aDictionary);
    render(<Debrief />, root);
  });
  await vi.waitFor(() => expect(root.textContent).not.toContain('asking the server'));
  return root;
}
const part = (root: HTMLElement, name: string) => root.querySelector(`[data-testid=debrief-${name}]`);

it('a run that is over has its injects against reactions, missed steps, forks and score on one page', async () => {
  server.routes['GET /runs/1/score'] = { json: SCORE };
  server.routes['GET /runs/2/score'] = { json: { ...SCORE, sum: 88 } };
  server.routes['GET /runs/1/interventions'] = {
    json: { interventions: [{ e_s: 60, note: { text: 'slow', by: 'Ida' } }] },
  };
  server.routes['GET /runs/1/plan'] = { json: PLAN };
  const skipped = anExecution({ steps: [aStep('look', { state: 'skipped', by: 'Ann', reason: 'no time' })] });
  server.routes['GET /runs/1/procedures'] = { json: { procedures: [inItem(skipped)] } };
  const note = (seq: string, text: string, reads_back: string) => ({
    seq,
    ert_us: String(ertUs('2012-219T05:01:50.0')),
    note: { text, by: 'Bob', call: 'seen', reads_back },
  });
  server.routes['GET /runs/1/notes'] = {
    json: { notes: [note('4', 'GNC: Seen', '0'), note('5', 'Lost', '0'), note('6', 'reads back', '4')] },
  };
  const forkedFrom = create(ForkOriginSchema, { run: 1n, eS: 20 });
  runs.value = [
    aRun({ run: 3n, state: 'running', forkedFrom: { ...forkedFrom, run: 7n } }),
    aRun({ run: 2n, state: 'finished', outcome: 'lost', forkedFrom }),
  ];
  const root = await shown();
  expect(part(root, 'faults')?.textContent).toContain('Radar A silent planned at E+0:50');
  expect(part(root, 'faults')?.textContent).toContain('no sign of it was received');
  expect(part(root, 'faults')?.textContent).toContain('the recording alone has it');
  expect(part(root, 'not-done')?.textContent).toContain('not injected Reset');
  const rows = [...root.querySelectorAll('.debrief-timeline tbody tr')].map((row) => [
    row.getAttribute('data-side'),
    row.querySelector('.wraps')?.textContent,
  ]);
  expect(rows).toEqual([
    ['instructor', '▲ Radar A silent'],
    ['instructor', 'Ida slow'],
    ['room', 'Bob sent NO_OP'],
    ['received', 'touchdown'],
  ]);
  expect(part(root, 'procedures')?.textContent).toContain('by Ann: no time');
  expect(part(root, 'calls')?.textContent).toContain('2 calls were made, 1 of them not read back');
  expect(part(root, 'calls')?.textContent).toContain('Bob Lost');
  expect([...root.querySelectorAll('[data-fork]')].map((row) => row.getAttribute('data-fork'))).toEqual(['2']);
  await vi.waitFor(() => expect(part(root, 'forks')?.textContent).toContain('lost88 of 100'));
  expect(part(root, 'forks')?.querySelector('a')?.getAttribute('href')).toBe('?panel=debrief&run=2');
  expect(part(root, 'sum')?.textContent).toBe('31 of 100');
  // each point once: that of the inject stands with it
  expect(part(root, 'score')?.textContent).not.toContain('sends no command for 60 s');
  expect(part(root, 'score')?.textContent).toContain('sends NO_OP so that it is carried out');
  expect(part(root, 'faults')?.textContent).toContain('sends no command for 60 s: nobody did');
  expect(document.title).toBe('Aeolis debrief of run 1');
  expect(asked().filter((path) => path === '/runs/1/score')).toHaveLength(1);
});

it('what is hidden while a fork goes on stays hidden, and the page says why; the room has its procedures', async () => {
  const refusal = {
    status: 403,
    json: { error: 'what an instructor does is told when the run and its forks are over' },
  };
  for (const what of ['score', 'interventions', 'plan']) server.routes[`GET /runs/1/${what}`] = refusal;
  server.routes['GET /runs/1/procedures'] = { json: { procedures: [] } };
  server.routes['GET /runs/1/notes'] = { json: { notes: [] } };
  const root = await shown();
  expect(part(root, 'no-score')?.textContent).toContain('is told when the run and its forks are over');
  expect([part(root, 'faults'), part(root, 'timeline'), part(root, 'score')]).toEqual([null, null, null]);
  expect(part(root, 'procedures')?.textContent).toContain('No procedure was begun.');
});

it('a run without a plan has a debrief too, and one that goes on has none', async () => {
  server.routes['GET /runs/1/score'] = { json: { ...SCORE, faults: [], acts: [], terms: [] } };
  server.routes['GET /runs/1/interventions'] = { json: {} };
  server.routes['GET /runs/1/plan'] = { json: { ...PLAN, name: '', injects: [] } };
  server.routes['GET /runs/1/procedures'] = { json: { procedures: [] } };
  server.routes['GET /runs/1/notes'] = { json: { notes: [] } };
  const root = await shown();
  expect(part(root, 'faults')?.textContent).toContain('Nothing was injected.');
  expect(part(root, 'timeline')?.textContent).toContain('Nobody acknowledged, wrote, sent or signed anything');
  expect(part(root, 'forks')?.textContent).toContain('No fork of this run was tried.');
  const going = await shown(aRun({ state: 'running' }));
  expect(part(going, 'not-over')?.textContent).toContain('It has a debrief when it is over.');
  const cut = await shown(aRun({ state: 'interrupted' }));
  expect(part(cut, 'not-over')?.textContent).toContain('can be continued');
});
