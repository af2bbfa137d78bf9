// SPDX-License-Identifier: Apache-2.0
// The form for injecting a fault in the next cycle, and faults in words.
import { signal } from '@preact/signals';
import type { Signal } from '@preact/signals';
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
const ORBITERS = 'the orbiters';
const UHF_LOSS = 'octets on UHF';
const WIND = 'the wind';
const AIR = 'the air';
const OTHERS = [SYSTEM, COMPUTER, STATION, ORBITERS, UHF_LOSS, WIND, AIR];
/** What a sensor can be besides what any device can. */
const WRONG = 'MEASURES_WRONGLY';
const SENSORS = ['DEVICE_IMU', 'DEVICE_RADAR'];
const unitOf = (device: string): string => (device === 'DEVICE_IMU' ? 'm/s²' : 'm/s');
const deviceWords = (name: string): string => words(name.replace('DEVICE_', ''));
const kindWords = (name: string): string => words(name.replace('DEVICE_FAULT_KIND_', ''));

const what = signal(DEVICES[0] ?? SYSTEM);
const unit = signal('A');
const kind = signal(KINDS[0] ?? '');
const seconds = signal('10');
const percent = signal('20');
const east = signal('20');
const north = signal('0');
const denser = signal('10');
const offBy = signal('0.1');
const grows = signal('0');

/** Of what is no unit of a device: how much of it. */
interface Amount {
  fraction: number;
  east_mps: number;
  north_mps: number;
  off_by: number;
  grows_per_s: number;
}
const NONE: Amount = { fraction: 0, east_mps: 0, north_mps: 0, off_by: 0, grows_per_s: 0 };

/** The fault as the server expects it. */
export function injectionOf(device: string, of_unit: string, how: string, duration_s: number, amount = NONE): Fault {
  if (device === COMPUTER) return { computer_reset: true };
  if (device === STATION) return { station_outage: { duration_s } };
  if (device === SYSTEM) return { system_fault: { duration_s } };
  if (device === ORBITERS) return { orbiter_outage: { duration_s } };
  if (device === UHF_LOSS) return { uhf_loss: { duration_s, fraction: amount.fraction } };
  if (device === WIND) return { wind_shift: { duration_s, east_mps: amount.east_mps, north_mps: amount.north_mps } };
  if (device === AIR) return { air_shift: { duration_s, fraction: amount.fraction } };
  const unit = `REDUNDANT_UNIT_${of_unit}`;
  const { off_by, grows_per_s } = amount;
  if (how === WRONG) return { sensor_error: { device, unit, duration_s, off_by, grows_per_s } };
  return { device_fault: { device, unit, kind: how, duration_s } };
}

export function faultWords(fault: Fault): string {
  const { device_fault: device, system_fault: system, station_outage: station } = fault;
  const { orbiter_outage: orbiter, uhf_loss: loss, wind_shift: wind } = fault;
  if (device)
    return `${deviceWords(device.device)} ${device.unit.at(-1)} ${kindWords(device.kind)}, for ${device.duration_s} s`;
  if (station) return `${STATION} brings nothing, for ${station.duration_s} s`;
  if (orbiter) return `no orbiter relays, for ${orbiter.duration_s} s`;
  if (loss) return `UHF loses ${+(100 * loss.fraction).toFixed(1)} % of its octets at least, for ${loss.duration_s} s`;
  if (wind)
    return `${WIND} changes by ${wind.east_mps} m/s to the east and ${wind.north_mps} m/s to the north, for ${wind.duration_s} s`;
  if (fault.air_shift) {
    const { fraction, duration_s } = fault.air_shift;
    const percent = +(100 * Math.abs(fraction)).toFixed(1);
    return `${AIR} is ${percent} % ${fraction < 0 ? 'thinner' : 'denser'}, for ${duration_s} s`;
  }
  if (fault.sensor_error) return sensorWords(fault.sensor_error);
  if (fault.false_tone)
    return `the vehicle sends tone ${fault.false_tone.tone} in place of its own, for ${fault.false_tone.duration_s} s`;
  return system ? `${SYSTEM}, for ${system.duration_s} s` : `${COMPUTER} starts anew`;
}

function sensorWords({ device, unit, duration_s, off_by, grows_per_s }: NonNullable<Fault['sensor_error']>): string {
  const amounts = [
    ...(off_by ? [`${off_by} ${unitOf(device)}`] : []),
    ...(grows_per_s ? [`${grows_per_s} ${unitOf(device)} more each second`] : []),
  ];
  const sensor = `${deviceWords(device)} ${unit.at(-1)}`;
  const measures = device === 'DEVICE_IMU' ? 'forces' : 'velocities';
  return `${sensor} measures ${measures} wrongly by ${amounts.join(' and ')}, for ${duration_s} s`;
}

const measuresWrongly = () => SENSORS.includes(what.value) && kind.value === WRONG;
const hasLength = () => what.value !== COMPUTER;
const within = (text: string, least: number, most: number): boolean =>
  text.trim() !== '' && Number(text) >= least && Number(text) <= most;
/** What is wrong with the numbers; empty: nothing. */
export function badNumbers(): string {
  if (hasLength() && !(Number(seconds.value) > 0)) return 'a length in seconds, above 0';
  if (what.value === UHF_LOSS && !within(percent.value, 0.1, 90)) return 'from 0.1 to 90 % of the octets';
  if (what.value === WIND && !(within(east.value, -100, 100) && within(north.value, -100, 100)))
    return 'a wind of −100 to 100 m/s';
  if (what.value === AIR && (!within(denser.value, -50, 100) || Number(denser.value) === 0))
    return 'from 50 % thinner (−50) to 100 % denser, and not 0';
  if (measuresWrongly()) {
    if (!(within(offBy.value, -100, 100) && within(grows.value, -100, 100))) return 'amounts of −100 to 100';
    if (Number(offBy.value) === 0 && Number(grows.value) === 0) return 'an amount that is not 0';
  }
  return '';
}

/** The fault that the fields say. */
export const pickedFault = (): Fault =>
  injectionOf(what.value, unit.value, kind.value, Number(seconds.value), {
    fraction: Number(what.value === AIR ? denser.value : percent.value) / 100,
    off_by: Number(offBy.value),
    grows_per_s: Number(grows.value),
    east_mps: Number(east.value),
    north_mps: Number(north.value),
  });

function NumberField({ of, words, unit, id }: { of: Signal<string>; words: string; unit: string; id: string }) {
  return (
    <label>
      {words}{' '}
      <input
        class="seed"
        value={of.value}
        inputMode="decimal"
        aria-invalid={badNumbers() !== ''}
        data-testid={id}
        onInput={(event) => (of.value = event.currentTarget.value)}
      />{' '}
      {unit}
    </label>
  );
}

/** Which fault, and for how long. */
export function FaultFields() {
  const device = !OTHERS.includes(what.value);
  return (
    <>
      <label>
        break{' '}
        <select
          value={what.value}
          data-testid="fault-what"
          onChange={(event) => {
            what.value = event.currentTarget.value;
            if (kind.value === WRONG && !SENSORS.includes(what.value)) kind.value = KINDS[0] ?? '';
          }}
        >
          {DEVICES.map((name) => (
            <option key={name} value={name}>
              {deviceWords(name)}
            </option>
          ))}
          {OTHERS.map((name) => (
            <option key={name} value={name}>
              {name}
            </option>
          ))}
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
            {SENSORS.includes(what.value) && <option value={WRONG}>{words(WRONG)}</option>}
          </select>
        </label>
      )}
      {what.value === UHF_LOSS && <NumberField of={percent} words="lose" unit="%" id="fault-percent" />}
      {what.value === WIND && <NumberField of={east} words="by" unit="m/s east" id="fault-east" />}
      {what.value === WIND && <NumberField of={north} words="and" unit="m/s north" id="fault-north" />}
      {what.value === AIR && <NumberField of={denser} words="by" unit="% denser" id="fault-denser" />}
      {measuresWrongly() && <NumberField of={offBy} words="by" unit={unitOf(what.value)} id="fault-off" />}
      {measuresWrongly() && (
        <NumberField of={grows} words="and" unit={`${unitOf(what.value)} more each second`} id="fault-grows" />
      )}
      {hasLength() && <NumberField of={seconds} words="for" unit="s" id="fault-seconds" />}
    </>
  );
}

export function FaultForm() {
  const bad = badNumbers();
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
      <button type="submit" disabled={bad !== '' || busy.value} data-testid="fault-inject">
        inject now
      </button>
      {bad && <span class="status-alarm">✖ {bad}</span>}
    </form>
  );
}
