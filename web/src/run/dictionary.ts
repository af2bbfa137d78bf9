// SPDX-License-Identifier: Apache-2.0
// The mission's dictionary from the API, with the look-ups that the panels need.
import { LAYOUT } from '../layout';
import type { DictionaryChannel, DictionaryCommand, DictionaryReply, DictionaryTone } from '../gen/aeolis/v1/run_pb';

export class Dictionary {
  readonly channels: DictionaryChannel[];
  readonly commands: DictionaryCommand[];
  readonly tones = new Map<number, DictionaryTone>();
  private readonly byId = new Map<number, DictionaryChannel>();
  private readonly byName = new Map<string, DictionaryChannel>();

  constructor(readonly reply: DictionaryReply) {
    this.channels = reply.channels;
    this.commands = reply.commands;
    for (const tone of reply.tones) this.tones.set(tone.id, tone);
    for (const channel of reply.channels) {
      this.byId.set(channel.id, channel);
      this.byName.set(channel.name, channel);
    }
  }

  channel(id: number): DictionaryChannel | undefined {
    return this.byId.get(id);
  }

  /** The first of `names` in the dictionary. */
  pick(names: readonly string[]): DictionaryChannel | undefined {
    for (const name of names) {
      const found = this.byName.get(name);
      if (found) return found;
    }
    return undefined;
  }

  command(name: string): DictionaryCommand | undefined {
    return this.commands.find((command) => command.name === name);
  }

  label(channel: DictionaryChannel, value: number): string | undefined {
    return labelOf(channel, value);
  }
}

/** The label of a value, which may be one of a range. */
const labelOf = (channel: DictionaryChannel | undefined, value: number): string | undefined =>
  channel?.labels.find(({ value: first, last }) => value >= Number(first) && value <= Number(last ?? first))?.label;

/** "heatshield_separation" → "heatshield separation". */
export function inWords(name: string): string {
  return (LAYOUT.words as Record<string, string>)[name] ?? name.replaceAll('_', ' ').toLowerCase();
}

/** A report's words, with what its names are elsewhere: "Second Chance (backup computer): alive". */
export const alsoCalled = (words: string): string =>
  words.replace(LAYOUT.alsoCalled.name, `$& (${LAYOUT.alsoCalled.is})`);

/**
 * A value for display: its exact text where a number does not hold it, its label, or five significant digits with at
 * most four decimals.
 */
export function valueText(channel: DictionaryChannel | undefined, value: number | undefined, text?: string): string {
  if (text !== undefined) return text;
  if (value === undefined) return '—';
  if (Number.isNaN(value)) return 'undefined';
  const label = labelOf(channel, value);
  if (label !== undefined) return inWords(label);
  return channel?.needsText ? `≈ ${value.toExponential(6)}` : numberText(value);
}

export function numberText(value: number): string {
  if (!Number.isFinite(value)) return String(value);
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-4) return value.toExponential(3);
  if (size >= 1e5) return value.toFixed(1);
  return value.toFixed(size >= 1000 ? 1 : size >= 100 ? 2 : size >= 1 ? 3 : 4);
}
