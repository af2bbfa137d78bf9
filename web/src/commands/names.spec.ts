// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import type { DictionaryArgument, DictionaryCommand } from '../gen/aeolis/v1/run_pb';
import { fieldsOf, rangeText } from './model';
import { argumentsInWords, rowName, withNames } from './names';

const rows = {
  timepoint: [
    { id: 0, name: 'coolant_vent' },
    { id: 31, name: 'heatshield_separation' },
  ],
  anchor: [{ id: 2, name: 'parachute' }],
};
const argument = (name: string): DictionaryArgument =>
  ({ name, labels: [], integer: true, min: 0, max: 255, unit: '', text: '' }) as unknown as DictionaryArgument;
const command = {
  name: 'MOVE',
  arguments: [argument('timepoint'), argument('offset_s')],
} as unknown as DictionaryCommand;

it('an argument that numbers a timepoint takes its name or its number, and no other argument does', () => {
  const named = withNames(command, rows);
  const given = (text: string) => fieldsOf(named, new Map([['timepoint', text]]), [])[0];
  expect(given('heatshield_separation')).toMatchObject({ value: 31, problem: undefined });
  expect(given('31')).toMatchObject({ value: 31, problem: undefined });
  expect(given('7')?.problem).toBe('is none of its values');
  expect(rowName(named.arguments[0] as DictionaryArgument, 31)).toBe('heatshield separation');
  expect(named.arguments[1]?.labels).toEqual([]);
  expect(rangeText(named.arguments[0] as DictionaryArgument)).toBe('coolant_vent | heatshield_separation');
});
it('without the timeline the number stays, within its range', () => {
  const named = withNames(command, { timepoint: [], anchor: [] });
  expect(fieldsOf(named, new Map([['timepoint', '7']]), [])[0]).toMatchObject({ value: 7, problem: undefined });
  expect(rowName(named.arguments[0] as DictionaryArgument, 7)).toBeUndefined();
});
it('arguments as sent have the names beside the numbers', () => {
  expect(argumentsInWords('timepoint=31 anchor=2 offset_s=31', rows)).toBe(
    'timepoint=31 (heatshield separation) anchor=2 (parachute) offset_s=31',
  );
});
