// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { PacketRowSchema } from '../gen/aeolis/v1/run_pb';
import type { PacketRow } from '../gen/aeolis/v1/run_pb';
import { aRun, aStore } from '../testing/fixtures';
import { noSpectrum, opacity, spectrumOf, waterfall } from './waterfall';

const HEADER = 14; // octets before the values
const hex = (octets: Uint8Array) => Array.from(octets, (each) => each.toString(16).padStart(2, '0')).join('');

/** A packet whose frequency number `loud` is 20 dB over the others. */
function packet(loud: number, sclk = 900.5, octets = HEADER + 8 + 512 + 2): PacketRow {
  const all = new Uint8Array(octets).fill(60);
  const view = new DataView(all.buffer);
  view.setFloat32(HEADER, -8192);
  view.setFloat32(HEADER + 4, 32);
  all[HEADER + 8 + loud] = 100;
  return create(PacketRowSchema, {
    unit: { sclk, name: 'StationSpectrum' },
    hex: hex(all),
    fields: [
      { name: 'spectrum_first_hz', positionBits: 8 * HEADER, bits: 32 },
      { name: 'spectrum_step_hz', positionBits: 8 * HEADER + 32, bits: 32 },
    ],
  });
}

describe('the waterfall', () => {
  it('reads a spectrum where the dictionary has its values, and nothing from what is none', () => {
    const spectrum = spectrumOf(packet(260), 1000);
    expect(spectrum).toMatchObject({ e_s: -99.5, first_hz: -8192, step_hz: 32 });
    expect(spectrum?.levels).toHaveLength(512);
    expect(spectrum?.levels.indexOf(100)).toBe(260);
    expect(spectrumOf(packet(260, 900.5, HEADER + 100), 1000)).toBeUndefined();
    expect(spectrumOf({ ...packet(260), problem: 'bad_crc' }, 1000)).toBeUndefined();
    expect(spectrumOf({ ...packet(260), fields: [] }, 1000)).toBeUndefined();
  });
  it('shows the loudest of what shares a pixel, and a second without a spectrum empty', () => {
    const spectra = [spectrumOf(packet(256, 900.5), 1000), spectrumOf(packet(257, 902.5), 1000)].flatMap(
      (each) => each ?? [],
    );
    const [columns, lines] = [3, 4]; // seconds; 32 Hz each
    const pixels = waterfall(spectra, { from: -100, to: -97 }, { low: -64, high: 64 }, columns, lines);
    const picture = Array.from({ length: lines }, (_, i) => [...pixels.subarray(i * columns, (i + 1) * columns)]);
    expect(picture).toEqual([
      [0, 0, 255],
      [255, 0, 0],
      [0, 0, 0],
      [0, 0, 0],
    ]);
    expect(waterfall(spectra, { from: 0, to: 10 }, { low: -64, high: 64 }, 10, 4).every((each) => each === 0)).toBe(
      true,
    );
    const coarse = waterfall(spectra, { from: -100, to: -97 }, { low: -8192, high: 8192 }, 1, 2);
    expect([...coarse]).toEqual([255, 0]); // both lie at or above the prediction
  });
  it('leaves the median faint, and says why a run has none', () => {
    expect([opacity(60), opacity(62), opacity(84), opacity(255)]).toEqual([0, 0, 255, 255]);
    expect(noSpectrum(aStore([], aRun({ toneModel: 'signal' })))).toBeUndefined();
    expect(noSpectrum(aStore([], aRun({ toneModel: 'statistical' })))).toContain('no samples are received');
  });
});
