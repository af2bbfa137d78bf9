// SPDX-License-Identifier: Apache-2.0
// Windows that people have: nothing is cut off, over another or broken inside a number, no control reaches out of its
// box; the longer list is long/sizes_test.mjs.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { measured } from './sizes.mjs';
import { workplace } from './support.mjs';

const here = workplace({ scrollbars: true });

test('on a low laptop, a laptop, a wall and a telephone all texts and controls are whole, and so are header, command line and what is armed', async (t) => {
  const sizes = [
    [1280, 585],
    [1440, 790],
    [1920, 950],
    [390, 700],
  ];
  assert.deepEqual(await measured(here, t, ['armed', 'mid entry', 'touchdown'], sizes), []);
});
