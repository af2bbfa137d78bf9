// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, beforeEach, describe, expect, it } from 'vitest';
import { access } from '../access/model';
import { useForTest } from '../run/session';
import { pastRange, replay, runs, store, watched } from '../run/shown';
import type { ToWorker } from '../stream/messages';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import { attainedText, nextPace } from './model';
import { PaceBar, changePace, togglePause } from './pace';
import { forgetPlan } from './plan_choice';
import { Rehearsal } from './view';

describe('the pace', () => {
  it('steps up to as fast as it goes, and down to one', () => {
    expect([
      nextPace(1, 1),
      nextPace(1000, 1),
      nextPace(0, 1),
      nextPace(0, -1),
      nextPace(1, -1),
      nextPace(3, 1),
    ]).toEqual([2, 0, 0, 1000, 1, 5]);
  });
  it('is told when it is not reached', () => {
    expect([attainedText(100, 99), attainedText(100, 42), attainedText(0, 512)]).toEqual([
      '',
      'reaches 42×',
      'reaches 512×',
    ]);
  });
});

describe('a rehearsal', () => {
  const server = aServer();
  let root: HTMLElement;
  let heard: ToWorker[];
  const shown = (run = aRun()) =>
    act(() => {
      heard = [];
      runs.value = [run];
      useForTest(aStore([], run), aDictionary, (message) => void heard.push(message));
      render(
        <>
          <PaceBar />
          <Rehearsal />
        </>,
        root,
      );
    });
  const button = (id: string) => root.querySelector<HTMLButtonElement>(`[data-testid="${id}"]`);
  beforeEach(() => {
    root = document.createElement('div');
    document.body.append(root);
    access.value = { state: 'open' };
  });
  afterEach(() => {
    act(() => render(null, root));
    root.remove();
    runs.value = [];
    watched.value = 0;
    access.value = { state: 'asking' };
  });
  it('that is refused leaves on the screen what is looked at, and says why beside the button', async () => {
    shown(aRun({ state: 'finished', outcome: 'touchdown' }));
    watched.value = 1;
    server.routes['POST /rehearsals'] = { status: 409, json: { error: 'run 2 is going on' } };
    await act(async () => {
      button('start-rehearsal')?.click();
      await new Promise((resolve) => setTimeout(resolve, 20));
    });
    expect([
      root.querySelector('[data-testid="rehearsal-problem"]')?.textContent,
      store.value?.id,
      watched.value,
    ]).toEqual(['✖ run 2 is going on', 1, 1]);
    server.routes['POST /rehearsals'] = { status: 201, json: {} };
    await act(async () => {
      button('start-rehearsal')?.click();
      await new Promise((resolve) => setTimeout(resolve, 20));
    });
    expect([watched.value, heard.map((each) => each.type)]).toEqual([0, ['watch']]);
    expect(server.asked.at(-1)?.body).toEqual({ scenario: 'nominal', seed: '1', pace: 1 });
  });
  it('ends for everyone only by a second press in place; leaving the button takes the first one back', () => {
    shown();
    act(() => button('stop-rehearsal')?.click());
    expect([heard, button('stop-rehearsal')?.textContent]).toEqual([[], '▲ press again: run 1 ends for everyone']);
    act(() => void button('stop-rehearsal')?.dispatchEvent(new FocusEvent('blur')));
    act(() => button('stop-rehearsal')?.click());
    expect(heard).toEqual([]);
    act(() => button('stop-rehearsal')?.click());
    expect(heard).toEqual([{ type: 'control', run: 1, control: { action: 'stop' } }]);
  });
  it('jumps to its next act, says so while it does, and refuses a time that has passed', async () => {
    shown();
    const field = root.querySelector<HTMLInputElement>('[data-testid="jump-to"]') as HTMLInputElement;
    const type = (text: string) =>
      act(() => {
        field.value = text;
        field.dispatchEvent(new InputEvent('input', { bubbles: true }));
      });
    type('E-0:02:00');
    expect([button('jump')?.disabled, button('jump-words')?.textContent]).toEqual([
      true,
      '✖ E−2:00 has passed at the vehicle',
    ]);
    type('soon');
    expect(button('jump-words')?.textContent).toBe('✖ a time from entry, such as E-0:47:00');
    type('E-0:00:30');
    server.routes['POST /rehearsals/current'] = { status: 202, json: {} };
    await act(async () => {
      button('jump')?.click();
      await new Promise((resolve) => setTimeout(resolve, 20));
    });
    expect(server.asked.at(-1)?.body).toEqual({ run: 1, jump: 'E-30' });
    expect(field.value).toBe('');
    type('E+0:47:00');
    act(() => button('jump')?.click());
    expect([server.asked.length, button('jump')?.textContent]).toEqual([1, '▲ press again: it flies past entry']);
    type('E-0:00:20');
    expect(button('jump')?.textContent).toBe('jump there');
    shown(aRun({ jumpsToES: -30 }));
    expect(button('attained')?.textContent).toBe('jumps to E−0:30');
  });
  it('that is continued says what is known of how far it is, and can be left to itself: then nothing is shown unasked', async () => {
    let answer: (_: object) => void = () => undefined;
    server.routes['POST /rehearsals'] = () => new Promise((resolve) => (answer = resolve as typeof answer));
    for (const leave of [true, false]) {
      shown(aRun({ state: 'interrupted', lastSeq: 4711n }));
      act(() => button('continue-1')?.click());
      const bar = button('catching-up');
      expect([bar?.querySelector('progress')?.hasAttribute('value'), bar?.textContent]).toEqual([
        false,
        expect.stringContaining('through its 4711 items'),
      ]);
      if (leave) {
        act(() => bar?.querySelector('button')?.click());
        expect([button('catching-up'), root.textContent]).toEqual([
          null,
          expect.stringContaining('catches up by itself'),
        ]);
      }
      await act(async () => {
        await new Promise((resolve) => setTimeout(resolve, 10));
        answer({ status: 201, json: {} });
        await new Promise((resolve) => setTimeout(resolve, 20));
      });
      expect([heard.map((each) => each.type), root.textContent?.includes('catches up by itself')]).toEqual([
        leave ? [] : ['watch'],
        false,
      ]);
    }
  });
  it('is not ended, continued or started from a past view, and says nothing there of what came later', () => {
    const clicks = () =>
      root.querySelectorAll<HTMLButtonElement>('button').forEach((each) => {
        if (!each.disabled) act(() => each.click());
      });
    shown(aRun({ lastSeq: 4711n }));
    expect(root.querySelector('[data-run="1"]')?.textContent).toContain('4711');
    for (const [state, replayed] of [
      ['running', false],
      ['interrupted', false],
      ['running', true],
    ] as const) {
      act(() => {
        pastRange.value = { from: -100, to: 0 };
        if (replayed) replay.value = { pace: 1, playing: false };
      });
      shown(aRun({ state, lastSeq: 4711n, outcome: 'impact' }));
      const row = root.querySelector('[data-run="1"]')?.textContent;
      expect(row).toContain('◧ past');
      for (const now of [state, '4711', 'hit the ground']) expect(row).not.toContain(now);
      expect([
        button('stop-rehearsal'),
        root.querySelector('[data-testid="instructor"]'),
        button('start-rehearsal')?.disabled,
      ]).toEqual([null, null, true]);
      expect(root.textContent).toContain('from a past view nothing is started or ended');
      clicks();
      clicks();
      expect([heard, server.asked.filter((each) => each.method !== 'GET')]).toEqual([[], []]);
      act(() => {
        [pastRange.value, replay.value] = [undefined, undefined];
      });
    }
  });
  it('is never offered beside a real vehicle: no instructor, no end, no pace', () => {
    shown(aRun({ venue: 'downlink' }));
    expect([
      root.querySelector('[data-testid="instructor"]'),
      button('stop-rehearsal'),
      root.textContent?.includes('a real landing is followed'),
    ]).toEqual([null, null, true]);
    changePace(1);
    togglePause();
    expect(heard).toEqual([]);
    shown();
    expect([root.querySelector('[data-testid="instructor"]'), button('stop-rehearsal')]).not.toContain(null);
  });
  it('that was cut off is offered to be continued, a real landing that was followed is not', () => {
    shown(aRun({ state: 'interrupted' }));
    expect(button('continue-1')?.textContent).toBe('continue');
    shown(aRun({ state: 'interrupted', venue: 'downlink' }));
    expect([
      button('continue-1'),
      root.querySelector('[data-run="1"]')?.textContent?.includes('▲ interrupted'),
    ]).toEqual([null, true]);
  });
  describe('with a plan', () => {
    const soon = () => act(() => new Promise<void>((done) => setTimeout(done, 20)));
    const PLANS = {
      plans: [
        { name: 'radar', title: 'The radar goes', purpose: 'Who sees it?', scenario: 'nominal', injects: 2 },
        { name: 'dsn', title: '', purpose: 'No station.', scenario: 'dust', injects: 1 },
      ],
    };
    const choose = (value: string) =>
      act(() => {
        const select = button('plan-choice') as unknown as HTMLSelectElement;
        select.value = value;
        select.dispatchEvent(new Event('change', { bubbles: true }));
      });
    const press = async () => {
      act(() => button('start-rehearsal')?.click());
      await soon();
    };
    const give = async (file: File) => {
      const field = button('plan-file') as unknown as HTMLInputElement;
      Object.defineProperty(field, 'files', { value: [file], configurable: true });
      act(() => void field.dispatchEvent(new Event('change', { bubbles: true })));
      await soon();
    };
    const posted = () => server.asked.filter((each) => each.method === 'POST').map((each) => each.body);
    const over = async () => {
      shown(aRun({ state: 'finished', outcome: 'touchdown' }));
      await soon();
    };
    beforeEach(() => {
      server.routes['GET /plans'] = { json: PLANS };
      server.routes['POST /rehearsals'] = { status: 201, json: {} };
    });
    afterEach(() => forgetPlan());
    it('offers all, says for which scenario another was written, and forgets the choice once the run began', async () => {
      await over();
      const options = () => [...button('plan-choice')!.querySelectorAll('option')].map((each) => each.textContent);
      expect(options()).toEqual(['none', 'The radar goes', 'dsn (written for dust)', 'a file of your own']);
      choose('dsn');
      expect(button('plan-chosen')?.textContent).toBe('dsn: No station. 1 inject ▲ written for dust');
      await press();
      expect(posted()).toEqual([{ scenario: 'nominal', seed: '1', pace: 1, plan: 'dsn' }]);
      await over();
      expect((button('plan-choice') as unknown as HTMLSelectElement).value).toBe('');
    });
    it('of a file sends its text, and shows the server’s findings line by line', async () => {
      await over();
      choose('/');
      expect([button('start-rehearsal')?.disabled, root.textContent]).toEqual([
        true,
        expect.stringContaining('choose the file of the plan'),
      ]);
      await give(new File([new Uint8Array(256 * 1024 + 1)], 'long.yaml'));
      expect([button('start-rehearsal')?.disabled, root.textContent]).toEqual([
        true,
        expect.stringContaining('long.yaml has 262145 octets; a plan has at most 262144'),
      ]);
      await give(new File([], 'none.yaml'));
      expect([button('start-rehearsal')?.disabled, root.textContent]).toEqual([
        true,
        expect.stringContaining('none.yaml is empty'),
      ]);
      await give(new File(['title: x\n'], 'mine.yaml'));
      expect(button('plan-file-name')?.textContent).toBe('mine.yaml');
      const findings = 'mine.yaml:1:1: no injects\nmine.yaml:2:3: no such device';
      server.routes['POST /rehearsals'] = { status: 422, json: { error: findings } };
      await press();
      const problem = button('rehearsal-problem') as HTMLElement;
      expect([problem.textContent, getComputedStyle(problem).whiteSpace]).toEqual([`✖ ${findings}`, 'pre-line']);
      server.routes['POST /rehearsals'] = { status: 201, json: {} };
      await press(); // the choice is still there after a refusal
      expect(posted()).toEqual(
        [1, 2].map(() => ({ scenario: 'nominal', seed: '1', pace: 1, inline_plan: 'title: x\n' })),
      );
    });
    it('says why none is offered, and starts without', async () => {
      server.routes['GET /plans'] = { status: 503, json: { error: 'too much waits' } };
      await over();
      expect(button('plan-problem')?.textContent).toBe('✖ plans: too much waits');
      await press();
      expect(posted()).toEqual([{ scenario: 'nominal', seed: '1', pace: 1 }]);
    });
    it('is nothing that a director learns of, nor who looks while a run goes on', async () => {
      shown();
      await soon();
      expect(button('plan-choice')).toBe(null);
      act(() => {
        access.value = { state: 'in', user: 'dan', role: 'director', rights: ['watch', 'rehearse'] };
      });
      await over();
      expect([button('plan-choice'), server.asked, button('start-rehearsal')?.disabled]).toEqual([null, [], false]);
      expect(root.textContent).not.toMatch(/plan/i);
    });
  });
  it('gives those who may not rehearse nothing to press, and its keys do nothing', () => {
    act(() => {
      access.value = { state: 'in', user: 'eve', role: 'observer', rights: ['watch'] };
    });
    shown();
    expect(
      [...root.querySelectorAll<HTMLButtonElement>('button, select, input')].filter((each) => !each.disabled),
    ).toEqual([]);
    expect(root.textContent).toContain('need the right to rehearse; you are eve, observer');
    changePace(1);
    togglePause();
    expect(heard).toEqual([]);
  });
});
