// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import { PacketSchema } from '../gen/aeolis/v1/items_pb';
import { PacketRowSchema } from '../gen/aeolis/v1/run_pb';
import { aRun, aStore, ertUs, unit } from '../testing/fixtures';
import {
  fieldsAt,
  heardRows,
  hexLines,
  linkRows,
  newestPackets,
  octetsOf,
  packetStreams,
  pageWords,
  placeWords,
} from './model';

// the run's clock is at 05:00:00
const at = (seconds: number) => `2012-219T04:59:${String(seconds).padStart(2, '0')}.0`;
const some = [
  unit({ unit: 1n, apid: 0x20, name: 'Status', octets: 999, ert: at(40) }),
  unit({ unit: 2n, apid: 0x20, name: 'Status', octets: 100, ert: at(51) }),
  unit({ unit: 3n, apid: 0x21, name: 'Navigation', octets: 400, ert: at(55) }),
  unit({ unit: 4n, apid: 0x20, name: 'Status', octets: 100, ert: at(59), link: 'relay', duplicate: true }),
];

describe('what the links bring', () => {
  it('is counted by link and by packet, its rate over the last ten seconds of stream time', () => {
    const store = aStore(some);
    expect(linkRows(store)).toEqual([
      { link: 'uhf_live', packets: 3, octets: 1499, duplicates: 0, rate: { packets_per_s: 0.2, octets_per_s: 50 } },
      { link: 'relay', packets: 1, octets: 100, duplicates: 1, rate: { packets_per_s: 0.1, octets_per_s: 10 } },
    ]);
    expect(packetStreams(store)).toEqual([
      {
        apid: 0x20,
        name: 'Status',
        packets: 3,
        octets: 1199,
        duplicates: 1,
        rate: { packets_per_s: 0.2, octets_per_s: 20 },
      },
      {
        apid: 0x21,
        name: 'Navigation',
        packets: 1,
        octets: 400,
        duplicates: 0,
        rate: { packets_per_s: 0.1, octets_per_s: 40 },
      },
    ]);
  });
  it('has no rate once the run is over', () => {
    expect(linkRows(aStore(some, aRun({ state: 'finished' })))[0]?.rate).toBeUndefined();
  });
  it('is listed newest first, all of it or one packet', () => {
    expect(newestPackets(aStore(some), 2).map(({ fact }) => Number(fact.unit))).toEqual([4, 3]);
    expect(newestPackets(aStore(some), 2, 'Status').map(({ fact }) => Number(fact.unit))).toEqual([4, 2]);
  });
});

it('in the past as it was heard are neither packets of the recording nor those that an orbiter brought later', () => {
  const row = (unit: number, ert: string, source = 1) =>
    create(PacketRowSchema, {
      ertUs: ertUs(ert),
      unit: create(PacketSchema, { unit: BigInt(unit), sclk: 800, source }),
    });
  const rows = [row(1, at(20)), row(2, at(40)), row(3, at(20), 2)]; // E-100 is heard at 05:00:00, E-130 at 04:59:30
  expect(
    [870, Infinity].map((cutoff) => heardRows(aStore(), rows, cutoff).map(({ unit }) => Number(unit?.unit))),
  ).toEqual([[1], [1, 2]]);
});

it('a page of a range says where in it it lies, and how many there are once that is known', () => {
  expect([pageWords(0, 100, 100, true), pageWords(2, 100, 43, false), pageWords(0, 100, 0, false)]).toEqual([
    'packets 1 to 100 of more than 100, oldest first',
    'packets 201 to 243 of 243, oldest first',
    'no packet in this range',
  ]);
});

describe('a packet, octet by octet', () => {
  const fields = [
    { positionBits: 0, bits: 3 },
    { positionBits: 5, bits: 11 },
    { positionBits: 16, bits: 64 },
  ];
  it('is shown sixteen octets a line with their letters', () => {
    expect(hexLines(`${'41'.repeat(16)}00`)).toEqual([
      { at: '0000', first: 0, octets: Array(16).fill('41'), text: Array(16).fill('A') },
      { at: '0010', first: 16, octets: ['00'], text: ['·'] },
    ]);
  });
  it('knows which octets a field lies in, and which fields an octet holds', () => {
    expect(fields.map(octetsOf)).toEqual([
      { first: 0, last: 0 },
      { first: 0, last: 1 },
      { first: 2, last: 9 },
    ]);
    expect([0, 1, 9, 10].map((octet) => fieldsAt(fields, octet))).toEqual([[0, 1], [1], [2], []]);
  });
  it('says the place of a field in words', () => {
    expect([...fields, { positionBits: 24, bits: 8 }, { positionBits: 31, bits: 1 }].map(placeWords)).toEqual([
      'bits 0 to 2 of octet 0',
      'octets 0 to 1',
      'octets 2 to 9',
      'octet 3',
      'bit 7 of octet 3',
    ]);
  });
});
