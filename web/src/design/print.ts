// SPDX-License-Identifier: Apache-2.0
import { drawAll } from '../draw/loop';

/** Prints in the light theme, pictures too, whatever the screen has. */
export function printLight(): void {
  const root = document.documentElement;
  let before: string | undefined;
  window.addEventListener('beforeprint', () => {
    before = root.dataset.theme;
    root.dataset.theme = 'light';
    drawAll();
  });
  window.addEventListener('afterprint', () => {
    if (before !== undefined) root.dataset.theme = before;
    drawAll();
  });
}
