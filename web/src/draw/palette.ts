// SPDX-License-Identifier: Apache-2.0
// The colours of the style sheet for canvases, read once per theme.

const TOKENS = {
  text: 'text',
  dim: 'dim',
  edge: 'edge',
  line: 'line',
  panel: 'panel',
  raised: 'raised',
  page: 'page',
  ghost: 'ghost',
  chosen: 'chosen',
  accent: 'accent',
  good: 'good',
  caution: 'caution',
  alarm: 'alarm',
  uhf: 'by-uhf',
  tone: 'by-tone',
  recording: 'by-recording',
  rehearsal: 'mode-rehearsal',
} as const;
export type Palette = Record<keyof typeof TOKENS, string> & { name: string; sans: string; mono: string };

let read: Palette | undefined;
let faces = 0; // of type that have come: pictures are then drawn again, as in another theme
document.fonts?.addEventListener('loadingdone', () => {
  faces += 1;
  read = undefined;
});

export function palette(): Palette {
  const name = `${document.documentElement.dataset.theme ?? 'dark'} ${faces}`;
  if (read?.name === name) return read;
  const style = getComputedStyle(document.documentElement);
  const colours = { name, sans: style.getPropertyValue('--sans'), mono: style.getPropertyValue('--mono') } as Palette;
  for (const [each, token] of Object.entries(TOKENS))
    colours[each as keyof typeof TOKENS] = style.getPropertyValue(`--${token}`).trim();
  read = colours;
  return colours;
}
