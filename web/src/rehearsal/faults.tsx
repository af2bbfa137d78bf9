// SPDX-License-Identifier: Apache-2.0
// The form for injecting a fault in the next cycle, and faults in words.
import { signal } from '@preact/signals';
import { Device, DeviceFaultKind } from '../gen/aeolis/v1/scenario_pb';
import { busy, inject } from './instructor';
import type { Fault } from './instructor';

const words = (name: string): string => name.toLowerCase().replaceAll('_', ' ');
// Uses the enumerations, not their descriptors: these would load the whole protobuf library, which only the worker
// needs.
const namesOf = (all: object, prefix: string): string[] =>
  Object.keys(all)
    .filter((name) => !/^\d+$/.test(name))
    .slice(1)
    .map((name) => prefix + name);
const DEVICES = namesOf(Device, 'DEVICE_');
const KINDS = namesOf(DeviceFaultKind, 'DEVICE_FAULT_KIND_');
const SYSTEM = 'a system outside EDL';
const COMPUTER = 'the prime computer';
const STATION = 'the ground station';
const deviceWords = (name: string): string => words(name.replace('DEVICE_', ''));
const kindWords = (name: string): string => words(name.replace('DEVICE_FAULT_KIND_', ''));

const what = signal(DEVICES[0] ?? SYSTEM);
const unit = signal('A');
const kind = signal(KINDS[0] ?? '');
const seconds = signal('10');

/** The fault as the server expects it. */
export function injectionOf(device: string, of_unit: string, how: string, duration_s: number): Fault {
  if (device === COMPUTER) return { computer_reset: true };
  if (device === STATION) return { station_outage: { duration_s } };
  if (device === SYSTEM) return { system_fault: { duration_s } };
  return { device_fault: { device, unit: `REDUNDANT_UNIT_${of_unit}`, kind: how, duration_s } };
}

export function faultWords({ device_fault: device, system_fault: system, station_outage: station }: Fault): string {
  if (device)
    return `${deviceWords(device.device)} ${device.unit.at(-1)} ${kindWords(device.kind)}, for ${device.duration_s} s`;
  if (station) return `${STATION} brings nothing, for ${station.duration_s} s`;
  return system ? `${SYSTEM}, for ${system.duration_s} s` : `${COMPUTER} starts anew`;
}

const hasLength = () => what.value !== COMPUTER;
export const badLength = () => hasLength() && !(Number(seconds.value) > 0);

/** The fault that the fields say. */
export const pickedFault = (): Fault => injectionOf(what.value, unit.value, kind.value, Number(seconds.value));

/** Which fault, and for how long. */
export function FaultFields() {
  const device = ![SYSTEM, COMPUTER, STATION].includes(what.value);
  return (
    <>
      <label>
        break{' '}
        <select
          value={what.value}
          data-testid="fault-what"
          onChange={(event) => (what.value = event.currentTarget.value)}
        >
          {DEVICES.map((name) => (
            <option key={name} value={name}>
              {deviceWords(name)}
            </option>
          ))}
          <option value={SYSTEM}>{SYSTEM}</option>
          <option value={COMPUTER}>{COMPUTER}</option>
          <option value={STATION}>{STATION}</option>
        </select>
      </label>
      {device && (
        <label>
          unit{' '}
          <select
            value={unit.value}
            data-testid="fault-unit"
            onChange={(event) => (unit.value = event.currentTarget.value)}
          >
            <option>A</option>
            <option>B</option>
          </select>
        </label>
      )}
      {device && (
        <label>
          so that it is{' '}
          <select
            value={kind.value}
            data-testid="fault-kind"
            onChange={(event) => (kind.value = event.currentTarget.value)}
          >
            {KINDS.map((name) => (
              <option key={name} value={name}>
                {kindWords(name)}
              </option>
            ))}
          </select>
        </label>
      )}
      {hasLength() && (
        <label>
          for{' '}
          <input
            class="seed"
            value={seconds.value}
            inputMode="decimal"
            aria-invalid={badLength()}
            data-testid="fault-seconds"
            onInput={(event) => (seconds.value = event.currentTarget.value)}
          />{' '}
          s
        </label>
      )}
    </>
  );
}

export function FaultForm() {
  const bad = badLength();
  return (
    <form
      class="table-tools"
      data-testid="faults"
      aria-label="faults"
      onSubmit={(event) => {
        event.preventDefault();
        if (!bad) void inject(pickedFault());
      }}
    >
      <FaultFields />
      <button type="submit" disabled={bad || busy.value} data-testid="fault-inject">
        inject now
      </button>
      {bad && <span class="status-alarm">✖ a length in seconds, above 0</span>}
    </form>
  );
}
