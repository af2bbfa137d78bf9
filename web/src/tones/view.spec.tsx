// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { describe, expect, it } from 'vitest';
import { LinkChange_Silence } from '../gen/aeolis/v1/items_pb';
import { aStore, link, tone } from '../testing/fixtures';
import type { Palette } from '../draw/palette';
import { named } from '../stream/names';
import type { NamedTone } from '../stream/names';
import { drawSpectrum } from './view';
import {
  bestTones,
  isLast,
  latestTone,
  neighbour,
  shownTone,
  toneBars,
  toneEvidence,
  toneSilence,
  toneSpectrum,
  toneTitle,
} from './model';

describe('tones', () => {
  it('say an erasure as an erasure', () => {
    const store = aStore([tone({ sclk: 700, locked: false })]);
    expect(toneTitle(latestTone(store, Infinity))).toBe('Tone not decoded');
    expect(toneBars(store, Infinity)[0]).toMatchObject({ tone: undefined, from_e_s: -300, to_e_s: -290 });
    expect(toneEvidence(latestTone(store, Infinity))).toContain('no lock');
  });
  it('are not lost before X-band goes over to them: they have not begun', () => {
    const reason = 'not begun: X-band sends telemetry until E−12:30';
    const store = aStore([
      link({ link: 'x_band', up: false, reason, silence: LinkChange_Silence.not_begun, ert: '2012-219T04:40:00.0' }),
    ]);
    expect(toneEvidence(latestTone(store, Infinity), toneSilence(store, Infinity))).toBe(
      'tones have not begun: X-band sends telemetry until E−12:30',
    );
    expect(toneEvidence(undefined)).toBe('one of 256, each for 10 s');
  });
  it('give the evidence with the meaning', () => {
    const store = aStore([
      tone({
        sclk: 700,
        tone: 7,
        meaning: 'Entry interface',
        likelihood: 0.998,
        runnerUp: 8,
        runnerUpLikelihood: 0.001,
        locked: true,
        cN0Dbhz: 22,
        model: 'statistical',
      }),
    ]);
    expect(toneTitle(latestTone(store, Infinity))).toBe('Tone 7 · Entry interface');
    expect(toneEvidence(latestTone(store, Infinity))).toBe(
      'likelihood 0.998 · next 8 at 0.001 · ■ lock, 22.0 dB-Hz · drawn by a statistical model',
    );
  });
  it('never call a tone certain, and say nothing of a signal that was received', () => {
    const sure = { likelihood: 0.99999, runnerUp: 8, runnerUpLikelihood: 0.00001 };
    const store = aStore([
      tone({ sclk: 700, tone: 7, ...sure, locked: true, cN0Dbhz: 22, dopplerHz: -429200, model: 'signal' }),
    ]);
    expect(toneEvidence(latestTone(store, Infinity))).toBe(
      'likelihood above 0.999 · next 8 below 0.001 · ■ lock, 22.0 dB-Hz · Doppler −429.2 kHz',
    );
  });
  it('tell of a tone that is long past as the last one, with its time, not as what the vehicle says now', () => {
    const heard = tone({ sclk: 700, tone: 7, meaning: 'Entry interface' });
    const last = named(heard.item) as NamedTone;
    const lost = named(tone({ sclk: 700 }).item) as NamedTone;
    const set = link({ link: 'x_band', up: false, reason: 'Earth has set', ert: '2012-219T04:59:00.0' });
    const whether = (...more: Parameters<typeof aStore>[0] & object) =>
      isLast(aStore([heard, ...more]), Infinity, false);
    const up = link({ link: 'x_band', up: true, reason: 'nominal', ert: '2012-219T04:58:00.0' });
    expect([whether(up), whether(up, set), whether()], 'up, set, and without a word of the link').toEqual([
      false,
      true,
      true,
    ]);
    expect(isLast(aStore([heard, up]), Infinity, true), 'without a connection').toBe(true);
    expect([toneTitle(last, -300), toneTitle(lost, -300)]).toEqual([
      'Last tone, E−5:00: 7 · Entry interface',
      'Last tone, E−5:00: not decoded',
    ]);
  });
  it('show what a receiver saw, and of a statistical tone no spectrum', () => {
    const spectrum = new Uint8Array(128).fill(60);
    spectrum[21] = 110;
    const heard = tone({
      sclk: 700,
      tone: 42,
      locked: false,
      lock: 'coasting',
      cN0Dbhz: 20.5,
      spectrum,
      best: [
        { tone: 42, likelihood: 0.99 },
        { tone: 7, likelihood: 0.004 },
      ],
    });
    const store = aStore([heard]);
    const latest = latestTone(store, Infinity);
    expect(toneSpectrum(latest)[21]).toEqual({ tone: 42, level_db: 25 });
    expect(toneSpectrum(latest)).toHaveLength(128);
    expect(bestTones(latest)).toBe('42: 0.9900 · 7: 0.0040');
    expect(toneEvidence(latest)).toContain('▨ coasting, 20.5 dB-Hz');
    expect(toneSpectrum(latestTone(aStore([tone({ sclk: 700, tone: 7 })]), Infinity))).toEqual([]);
  });
  it('show the whole spectrum, also above the tones that came, with the number of the runner-up', () => {
    const words: string[] = [];
    const bars: number[] = [];
    const context = {
      fillText: (text: string) => words.push(text),
      fillRect: (_x: number, y: number, _wide: number, high: number) => void (high < 3 && bars.push(y)),
    };
    const spectrum = new Uint8Array(128).fill(60);
    [spectrum[21], spectrum[61]] = [110, 100];
    const drawn = (runnerUp: number, bottom: number) =>
      drawSpectrum(
        { context: context as unknown as CanvasRenderingContext2D, width: 600, colours: {} as Palette },
        named(tone({ sclk: 700, tone: 42, runnerUp, spectrum }).item) as NamedTone,
        bottom,
      );
    drawn(123, 200);
    expect([bars.length, Math.min(...bars) > 20, Math.max(...bars) < 200]).toEqual([128, true, true]);
    expect(words).toEqual(expect.arrayContaining(['0', '64', '255', '42', '123']));
    words.length = 0;
    drawn(44, 50); // as low as on a laptop in a past view: no number lies over another
    expect(words).toEqual(['0', '255', '30 dB', '42']);
  });
  it('can be looked at one by one, and move on with the newest where none is chosen', () => {
    const store = aStore([700, 710, 720].map((sclk) => tone({ sclk, tone: sclk / 10 })));
    expect([undefined, 720, 710, 700].map((sclk) => neighbour(store, Infinity, sclk, -1))).toEqual([
      710, 710, 700, 700,
    ]);
    expect([700, 710, undefined].map((sclk) => neighbour(store, Infinity, sclk, 1))).toEqual([
      710,
      undefined,
      undefined,
    ]);
    expect([undefined, 700, 710].map((sclk) => shownTone(store, Infinity, sclk)?.tone)).toEqual([72, 70, 71]);
    expect(shownTone(store, 705, 710)?.tone).toBe(70);
  });
});
