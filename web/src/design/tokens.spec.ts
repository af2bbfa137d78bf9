// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import guide from '../../../docs/console.md?raw';
import { DEFICIENCIES, contrast, difference, linear, seenWith } from './colour';
import { SOURCES, STATUS } from './status';
import css from './tokens.css?raw';

function theme(name: 'dark' | 'light'): Map<string, string> {
  const block = css.slice(css.indexOf(`:root[data-theme="${name}"]`)).split('}')[0] ?? '';
  return new Map(
    [...block.matchAll(/--([\w-]+): (#[0-9a-f]{6})/g)].map((match) => [match[1] as string, match[2] as string]),
  );
}
const BACKGROUNDS = ['page', 'panel', 'raised'];
const NOT_TEXT = [...BACKGROUNDS, 'line', 'edge', 'ghost', 'chosen'];

describe.each(['dark', 'light'] as const)('the colours, %s', (name) => {
  const tokens = theme(name);
  const value = (token: string) => tokens.get(token) ?? '';
  it('that carry text have the contrast of WCAG AA, 4.5, on every background', () => {
    expect(tokens.size).toBeGreaterThan(20);
    const poor = [...tokens.keys()]
      .filter((token) => !NOT_TEXT.includes(token))
      .flatMap((token) =>
        BACKGROUNDS.filter((ground) => contrast(value(token), value(ground)) < 4.5).map(
          (ground) => `${token} on ${ground}`,
        ),
      );
    expect(poor).toEqual([]);
    expect(contrast(value('text'), value('chosen'))).toBeGreaterThan(7);
    expect(contrast(value('dim'), value('chosen'))).toBeGreaterThan(4.5);
  });
  it('that carry a word inside a filled mark have it against the page', () => {
    for (const token of [...tokens.keys()].filter((each) => each.startsWith('mode-')))
      expect(contrast(value(token), value('page'))).toBeGreaterThan(4.5);
  });
  it('of the edges of controls can be told from what they lie on, 3', () => {
    for (const ground of BACKGROUNDS) expect(contrast(value('edge'), value(ground))).toBeGreaterThan(3);
  });
  it('of good, caution and alarm stay apart without red, green or blue cones', () => {
    for (const rows of Object.values(DEFICIENCIES)) {
      for (const [one, other] of [
        ['good', 'caution'],
        ['caution', 'alarm'],
        ['good', 'alarm'],
      ] as const) {
        expect(
          difference(seenWith(rows, linear(value(one))), seenWith(rows, linear(value(other)))),
          `${one} and ${other}`,
        ).toBeGreaterThan(10);
      }
    }
  });
});

it('both themes have the same tokens, and the guide names each with its value', () => {
  const [dark, light] = [theme('dark'), theme('light')];
  expect([...light.keys()]).toEqual([...dark.keys()]);
  for (const [token, colour] of dark)
    expect(guide).toContain(`| \`${token}\` | \`${colour}\` | \`${light.get(token)}\` |`);
});

it('no two states have the same shape, and the guide has each with its word', () => {
  const all = Object.values(STATUS);
  expect(new Set(all.map((each) => each.shape)).size).toBe(all.length);
  for (const each of [...all, ...Object.values(SOURCES)])
    expect(guide).toContain(`| ${each.shape} | ${each.word} | \`${each.token}\` |`);
});
