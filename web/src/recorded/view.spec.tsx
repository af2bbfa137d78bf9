// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { afterEach, describe, expect, it, vi } from 'vitest';
import { download, sizeWords } from './download';
import { fileName, rangeProblem, rangeRow, samplesPath, seriesPath } from './model';

describe('a recorded range', () => {
  it('is refused upside down or unreadable, in words', () => {
    expect(rangeProblem(10, 5)).toContain('later');
    expect(rangeProblem(undefined, 5)).toContain('start');
    expect(rangeProblem(1, undefined)).toContain('end');
    expect(rangeProblem(-5, 5)).toBeUndefined();
  });
  it('counts what came live and what the recording alone has', () => {
    const columns = [
      { id: 1, recorded: false, sclk: Float64Array.of(1, 3), value: Float64Array.of(5, 7) },
      { id: 1, recorded: true, sclk: Float64Array.of(2), value: Float64Array.of(-1) },
    ];
    const series = { id: 1, name: 'a', unit: '', samples: 9, thinned: true, columns };
    expect(rangeRow(series)).toMatchObject({
      samples: 9,
      given: 3,
      live: 2,
      recorded: 1,
      least: -1,
      largest: 7,
      first_sclk: 1,
      last_sclk: 3,
    });
    expect(rangeRow({ ...series, columns: [] })).toMatchObject({ given: 0, first_sclk: NaN });
  });
  it('asks the route as it is documented', () => {
    expect(seriesPath(3, ['a', 'b'], 1.5, 2, 100)).toBe(
      '/runs/3/channels?names=a%2Cb&from=1.5&to=2&points=100&format=protobuf',
    );
    expect(samplesPath(3, ['a', 'b'], 1.5, 2, 'long')).toBe('/runs/3/samples?names=a%2Cb&from=1.5&to=2');
    expect(samplesPath(3, ['a', 'b'], 1.5, 2, 'wide')).toBe('/runs/3/samples?names=a%2Cb&from=1.5&to=2&align=a');
  });
  it('names a file by run, range and shape, in letters that every system takes', () => {
    expect(fileName('nominal_auto', 3, 230, 300, 'wide')).toBe('nominal_auto_run-3_E+3m50s_E+5m00s_wide.csv');
    expect(fileName('my case/1', 12, -61.5, 0, 'long')).toBe('my-case-1_run-12_E-1m01.5s_E+0m00s_long.csv');
  });
});

describe('an export', () => {
  afterEach(() => void vi.unstubAllGlobals());
  /** Answers in pieces until it is aborted. */
  const serves = (pieces: number, headers: Record<string, string> = {}) =>
    vi.stubGlobal(
      'fetch',
      async (_: string, { signal }: RequestInit) =>
        new Response(
          new ReadableStream({
            pull(controller) {
              if (signal?.aborted) controller.error(signal.reason);
              else if (pieces-- > 0) controller.enqueue(new Uint8Array(1000));
              else controller.close();
            },
          }),
          { headers },
        ),
    );
  it('tells how much has come, of how much where that is said, and comes whole', async () => {
    const told: [number, number | undefined][] = [];
    serves(3);
    expect((await download('x', new AbortController().signal, (octets, of) => told.push([octets, of]))).size).toBe(
      3000,
    );
    expect(told).toEqual([
      [1000, undefined],
      [2000, undefined],
      [3000, undefined],
    ]);
    serves(1, { 'content-length': '1000' });
    await download('x', new AbortController().signal, (octets, of) => told.push([octets, of]));
    expect(told.at(-1)).toEqual([1000, 1000]);
    expect([sizeWords(420_000, undefined), sizeWords(12_400_000, 71_000_000)]).toEqual(['0.42 MB', '12.4 of 71.0 MB']);
  });
  it('that is cancelled ends, and makes no file', async () => {
    serves(1e9);
    const stop = new AbortController();
    await expect(
      download('x', stop.signal, (octets) => {
        if (octets >= 5000) stop.abort();
      }),
    ).rejects.toThrow();
  });
  it('that is refused says why', async () => {
    vi.stubGlobal('fetch', async () => new Response('{"error":"too many questions wait"}', { status: 503 }));
    await expect(download('x', new AbortController().signal, () => undefined)).rejects.toThrow(
      'too many questions wait',
    );
  });
});
