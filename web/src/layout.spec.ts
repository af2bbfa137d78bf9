// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { LAYOUT } from './layout';
import { POSITION_VIEWS } from './positions/layout';
import { pictureOf } from './run/address';

const FILES = import.meta.glob<string>('../../dictionaries/msl/*.{xml,csv}', {
  query: '?raw',
  import: 'default',
  eager: true,
});

/** All names in the mission's dictionary: attributes of its XTCE, cells of its spreadsheets. */
function wordsOf(files: Record<string, string>): Set<string> {
  const words = new Set<string>();
  for (const [name, text] of Object.entries(files))
    for (const [, word] of text.matchAll(name.endsWith('.xml') ? /\b(?:name|label)="([^"]*)"/g : /([^,\n"]+)/g))
      words.add((word as string).trim());
  return words;
}

/** The names in a part of the layout: texts with an underscore. */
function namesIn(part: unknown): string[] {
  if (typeof part === 'string') return /^\w+_\w+$/.test(part) ? [part] : [];
  return typeof part === 'object' && part !== null ? Object.values(part).flatMap(namesIn) : [];
}

it('names only what the shipped dictionary has', () => {
  const words = wordsOf(FILES);
  const channels = Object.values(POSITION_VIEWS).flatMap((view) => pictureOf(view).picture.plots?.flat() ?? []);
  const names = namesIn([LAYOUT, channels]);
  expect(names.length).toBeGreaterThan(70);
  expect(names.filter((name) => !words.has(name))).toEqual([]);
});
