// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { ProofReportSchema } from '../gen/aeolis/v1/run_pb';
import { diffLines, rowsOf, sentence, toneSummary } from './model';

const row = (name: string, counts: Record<string, number> = {}) => ({
  name,
  ...Object.fromEntries(Object.entries(counts).map(([key, value]) => [key, BigInt(value)])),
});
const proof = (recordingComplete: boolean, ...streams: ReturnType<typeof row>[]) =>
  create(ProofReportSchema, { recordingComplete, streams });

describe('the verdicts', () => {
  it('are called proven only once the recording is complete and nothing disagrees', () => {
    const good = row('A', { realtime: 10, identical: 10, recorded: 12, neverSeenLive: 2 });
    expect(sentence(proof(true, good))).toEqual({
      status: 'holds',
      text: 'All 10 packets seen live are in the recording, bit for bit.',
    });
    expect(sentence(proof(false, good)).status).toBe('missing');
    expect(sentence(proof(true, good, row('B', { realtime: 3, identical: 2, missingInRecording: 1 })))).toEqual({
      status: 'failed',
      text: '1 of 13 packets seen live are not in the recording.',
    });
    expect(sentence(proof(true, row('C', { recorded: 5, neverSeenLive: 5 }))).status).toBe('unknown');
    expect(sentence(proof(true)).status).not.toBe('holds');
  });
  it('call a difference at once, complete or not', () => {
    for (const complete of [true, false])
      expect(sentence(proof(complete, row('A', { realtime: 2, identical: 1, differs: 1 }))).status).toBe('failed');
  });
  it('show what is in trouble before what there is most of', () => {
    const rows = rowsOf(
      proof(
        true,
        row('many', { realtime: 900, recorded: 900 }),
        row('few', { realtime: 1, differs: 1 }),
        row('some', { realtime: 5, recorded: 5 }),
      ).streams,
    );
    expect(rows.map((each) => each.name)).toEqual(['few', 'many', 'some']);
  });
  it('count tones by verdict and keep those that need a look', () => {
    const tones = create(ProofReportSchema, {
      tones: [
        { sclk: 1, decoded: 3, recorded: 3, verdict: 'identical' },
        { sclk: 2, recorded: 4, verdict: 'erased' },
      ],
    }).tones;
    expect(toneSummary(tones)).toMatchObject({
      counts: [
        ['identical', 1],
        ['erased', 1],
      ],
      odd: [{ sclk: 2 }],
    });
  });
});

describe('two packets octet by octet', () => {
  it('have each octet marked that differs, and none else', () => {
    const { lines, differing } = diffLines('00010203', '0001FF03');
    expect(differing).toBe(1);
    expect(lines[0]?.one.map((octet) => octet.differs)).toEqual([false, false, true, false]);
    expect(lines[0]?.other[2]?.text).toBe('ff');
  });
  it('of other length differ where one has nothing', () => {
    const { lines, differing } = diffLines('aa'.repeat(17), 'aa'.repeat(16));
    expect([differing, lines.length, lines[1]?.other[0]?.text]).toEqual([1, 2, '--']);
  });
});
