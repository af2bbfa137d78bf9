// SPDX-License-Identifier: Apache-2.0
// Reads samples as the archive answers them: v1.ChannelSeriesList in Protobuf, whose packed columns become typed arrays as they lie there. It
// needs no schema, so that the page can read its first look before the worker has one.
import { SOURCE_RECORDED } from './columns';
import type { Column } from './messages';

export interface SeriesAnswer {
  id: number;
  name: string;
  unit: string;
  /** That the range holds; fewer are given when thinned. */
  samples: number;
  thinned: boolean;
  /** Real time and recording are kept apart, so that each can be seen for itself. Each has samples. */
  columns: Column[];
}

// Numbers of the fields in run.proto; a test holds them against the schema.
const CHANNELS = 1;
const [ID, NAME, UNIT, SAMPLES, THINNED, SCLK, VALUE, SOURCE] = [1, 2, 3, 4, 5, 6, 7, 8];

const NONE = new Uint8Array();

/** Throws on octets that are no such list. */
export function readSeriesList(octets: Uint8Array): SeriesAnswer[] {
  return fieldsOf(octets)
    .filter(({ number }) => number === CHANNELS)
    .map(({ part }) => readSeries(part));
}

export const columnsOf = (list: readonly SeriesAnswer[]): Column[] => list.flatMap((series) => series.columns);

function readSeries(octets: Uint8Array): SeriesAnswer {
  const fields = new Map(fieldsOf(octets).map((field) => [field.number, field]));
  const number = (of: number) => fields.get(of)?.value ?? 0;
  const part = (of: number) => fields.get(of)?.part ?? NONE;
  const text = (of: number) => new TextDecoder().decode(part(of));
  const id = number(ID);
  return {
    id,
    name: text(NAME),
    unit: text(UNIT),
    samples: number(SAMPLES),
    thinned: number(THINNED) !== 0,
    columns: bySource(id, doubles(part(SCLK)), doubles(part(VALUE)), part(SOURCE)), // a source takes an octet
  };
}

/** A copy, for doubles in a message do not lie on multiples of eight. Both are little-endian. */
const doubles = (part: Uint8Array) => new Float64Array(part.slice().buffer);

function bySource(id: number, sclk: Float64Array, value: Float64Array, source: Uint8Array): Column[] {
  if (value.length !== sclk.length || source.length !== sclk.length)
    throw new Error(`samples of channel ${id}: ${sclk.length} times, ${value.length} values, ${source.length} sources`);
  const recorded = source.reduce((count, each) => count + (each === SOURCE_RECORDED ? 1 : 0), 0);
  if (sclk.length === 0) return [];
  if (recorded === 0 || recorded === sclk.length) return [{ id, recorded: recorded > 0, sclk, value }];
  const of = (wanted: boolean): Column => {
    const taken = (_: number, i: number) => (source[i] === SOURCE_RECORDED) === wanted;
    return { id, recorded: wanted, sclk: sclk.filter(taken), value: value.filter(taken) };
  };
  return [of(false), of(true)];
}

/** Of a message: each field with its number, and its value or its octets. */
function fieldsOf(octets: Uint8Array): { number: number; value: number; part: Uint8Array }[] {
  let at = 0;
  const varint = (): number => {
    for (let value = 0, unit = 1; ; unit *= 128) {
      const octet = octets[at++];
      if (octet === undefined) throw new Error('samples: the answer is cut off');
      value += (octet & 0x7f) * unit;
      if (octet < 0x80) return value;
    }
  };
  const fields = [];
  while (at < octets.length) {
    const key = varint();
    const [number, type] = [key >>> 3, key & 7];
    if (type === 1 || type === 5) {
      // of a later schema: passed over
      at += type === 1 ? 8 : 4;
      continue;
    }
    if (type !== 0 && type !== 2) throw new Error(`samples: field ${number} of the answer has type ${type}`);
    const value = varint();
    const part = type === 2 ? octets.subarray(at, at + value) : NONE;
    if (type === 2) at += value;
    if (at > octets.length) throw new Error('samples: the answer is cut off');
    fields.push({ number, value, part });
  }
  return fields;
}
