// Units as they arrived, and how fast each link brings them.
import type { RunStore, Known } from '../run/store';
import type { Unit } from '../gen/aeolis/v1/items_pb';
import { secondsOfDayOfYear } from '../run/time';

export interface LinkRate {
  link: string;
  units: number;
  octets: number;
  duplicates: number;
  /** of the last units that are held, in stream time */
  octets_per_s: number | undefined;
}

export function linkRates(store: RunStore): LinkRate[] {
  return [...store.unitTotals].map(([link, totals]) => {
    const recent = store.units.filter(({ fact }) => fact.link === link);
    const first = recent[0];
    const last = recent[recent.length - 1];
    const span = first && last ? secondsOfDayOfYear(last.fact.ert) - secondsOfDayOfYear(first.fact.ert) : 0;
    const octets = recent.slice(1).reduce((sum, { fact }) => sum + fact.octets, 0);
    return { link, ...totals, octets_per_s: span > 0 ? octets / span : undefined };
  });
}

export function newestUnits(store: RunStore, most: number): Known<Unit>[] {
  return store.units.slice(-most).reverse();
}

export interface HexLine {
  at: string;
  octets: string;
  text: string;
}

/** Sixteen octets a line, with their text beside them. */
export function hexLines(hex: string): HexLine[] {
  const lines: HexLine[] = [];
  for (let i = 0; i < hex.length; i += 32) {
    const part = hex.slice(i, i + 32);
    const octets = part.match(/../g) ?? [];
    lines.push({
      at: (i / 2).toString(16).padStart(4, '0'),
      octets: octets.join(' '),
      text: octets.map((octet) => {
        const code = parseInt(octet, 16);
        return code >= 32 && code < 127 ? String.fromCharCode(code) : '·';
      }).join(''),
    });
  }
  return lines;
}
