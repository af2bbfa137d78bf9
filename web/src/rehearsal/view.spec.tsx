import { describe, expect, it } from 'vitest';
import { attainedText, nextPace } from './model';

describe('the pace', () => {
  it('steps up to as fast as it goes, and down to one', () => {
    expect([nextPace(1, 1), nextPace(1000, 1), nextPace(0, 1), nextPace(0, -1), nextPace(1, -1), nextPace(3, 1)]).toEqual([2, 0, 0, 1000, 1, 5]);
  });
  it('is told when it is not reached', () => {
    expect([attainedText(100, 99), attainedText(100, 42), attainedText(0, 512)]).toEqual(['', 'reaches 42×', 'reaches 512×']);
  });
});
