// The colours of the style sheet, for canvases. Read once a theme.

const NAMES = [
  'text', 'dim', 'faint', 'line', 'panel', 'raised', 'page', 'blue', 'violet', 'amber', 'green', 'red', 'trace', 'ghost',
] as const;
export type Palette = Record<(typeof NAMES)[number], string> & { name: string; sans: string; mono: string };

let read: Palette | undefined;

export function palette(): Palette {
  const name = document.documentElement.dataset['theme'] ?? 'dark';
  if (read?.name === name) return read;
  const style = getComputedStyle(document.documentElement);
  const colours = { name, sans: style.getPropertyValue('--sans'), mono: style.getPropertyValue('--mono') } as Palette;
  for (const each of NAMES) colours[each] = style.getPropertyValue(`--${each}`).trim();
  read = colours;
  return colours;
}
