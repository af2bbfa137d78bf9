// SPDX-License-Identifier: Apache-2.0
// The waterfall of X-band: its spectrum over time, about the predicted carrier. Spectra are fetched once it is opened.
import { useEffect, useState } from 'preact/hooks';
import { TYPE } from '../design/type';
import { axisNumber, ticks, timeLabel, timeStep, valueTicks } from '../draw/axis';
import { Canvas } from '../draw/canvas';
import type { Surface } from '../draw/canvas';
import type { PacketList } from '../gen/aeolis/v1/run_pb';
import { ask } from '../run/connection';
import { cursor } from '../run/cursor';
import { cutoff, shownRun, signalOfRun, store } from '../run/shown';
import { plotSpan } from '../run/window';
import { SPECTRUM } from './layout';
import { noSpectrum, spectrumOf, waterfall } from './waterfall';
import type { Spectrum } from './waterfall';

const PAGE = 250; // chosen: 0.3 MB an answer
const AGAIN_MS = 2000; // chosen: a spectrum a second comes
const NEAR_HZ = 1000; // chosen: the carrier with both sidebands of each tone
const LEFT = 62;
const RIGHT = 12;
const BOTTOM = 20;

/** What has come of the run, in the order of its packets, and the number after which to go on. */
const known = signalOfRun<{ spectra: Spectrum[]; after: number; failed?: string }>({ spectra: [], after: 0 });

/** Fetches what has come since. Whole pages are not asked for again. */
async function fetchOn(): Promise<void> {
  const run = store.peek();
  if (!run) return;
  for (;;) {
    const { after, spectra } = known.peek();
    const query = `name=${SPECTRUM.packet}&limit=${PAGE}&after=${after}`;
    const { packets, nextAfter } = await ask<PacketList>('packets', `/runs/${run.id}/packets?${query}`);
    if (store.peek() !== run) return;
    const newest = spectra.at(-1)?.e_s ?? -Infinity;
    const come = packets.flatMap((row) => spectrumOf(row, run.entrySclk) ?? []).filter(({ e_s }) => e_s > newest);
    if (come.length > 0 || nextAfter > 0)
      known.value = { spectra: [...spectra, ...come], after: nextAfter > 0 ? Number(nextAfter) : after };
    if (nextAfter === 0n) return;
  }
}

function useSpectra(wanted: boolean): void {
  const run = store.value;
  const going = run?.going === true;
  useEffect(() => {
    if (!run || !wanted) return undefined;
    let over = false;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const again = () =>
      fetchOn()
        .catch((error: unknown) => {
          known.value = { ...known.peek(), failed: error instanceof Error ? error.message : String(error) };
        })
        .finally(() => {
          if (!over && going) timer = setTimeout(again, AGAIN_MS);
        });
    void again();
    return () => {
      over = true;
      clearTimeout(timer);
    };
  }, [run, wanted, going]);
}

/** Red, green and blue of a colour as the style sheet has it. */
const parts = (colour: string): number[] =>
  (/^#(..)(..)(..)$/.exec(colour)?.slice(1) ?? ['b4', 'a0', 'ff']).map((each) => Number.parseInt(each, 16));

function draw(near: boolean, { context: c, width, height, colours }: Surface): void {
  const run = shownRun();
  const time = plotSpan(run);
  const spectra = known.value.spectra.filter(({ e_s }) => run && e_s + run.entrySclk <= cutoff.value);
  const newest = spectra.at(-1);
  const most = near || !newest ? NEAR_HZ : -newest.first_hz;
  const hz = { low: -most, high: most };
  const [wide, high] = [Math.max(1, Math.floor(width - LEFT - RIGHT)), Math.max(1, Math.floor(height - BOTTOM - 6))];
  const y = (at: number) => 6 + ((hz.high - at) / (hz.high - hz.low)) * high;
  const x = (e_s: number) => LEFT + ((e_s - time.from) / (time.to - time.from)) * wide;
  const [red, green, blue] = parts(colours.tone) as [number, number, number];
  const picture = new ImageData(wide, high);
  for (const [i, shade] of waterfall(spectra, time, hz, wide, high).entries())
    picture.data.set([red, green, blue, shade], 4 * i);
  const sheet = new OffscreenCanvas(wide, high);
  sheet.getContext('2d')?.putImageData(picture, 0, 0);
  c.drawImage(sheet, LEFT, 6, wide, high);
  c.font = `${TYPE.mark}px ${colours.mono}`;
  c.textBaseline = 'middle';
  c.fillStyle = colours.dim;
  c.textAlign = 'right';
  for (const at of valueTicks(hz.low, hz.high, high)) c.fillText(axisNumber(at), LEFT - 8, y(at));
  c.textAlign = 'center';
  const step = timeStep(time.to - time.from, Math.floor(width / 100));
  const label = timeLabel(run?.entryKnown !== false);
  for (const e_s of ticks(time.from, time.to, step))
    if (x(e_s) < width - 26) c.fillText(label(e_s, step), x(e_s), height - 8);
  c.strokeStyle = colours.text;
  c.lineWidth = 1;
  c.setLineDash([2, 4]);
  c.beginPath();
  c.moveTo(LEFT, Math.round(y(0)) + 0.5);
  c.lineTo(LEFT + wide, Math.round(y(0)) + 0.5);
  c.stroke();
  c.setLineDash([]);
  if (cursor.value !== undefined && x(cursor.value) > LEFT) {
    c.fillStyle = colours.accent;
    c.fillRect(Math.round(x(cursor.value)), 6, 1, high);
  }
}

export function Waterfall() {
  const [open, setOpen] = useState(false);
  const [near, setNear] = useState(true);
  const run = shownRun();
  const none = run && noSpectrum(run);
  useSpectra(open && none === undefined);
  const { spectra, failed } = known.value;
  return (
    <details class="waterfall" data-testid="waterfall" onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>Spectrum over time</summary>
      {open && none !== undefined && <p data-testid="no-spectrum">{none}</p>}
      {open && none === undefined && (
        <>
          <p>
            {failed !== undefined
              ? `spectra: ${failed}`
              : spectra.length === 0
                ? 'no spectrum has come yet'
                : `${spectra.length} s in Hz from the predicted carrier (dashed)`}{' '}
            <button type="button" aria-pressed={!near} onClick={() => setNear(!near)}>
              whole band
            </button>
          </p>
          {spectra.length > 0 && (
            <Canvas
              label={`Spectrum of X-band over time, ${spectra.length} s`}
              testId="waterfall-canvas"
              draw={(surface) => draw(near, surface)}
              keyOf={() => {
                const span = plotSpan(shownRun());
                return `${shownRun()?.id} ${known.value.spectra.length} ${Math.round(span.from * 2)} ${Math.round(span.to * 2)} ${cutoff.value} ${cursor.value} ${near}`;
              }}
            />
          )}
        </>
      )}
    </details>
  );
}
