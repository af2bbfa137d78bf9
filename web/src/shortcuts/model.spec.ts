// @vitest-environment happy-dom
import { expect, it } from 'vitest';
import guide from '../../../docs/console.md?raw';
import { SHORTCUTS } from './model';

it('no key has two meanings, and docs/console.md has each with its words', () => {
  const keys = SHORTCUTS.flatMap((each) => each.keys);
  expect(new Set(keys).size).toBe(keys.length);
  for (const each of SHORTCUTS) expect(guide).toContain(`| \`${each.shown}\` | ${each.words} |`);
});
