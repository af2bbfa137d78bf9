// SPDX-License-Identifier: Apache-2.0
// What a value rests on: the sample, its packet, its alarm, its event. Each line is of an item that is here, or of the
// archive's answer; what is not known says so.
import { SOURCES } from '../design/status';
import type { DictionaryChannel, PacketField, PacketList, PacketRow } from '../gen/aeolis/v1/run_pb';
import { linkTitle } from '../links/model';
import { placeWords } from '../packets/model';
import { ask } from '../run/connection';
import { cursor } from '../run/cursor';
import { valueText } from '../run/dictionary';
import { allLimitsText, limitsAt, limitsText } from '../run/limits';
import { cutoff } from '../run/shown';
import type { RunStore, Sample } from '../run/store';
import { dayOfYear, fromEntry, secondsOfErt } from '../run/time';
import { whoseAt } from '../run/whose';
import { SOURCE_RECORDED } from '../stream/columns';

export type Lines = readonly (readonly [name: string, words: string])[];

const instant = (run: RunStore, sclk: number) => fromEntry(sclk - run.entrySclk, { tenths: true });

/** The SCLK up to which a value is looked for: at the cursor, else the end of what is shown. */
export const lookedAt = (run: RunStore): number =>
  Math.min(cutoff.value, cursor.value === undefined ? Infinity : run.entrySclk + cursor.value);

export function sampleLines(run: RunStore, channel: DictionaryChannel, sample: Sample | undefined): Lines {
  if (!sample) return [['value', run.askedFor.has(channel.name) ? 'not received by then' : 'not asked for yet']];
  const whose = whoseAt(run, channel.name, sample.sclk);
  const alarm = run.alarmAt(channel.id, sample.sclk);
  const source = sample.recorded ? SOURCES.recording : SOURCES.uhf;
  return [
    ['value', `${valueText(channel, sample.value, sample.text)} ${channel.unit}`.trim()],
    ['of', `${instant(run, sample.sclk)} (SCLK ${sample.sclk.toFixed(3)})`],
    ...(sample.byReception ? [['time', 'of reception: its packet holds none'] as const] : []),
    ['known', `${source.shape} ${source.word}`],
    ...(whose ? [['whose', whose] as const] : []),
    ['alarm', alarm ? `${alarm.severity} since ${instant(run, alarm.sclk)}: ${alarm.limit}` : 'none in force'],
  ];
}

const PACKET_S = 12; // chosen: a packet holds samples of at most ten seconds

/** The packet that brought a sample, by its name, source and time; undefined: the archive has none. */
export async function packetOf(run: RunStore, packet: string, sample: Sample): Promise<PacketRow | undefined> {
  for (const before_s of [0.001, PACKET_S]) {
    const query = `name=${encodeURIComponent(packet)}&from=${sample.sclk - before_s}&to=${sample.sclk + 0.001}&limit=1000`;
    const { packets } = await ask<PacketList>('packets', `/runs/${run.id}/packets?${query}`);
    const found = packets
      .filter(({ unit }) => unit && (unit.source === SOURCE_RECORDED) === sample.recorded)
      .reduce<PacketRow | undefined>(
        (last, row) => (last?.unit && row.unit && last.unit.sclk >= row.unit.sclk ? last : row),
        undefined,
      );
    if (found) return found;
  }
  return undefined;
}

/** The field of a packet that has a channel's value. */
export const fieldOf = (row: PacketRow, channel: string): PacketField | undefined =>
  row.fields.find(({ name }) => name === channel);

export function packetLines(row: PacketRow, channel: string): Lines {
  const { unit } = row;
  const field = fieldOf(row, channel);
  return [
    ['packet', `${unit?.name}, packet ${unit?.unit}, over ${linkTitle(unit?.link ?? '')}`],
    ['received', `${dayOfYear(secondsOfErt(row.ertUs))} (ERT)`],
    ['bits', field ? `${placeWords(field)}, ${field.bits} bits` : 'its place in the packet is not told'],
    ['verdict', row.verdict.replaceAll('_', ' ')],
  ];
}

export function limitLines(run: RunStore | undefined, channel: DictionaryChannel): Lines {
  const now = limitsAt(channel, run ? lookedAt(run) : Infinity);
  return [
    [
      `now${now?.context ? `, in ${now.context.replaceAll('_', ' ')}` : ''}`,
      now ? limitsText(now.limits) || 'none' : 'not known yet',
    ],
    ...allLimitsText(channel)
      .split('\n')
      .map((line): [string, string] => {
        const [where = '', ...rest] = line.split(': ');
        return rest.length > 0 ? [where, rest.join(': ')] : ['always', where];
      }),
  ];
}

/** What is known of a packet or a link: its last change, with the ground's reason. */
export function linkLines(run: RunStore, link: string): Lines {
  const last = run.links.get(link)?.findLast(({ ert_s }) => run.knownBy(ert_s, lookedAt(run)));
  if (!last) return [['state', 'nothing is known by then']];
  const { up, lost, reason } = last.fact;
  return [
    ['state', up ? 'receiving' : lost ? 'lost' : 'silent'],
    ['since', `${fromEntry(run.sclkSeenAt(last.ert_s) - run.entrySclk)} (item ${last.seq})`],
    ['reason', reason || 'none was given'],
  ];
}

export function packetStateLines(run: RunStore, packet: string, reason: string | undefined): Lines {
  const last = run.packets.findLast(({ fact, ert_s }) => fact.name === packet && run.knownBy(ert_s, lookedAt(run)));
  return [
    [
      'last',
      last
        ? `packet ${last.fact.unit} of ${instant(run, last.fact.sclk)}, over ${linkTitle(last.fact.link)}`
        : 'not among the newest that are held',
    ],
    ...(reason ? [['alarm', reason] as const] : []),
  ];
}

/** What told that a timepoint or event happened, and flight's own reasons. */
export function happeningLines(run: RunStore, name: string): Lines {
  const by = lookedAt(run);
  const isIts = (each: string) => each.toLowerCase() === name.toLowerCase();
  const firing = [...run.firings.values()].find((pair) => isIts(pair.name));
  const fired = firing?.live ?? firing?.recorded;
  const event = run.events.find(({ fact }) => isIts(fact.name) && fact.sclk <= by);
  const tone = run.tonesBy(by).find(({ fact }) => isIts(fact.name));
  const why = run.explanations.filter(({ fact }) => isIts(fact.decision) && fact.sclk <= by).slice(-3);
  const lines: [string, string][] = [
    ...(fired && fired.firedSclk <= by
      ? [['timepoint', `fired ${instant(run, fired.firedSclk)}, ${fired.verdict || 'no verdict'}`] as [string, string]]
      : []),
    ...(event
      ? [
          ['event', `${instant(run, event.fact.sclk)}: ${event.fact.text || event.fact.name} (item ${event.seq})`] as [
            string,
            string,
          ],
        ]
      : []),
    ...(tone
      ? [
          [
            'tone',
            `${tone.fact.tone} from ${instant(run, tone.fact.sclk)}, likelihood ${tone.fact.likelihood.toFixed(3)}`,
          ] as [string, string],
        ]
      : []),
    ...why.map(({ fact }): [string, string] => ['why', fact.text]),
  ];
  return lines.length > 0 ? lines : [['told by', 'nothing yet']];
}
