// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { TYPE } from './type';
import tokens from './tokens.css?raw';

const styles = import.meta.glob<string>('../**/*.css', { query: '?raw', import: 'default', eager: true });
const scripts = import.meta.glob<string>(['../**/*.{ts,tsx}', '!../**/*.spec.*', '!../gen/**'], {
  query: '?raw',
  import: 'default',
  eager: true,
});

it('the style sheets set no size that is not of the scale', () => {
  const strange = Object.entries(styles).flatMap(([file, css]) =>
    [...css.replace(/\/\*[^]*?\*\//g, '').matchAll(/(?<![\w-])font(?:-size)?:\s*([^;]+);/g)]
      .map((match) => match[1] as string)
      .filter((value) => !/var\(--t-[\w-]+\)|^inherit$|^0$/.test(value) && /\d/.test(value.replace(/^\d00\b/, '')))
      .map((value) => `${file}: ${value}`),
  );
  expect(Object.keys(styles).length).toBeGreaterThan(20);
  expect(strange).toEqual([]);
});

it('each name of a size is of the scale', () => {
  const known = new Set([...tokens.matchAll(/--(t-[\w-]+):/g)].map((match) => match[1]));
  const used = Object.values(styles).flatMap((css) =>
    [...css.matchAll(/var\(--(t-[\w-]+)\)/g)].map((match) => match[1]),
  );
  expect([...new Set(used)].filter((name) => !known.has(name))).toEqual([]);
});

it('pictures take their type from the same scale', () => {
  for (const [name, px] of Object.entries(TYPE)) expect(tokens).toContain(`--t-${name}: ${px}px;`);
  const strange = Object.entries(scripts).flatMap(([file, text]) =>
    [...text.matchAll(/font\w*\s*[=:]\s*[^;\n]*[`' ](\d[\d.]*)px/g)].map((match) => `${file}: ${match[0]}`),
  );
  expect(strange).toEqual([]);
});
