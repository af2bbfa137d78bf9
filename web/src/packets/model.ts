// SPDX-License-Identifier: Apache-2.0
// Packets as received: the rates of each link and packet, and the octets of each field.
import type { Packet } from '../gen/aeolis/v1/items_pb';
import type { PacketField, PacketRow } from '../gen/aeolis/v1/run_pb';
import type { Known, RunStore, PacketTotals } from '../run/store';
import { secondsOfErt } from '../run/time';
import { SOURCE_RECORDED } from '../stream/columns';

interface Totals {
  packets: number;
  octets: number;
  duplicates: number;
}
export interface Rate {
  packets_per_s: number;
  octets_per_s: number;
}
interface LinkRow extends Totals {
  link: string;
  rate: Rate | undefined;
}
interface PacketStream extends Totals {
  apid: number;
  name: string;
  rate: Rate | undefined;
}

const WINDOW_S = 10; // chosen: of stream time

/**
 * The packets of the last ten seconds, or as far back as they are held. Undefined after the end of the run, when there
 * are no rates.
 */
function recentOf(store: RunStore): { packets: Packet[]; span_s: number } | undefined {
  const now = secondsOfErt(store.clocks?.ertUs);
  const oldest = store.packets[0];
  if (!store.going || !oldest || !Number.isFinite(now)) return undefined;
  const from = Math.max(now - WINDOW_S, oldest.ert_s);
  if (now <= from) return undefined;
  const first = store.packets.findLastIndex(({ ert_s }) => ert_s < from) + 1;
  return { packets: store.packets.slice(first).map(({ fact }) => fact), span_s: now - from };
}

function rateOf(recent: ReturnType<typeof recentOf>, belongs: (unit: Packet) => boolean): Rate | undefined {
  if (!recent) return undefined;
  const packets = recent.packets.filter(belongs);
  return {
    packets_per_s: packets.length / recent.span_s,
    octets_per_s: packets.reduce((sum, unit) => sum + unit.octets, 0) / recent.span_s,
  };
}

function grouped<K>(
  all: Iterable<PacketTotals>,
  key: (each: PacketTotals) => K,
): Map<K, { first: PacketTotals } & Totals> {
  const groups = new Map<K, { first: PacketTotals } & Totals>();
  for (const each of all) {
    const group = groups.get(key(each)) ?? { first: each, packets: 0, octets: 0, duplicates: 0 };
    group.packets += each.packets;
    group.octets += each.octets;
    group.duplicates += each.duplicates;
    groups.set(key(each), group);
  }
  return groups;
}

export function linkTotals(store: RunStore): (Totals & { link: string })[] {
  return [...grouped(store.packetTotals.values(), (each) => each.link).values()].map(({ first, ...totals }) => ({
    link: first.link,
    ...totals,
  }));
}

/** `rated`: with present rates, which a past view does not have. */
export function linkRows(store: RunStore, rated = true): LinkRow[] {
  const recent = rated ? recentOf(store) : undefined;
  return linkTotals(store).map((totals) => ({ ...totals, rate: rateOf(recent, (unit) => unit.link === totals.link) }));
}

/** Each packet of the dictionary that has arrived, over any link. Several may share an APID. */
export function packetStreams(store: RunStore, rated = true): PacketStream[] {
  const recent = rated ? recentOf(store) : undefined;
  return [...grouped(store.packetTotals.values(), (each) => `${each.apid} ${each.name}`).values()]
    .map(({ first, ...totals }) => ({
      apid: first.apid,
      name: first.name,
      ...totals,
      rate: rateOf(recent, (unit) => unit.apid === first.apid && unit.name === first.name),
    }))
    .sort((a, b) => a.apid - b.apid || a.name.localeCompare(b.name));
}

/**
 * The rows of an archive range that were heard by `cutoff`: without packets of the recording, and without packets that
 * an orbiter or a queue on board delivered later.
 */
export function heardRows(store: RunStore, rows: readonly PacketRow[], cutoff: number): PacketRow[] {
  return rows.filter(
    ({ unit, ertUs }) => unit && unit.source !== SOURCE_RECORDED && store.knownBy(secondsOfErt(ertUs), cutoff),
  );
}

export function newestPackets(store: RunStore, most: number, packet?: string): Known<Packet>[] {
  return store.packets
    .filter(({ fact }) => packet === undefined || fact.name === packet)
    .slice(-most)
    .reverse();
}

/** The position of a page within a range of the archive, in words. */
export function pageWords(page: number, size: number, listed: number, more: boolean): string {
  const first = page * size;
  if (listed === 0) return 'no packet in this range';
  return `packets ${first + 1} to ${first + listed} of ${more ? `more than ${first + listed}` : first + listed}, oldest first`;
}

interface HexLine {
  at: string;
  first: number; // index of its first octet
  octets: string[];
  text: string[];
}

/** Sixteen octets per line, with their text. */
export function hexLines(hex: string): HexLine[] {
  const all = hex.match(/../g) ?? [];
  const lines: HexLine[] = [];
  for (let first = 0; first < all.length; first += 16) {
    const octets = all.slice(first, first + 16);
    lines.push({
      at: first.toString(16).padStart(4, '0'),
      first,
      octets,
      text: octets.map((octet) => {
        const code = parseInt(octet, 16);
        return code >= 32 && code < 127 ? String.fromCharCode(code) : '·';
      }),
    });
  }
  return lines;
}

/** The first and the last octet of a field. */
export function octetsOf(field: Pick<PacketField, 'positionBits' | 'bits'>): { first: number; last: number } {
  return {
    first: Math.floor(field.positionBits / 8),
    last: Math.floor((field.positionBits + Math.max(1, field.bits) - 1) / 8),
  };
}

/** Indices of the fields that lie at least partly in an octet. */
export function fieldsAt(fields: readonly Pick<PacketField, 'positionBits' | 'bits'>[], octet: number): number[] {
  return fields.flatMap((field, i) => {
    const { first, last } = octetsOf(field);
    return octet >= first && octet <= last ? [i] : [];
  });
}

/** "octet 14", "octets 14 to 21", "bits 3 to 5 of octet 14". */
export function placeWords(field: Pick<PacketField, 'positionBits' | 'bits'>): string {
  const { first, last } = octetsOf(field);
  const from = field.positionBits % 8;
  const to = (field.positionBits + field.bits - 1) % 8;
  if (first === last && (from !== 0 || to !== 7))
    return `bit${from === to ? ` ${from}` : `s ${from} to ${to}`} of octet ${first}`;
  return first === last ? `octet ${first}` : `octets ${first} to ${last}`;
}
