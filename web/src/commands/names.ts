// SPDX-License-Identifier: Apache-2.0
// Timepoints and anchors by name, where the dictionary's commands number them.
import type { DictionaryArgument, DictionaryCommand, EnumLabel } from '../gen/aeolis/v1/run_pb';
import { LAYOUT } from '../layout';
import { inWords } from '../run/dictionary';
import { timepoints } from '../run/shown';
import { timelineAnswer } from '../timeline/asked';

export interface Rows {
  timepoint: readonly { id: number; name: string }[];
  anchor: readonly { id: number; name: string }[];
}

/** The rows of the run's timeline as the server listed them; none before its first answer. */
export const rowsNow = (): Rows => ({
  timepoint: timepoints.value,
  anchor: timelineAnswer.value?.list.anchors ?? [],
});

const rowsOf = (argument: string, rows: Rows) => {
  const kind = LAYOUT.numbered.find((each) => each.argument === argument)?.of;
  return kind ? rows[kind] : [];
};

/** The command whose arguments that number a row take its name too: "timepoint=heatshield_separation". */
export function withNames(command: DictionaryCommand, rows: Rows): DictionaryCommand {
  return {
    ...command,
    arguments: command.arguments.map((argument) => {
      const all = argument.labels.length > 0 ? [] : rowsOf(argument.name, rows);
      if (all.length === 0) return argument;
      const labels = all.map(({ id, name }) => ({ value: BigInt(id), label: name }) as EnumLabel);
      return { ...argument, labels };
    }),
  };
}

/** The name of the row that a value numbers: "heatshield separation". */
export function rowName(argument: DictionaryArgument, value: number | undefined): string | undefined {
  if (!LAYOUT.numbered.some((each) => each.argument === argument.name)) return undefined;
  const label = argument.labels.find((each) => Number(each.value) === value)?.label;
  return label === undefined ? undefined : inWords(label);
}

/** "timepoint=31 offset_s=2" with the name of the row beside its number. */
export const argumentsInWords = (text: string, rows: Rows): string =>
  text.replace(/(\w+)=(\d+)(?=\s|$)/g, (all, argument: string, number: string) => {
    const row = rowsOf(argument, rows).find(({ id }) => id === Number(number));
    return row ? `${all} (${inWords(row.name)})` : all;
  });
