import { describe, expect, it } from 'vitest';
import { aDictionary, aStore, samples } from '../testing/fixtures';
import { phaseSteps } from './model';

describe('the strip of phases', () => {
  it('follows what the vehicle said last', () => {
    const store = aStore([samples(700, { 1: 0, 2: 1, 5: 1 }), samples(800, { 1: 4, 2: 1, 5: 1 })]);
    const steps = phaseSteps(store, aDictionary, Infinity);
    expect(steps.slice(0, 3).map((step) => step.state)).toEqual(['done', 'now', 'ahead']);
    expect(steps[1]).toMatchObject({ title: 'Entry', detail: 'range control', since_e_s: -200 });
    expect(phaseSteps(store, aDictionary, 750)[0]?.state).toBe('now');
  });
  it('claims no phase before the vehicle has spoken', () => {
    expect(phaseSteps(aStore(), aDictionary, Infinity).every((step) => step.state === 'ahead')).toBe(true);
  });
});
