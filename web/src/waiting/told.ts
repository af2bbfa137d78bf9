// SPDX-License-Identifier: Apache-2.0
// The server's answers about the beginning of the run shown: the deadline, and the condition that still blocks the next
// step.
import { computed } from '@preact/signals';
import { conditionWords } from '../commands/model';
import { read } from '../run/connection';
import { cutoff, dictionary, shownRun, signalOfRun } from '../run/shown';
import { timelineKnown } from '../timeline/asked';
import { missingStep } from './model';
import type { Against, Told } from './model';

const answered = signalOfRun<{ at: number; against: Against | undefined } | undefined>(undefined);

export const told = computed<Told>(() => ({
  beginBy_e_s: timelineKnown.value?.list.beginByES,
  against: answered.value?.at === cutoff.value ? answered.value.against : undefined,
}));

/** Asks for the preconditions of the next step, if there is one with preconditions. */
export async function refreshAgainst(): Promise<void> {
  const [run, words, at] = [shownRun(), dictionary.value, cutoff.value];
  const missing = run && words && missingStep(run, words, at);
  const isNext = missing !== undefined && missing.number > 0 && missing.state === 'unsent';
  const command = isNext ? words?.command(missing.step.command) : undefined;
  if (!run || !command || command.preconditions.length === 0) return;
  const query = new URLSearchParams({ command: command.name, ...(at !== Infinity && { at: String(at) }) });
  try {
    const { preconditions = [] } = await read<{ preconditions?: { text?: string; state?: string }[] }>(
      `/runs/${run.id}/preconditions?${query}`,
    );
    const fails = preconditions.find((each) => each.state === 'fails');
    if (shownRun()?.id === run.id)
      answered.value = { at, against: fails && { command: command.name, ...conditionWords(fails.text ?? '') } };
  } catch {
    // No objection is known; the dry run of the command will report any.
  }
}
