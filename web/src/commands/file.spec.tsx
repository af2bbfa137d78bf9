// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { access } from '../access/model';
import { backToLive, useForTest } from '../run/session';
import { lookAtPast } from '../run/shown';
import { aDictionary, aRun, aStore } from '../testing/fixtures';
import { aServer } from '../testing/server';
import {
  backFile,
  commands,
  file,
  forwardFile,
  outcome,
  read,
  stage,
  text,
  triedNow,
  tryFile,
  typedNames,
} from './file';
import './disarm';
import { CommandFile } from './file_view';
import { TOO_LONG, confirms, hazardousIn, readFile, sequenceOf } from './file_model';

const landing =
  '{"commands":[{"command":"EDL_SET_PARAMETERS","from_solution":true},{"command":"EDL_DO_EDL","armed":true,"confirmation":"EDL_DO_EDL"}]}';
const reply = (fields: object = {}) => ({
  accepted: true,
  reason: '',
  command: '0',
  octets: 'aabb',
  arguments: '',
  leaves: '',
  arrives: '',
  latest_useful: '',
  useful_before: '',
  too_late_for: [],
  ...fields,
});

describe('a command file', () => {
  it('is JSON with commands, and what is wrong with it is named', () => {
    const problem = (typed: string) => (readFile(typed) as { problem?: string }).problem;
    expect(readFile('{"commands":[{"command":"NO_OP","hold":true}]}')).toEqual({
      commands: [{ command: 'NO_OP', hold: true }],
    });
    expect(problem('NO_OP')).toContain('no JSON');
    expect(problem('[]')).toContain('{"commands": […]}');
    expect(problem('{"commands":[]}')).toContain('no commands');
    expect(problem('{"commands":[{"command":"NO_OP"},{"name":"NO_OP"}]}')).toContain('commands[1]');
    expect(problem('{"commands":[{"command":"NO_OP"}],"dry_run":true}')).toContain('dry_run');
  });
  it('is no longer than the server takes it, chosen or pasted', () => {
    const many = (count: number) =>
      JSON.stringify({ commands: Array.from({ length: count }, () => ({ command: 'NO_OP' })) });
    expect([readFile(many(100)), readFile(many(101)), readFile(many(1) + ' '.repeat(1_000_000))]).toEqual([
      { commands: expect.anything() },
      { problem: TOO_LONG },
      { problem: TOO_LONG },
    ]);
    expect(TOO_LONG).toContain('at most 100 commands and 0.2 MB');
  });
  it('is armed by who sends it: what it says of itself does not count', () => {
    const commands = (readFile(landing) as { commands: never[] }).commands;
    expect(hazardousIn(commands, aDictionary)).toEqual(['EDL_DO_EDL']);
    expect(sequenceOf(commands, [], 'ann', false)).toEqual({
      dry_run: false,
      commands: [
        { controller: 'ann', command: 'EDL_SET_PARAMETERS', from_solution: true },
        { controller: 'ann', command: 'EDL_DO_EDL' },
      ],
    });
    expect(sequenceOf(commands, ['EDL_DO_EDL'], '', true)).toMatchObject({
      dry_run: true,
      commands: [{}, { armed: true, confirmation: 'EDL_DO_EDL' }],
    });
  });
  it('is confirmed by the names of all that is hazardous, in their order', () => {
    expect([
      confirms('edl_do_edl ', ['EDL_DO_EDL']),
      confirms('EDL_DO_EDL', ['EDL_DO_EDL', 'EDL_DO_EDL']),
      confirms('', ['EDL_DO_EDL']),
    ]).toEqual([true, false, false]);
  });
});

describe('sending a command file', () => {
  const server = aServer();
  const route = 'POST /runs/1/sequences';
  const sent = () => server.asked.filter(({ body }) => (body as { dry_run: boolean }).dry_run === false);
  beforeEach(() => {
    useForTest(aStore(), aDictionary);
    read(landing);
  });
  it('goes by a dry run, arming and typed names, and sends once', async () => {
    server.routes[route] = { json: { accepted: true, reason: '', commands: [reply(), reply()] } };
    await forwardFile();
    expect(stage.value).toBe('review'); // the ground has not answered yet
    await tryFile();
    await forwardFile();
    expect([stage.value, sent().length]).toEqual(['armed', 0]);
    await forwardFile();
    expect([sent().length, outcome.value?.text]).toEqual([0, expect.stringContaining('type EDL_DO_EDL')]);
    typedNames.value = 'EDL_DO_EDL';
    server.routes[route] = {
      json: { accepted: true, reason: '', commands: [reply({ command: '4' }), reply({ command: '5' })] },
    };
    await forwardFile();
    expect([sent().length, outcome.value, text.value]).toEqual([1, { good: true, text: 'all 2 taken: #4 to #5' }, '']);
    expect(sent()[0]?.body).toMatchObject({ commands: [{}, { armed: true, confirmation: 'EDL_DO_EDL' }] });
  });
  it('of which some were taken before one was refused says which, and is not there to be sent again', async () => {
    read('{"commands":[{"command":"NO_OP"},{"command":"NO_OP"}]}');
    server.routes[route] = { json: { accepted: true, reason: '', commands: [reply(), reply()] } };
    await tryFile();
    server.routes[route] = {
      status: 409,
      json: {
        accepted: false,
        reason: 'commands[1]: the run is over',
        commands: [reply({ command: '4' }), reply({ accepted: false, reason: 'the run is over' })],
      },
    };
    await forwardFile();
    expect([outcome.value?.text, text.value]).toEqual(['refused: commands[1]: the run is over; taken was #4', '']);
  });
  it.each([
    { status: 409, reason: 'EDL_DO_EDL must not be sent now' },
    { status: 422, reason: "unknown service 'CD': AD, BD, or none for what suits" },
  ])(
    'is not armed while one of its commands would be refused ($status), which is named',
    async ({ status, reason }) => {
      server.routes[route] = {
        status,
        json: {
          accepted: false,
          reason: `commands[1]: ${reason}`,
          commands: [reply(), reply({ accepted: false, reason })],
          detail: `commands[1]: ${reason}`,
        },
      };
      await tryFile();
      expect(triedNow.value?.answer?.commands.map((each) => each.accepted)).toEqual([true, false]);
      await forwardFile();
      expect([stage.value, sent().length]).toEqual(['review', 0]);
    },
  );
  it('is armed for one run as it stood then: neither for another, nor after a look at the past', async () => {
    const armed = async (look: () => void) => {
      useForTest(aStore(), aDictionary);
      await tryFile();
      await forwardFile();
      typedNames.value = 'EDL_DO_EDL';
      expect(stage.value).toBe('armed');
      look();
      const left = [stage.value, typedNames.value, triedNow.value];
      await forwardFile();
      return [...left, sent().length];
    };
    server.routes[route] = { json: { accepted: true, reason: '', commands: [reply(), reply()] } };
    expect(await armed(() => useForTest(aStore([], aRun({ run: 2n })), aDictionary))).toEqual([
      'review',
      '',
      undefined,
      0,
    ]);
    expect(
      await armed(() => {
        lookAtPast({ from: -200, to: -150 }, false);
        backToLive();
      }),
    ).toEqual(['review', '', undefined, 0]);
  });
  it('that is changed needs another answer', async () => {
    server.routes[route] = { json: { accepted: true, reason: '', commands: [reply()] } };
    await tryFile();
    read('{"commands":[{"command":"NO_OP"},{"command":"NO_OP"}]}');
    expect([triedNow.value, file.value]).toEqual([
      undefined,
      { commands: [{ command: 'NO_OP' }, { command: 'NO_OP' }] },
    ]);
    await forwardFile();
    expect(sent()).toEqual([]);
  });
  const yes = { json: { accepted: true, reason: '', commands: [reply({ command: '4' })] } };
  const reviewed = async () => {
    read('{"commands":[{"command":"NO_OP"}]}');
    server.routes[route] = yes;
    await tryFile();
  };
  it('whose answer never came, broke off, cannot be read or is of a server that failed is not sent again by the next Enter', async () => {
    for (const [answer, why] of [
      [{ status: 0 }, 'no answer came'],
      [{ octets: new ReadableStream({ start: (body) => body.error(new TypeError('terminated')) }) }, 'no answer came'],
      [{ octets: new TextEncoder().encode('{"accepted":tr') }, 'cannot be read'],
      [{ json: {} }, 'cannot be read'],
      [{ status: 502, json: { error: 'bad gateway' } }, 'bad gateway'],
    ] as const) {
      await reviewed();
      server.routes[route] = answer;
      await forwardFile();
      expect([text.value, stage.value, outcome.value?.good, outcome.value?.text]).toEqual([
        '',
        'review',
        false,
        expect.stringMatching(`${why}.*whether it was taken is not known; the history below will say`),
      ]);
    }
    backFile();
  });
  it('is waited for no longer than a minute', async () => {
    await reviewed();
    const limit = vi
      .spyOn(AbortSignal, 'timeout')
      .mockReturnValue(AbortSignal.abort(new DOMException('', 'TimeoutError')));
    await forwardFile();
    expect([limit.mock.calls, text.value, outcome.value?.text]).toEqual([
      [[60_000]],
      '',
      expect.stringContaining('no answer came in 60 s: whether it was taken is not known'),
    ]);
    limit.mockRestore();
  });
  it('cannot be replaced while it is sent', async () => {
    await reviewed();
    let answer = () => {};
    server.routes[route] = () => new Promise((resolve) => (answer = () => resolve(yes)));
    const sending = forwardFile();
    read('{"commands":[{"command":"NO_OP"},{"command":"NO_OP"}]}');
    await forwardFile();
    expect([stage.value, commands.value.length, sent().length]).toEqual(['sending', 1, 1]);
    answer();
    await sending;
    expect([text.value, outcome.value?.text]).toEqual(['', 'all 1 taken: #4']);
  });
  it('that is refused for want of a right says so and asks who we are', async () => {
    await reviewed();
    server.routes['GET /session'] = { json: { accounts: true, user: 'eve', role: 'observer', rights: ['watch'] } };
    server.routes[route] = { status: 403, json: { error: 'needs the right to send' } };
    await forwardFile();
    await vi.waitFor(() => expect(access.value).toMatchObject({ state: 'in', role: 'observer' }));
    expect([text.value, outcome.value?.text]).toEqual([
      '{"commands":[{"command":"NO_OP"}]}',
      'refused: needs the right to send; nothing was sent',
    ]);
    access.value = { state: 'asking' };
  });
  it('is tried out by one question at a time, and only while its fold is open', async () => {
    const root = document.createElement('div');
    let answer = () => {};
    server.routes[route] = () => new Promise((resolve) => (answer = () => resolve(yes)));
    vi.useFakeTimers();
    act(() => render(<CommandFile />, root));
    await vi.advanceTimersByTimeAsync(3000);
    expect(server.asked).toEqual([]);
    const fold = root.querySelector('details') as HTMLDetailsElement;
    const toggle = (open: boolean) =>
      act(() => {
        fold.open = open;
        fold.dispatchEvent(new Event('toggle'));
      });
    toggle(true);
    await vi.advanceTimersByTimeAsync(5500);
    expect(server.asked.length).toBe(1);
    answer();
    await vi.advanceTimersByTimeAsync(1000);
    expect([triedNow.value?.answer?.accepted, server.asked.length]).toEqual([true, 2]);
    answer();
    toggle(false);
    await vi.advanceTimersByTimeAsync(5000);
    expect([triedNow.value, server.asked.length]).toEqual([undefined, 2]);
    vi.useRealTimers();
    act(() => render(null, root));
  });
});
