// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import type uPlot from 'uplot';
import { create } from '@bufbuild/protobuf';
import { expect, it } from 'vitest';
import { DictionaryChannelSchema, DictionaryReplySchema } from '../gen/aeolis/v1/run_pb';
import { Dictionary } from '../run/dictionary';
import { useForTest } from '../run/session';
import { aStore, ENTRY_SCLK, samples, unit } from '../testing/fixtures';
import { drawOver } from './over';

it('an overlaid slow channel is one line, whether or not its rate was promised, and breaks where samples are missing', () => {
  const channels = [
    create(DictionaryChannelSchema, { id: 1, name: 'unpromised', packet: 'Slow' }),
    create(DictionaryChannelSchema, { id: 2, name: 'promised', packet: 'Slow', expectedRateHz: 0.1 }),
    create(DictionaryChannelSchema, { id: 3, name: 'quick', packet: 'Slow', expectedRateHz: 1 }),
  ];
  const dictionary = new Dictionary(create(DictionaryReplySchema, { channels }));
  const at = [0, 10, 20, 30, 40, 100, 110];
  const items = at.flatMap((e_s) => [
    unit({ name: 'Slow', sclk: ENTRY_SCLK - 300 + e_s }),
    samples(ENTRY_SCLK - 300 + e_s, { 1: e_s, 2: e_s, 3: e_s }),
  ]);
  useForTest(aStore(items), dictionary);
  let pieces: number[] = [];
  const ctx = new Proxy({} as Record<string, unknown>, {
    get: (_, name) =>
      name === 'beginPath'
        ? () => pieces.push(0)
        : name === 'moveTo'
          ? () => pieces.push(pieces.pop()! + 1)
          : () => undefined,
    set: () => true,
  });
  const plot = {
    scales: { x: { min: -300, max: -180 } },
    bbox: { left: 0, top: 0, width: 300, height: 100 },
    width: 300,
    ctx,
    valToPos: (value: number) => value,
  } as unknown as uPlot;
  const linesOf = (channel: (typeof channels)[number]) => {
    pieces = [];
    drawOver(plot, [channel], '', 1);
    return pieces.at(-1)! - 1; // the last move is to the dash before its name
  };
  expect(channels.map(linesOf)).toEqual([2, 2, 7]);
});
