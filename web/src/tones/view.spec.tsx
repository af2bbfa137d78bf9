import { describe, expect, it } from 'vitest';
import { aStore, tone } from '../testing/fixtures';
import { latestTone, toneBars, toneEvidence, toneTitle } from './model';

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
});
