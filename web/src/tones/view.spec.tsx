import { describe, expect, it } from 'vitest';
import { aStore, tone } from '../testing/fixtures';
import { bestTones, latestTone, toneBars, toneEvidence, toneSpectrum, toneTitle } from './model';

describe('tones', () => {
  it('say an erasure as an erasure', () => {
    const store = aStore([tone({ sclk: 700, locked: false })]);
    expect(toneTitle(latestTone(store, Infinity))).toBe('Tone not decoded');
    expect(toneBars(store, Infinity)[0]).toMatchObject({ tone: undefined, from_e_s: -300, to_e_s: -290 });
    expect(toneEvidence(latestTone(store, Infinity))).toContain('no lock');
  });
  it('give the evidence with the meaning', () => {
    const store = aStore([tone({ sclk: 700, tone: 7, meaning: 'Entry interface', likelihood: 0.998, runnerUp: 8, runnerUpLikelihood: 0.001, locked: true, cN0Dbhz: 22, model: 'statistical' })]);
    expect(toneTitle(latestTone(store, Infinity))).toBe('Tone 7 · Entry interface');
    expect(toneEvidence(latestTone(store, Infinity))).toBe('likelihood 0.998 · next 8 at 0.001 · ■ lock, 22.0 dB-Hz · statistical');
  });
  it('show what a receiver saw, and of a statistical tone no spectrum', () => {
    const spectrum = new Uint8Array(128).fill(60);
    spectrum[21] = 110;
    const heard = tone({ sclk: 700, tone: 42, locked: false, lock: 'coasting', cN0Dbhz: 20.5, spectrum, best: [{ tone: 42, likelihood: 0.99 }, { tone: 7, likelihood: 0.004 }] });
    const store = aStore([heard]);
    const latest = latestTone(store, Infinity);
    expect(toneSpectrum(latest)[21]).toEqual({ tone: 42, level_db: 25 });
    expect(toneSpectrum(latest)).toHaveLength(128);
    expect(bestTones(latest)).toBe('42: 0.9900 · 7: 0.0040');
    expect(toneEvidence(latest)).toContain('▨ coasting, 20.5 dB-Hz');
    expect(toneSpectrum(latestTone(aStore([tone({ sclk: 700, tone: 7 })]), Infinity))).toEqual([]);
  });
});
