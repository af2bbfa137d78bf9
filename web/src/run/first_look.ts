// SPDX-License-Identifier: Apache-2.0
// A coarse first look at the plotted channels, requested before anything else is known, while the rest of the script,
// the worker and its schema still load. The seamless history replaces it. A failure costs only the head start.
import type { NamedRun } from '../stream/names';
import { LAYOUT } from '../layout';
import { columnsOf, readSeriesList } from '../stream/series_answer';
import type { Column } from '../stream/messages';
import { opened } from './address';
import { askRuns, isGoing } from './start';

const POINTS = 1000; // chosen: per channel

export interface FirstLook {
  run: number;
  columns: Column[];
}

/**
 * Fetches the first look of the run that will be shown (`wanted` 0: the current run, else the newest): the channels
 * named in the address, or the layout's plots.
 */
export async function firstLook(
  runs: readonly NamedRun[],
  wanted: number,
  named: readonly string[],
): Promise<FirstLook | undefined> {
  const run = runs.find((each) => Number(each.run) === wanted) ?? runs.find(isGoing) ?? runs[0];
  if (!run) return undefined;
  const names = named.length > 0 ? named : LAYOUT.plots.map((plot) => plot.channel[0]);
  try {
    const response = await fetch(
      `/api/v1/runs/${run.run}/channels?names=${names.map(encodeURIComponent).join(',')}&points=${POINTS}&format=protobuf`,
      { credentials: 'same-origin' },
    );
    return response.ok
      ? { run: Number(run.run), columns: columnsOf(readSeriesList(new Uint8Array(await response.arrayBuffer()))) }
      : undefined;
  } catch {
    return undefined;
  }
}

interface FirstAnswers {
  runs: Promise<NamedRun[]>;
  look: Promise<FirstLook | undefined>;
}
let asked: FirstAnswers | undefined;

export function askFirst(): void {
  const runs = askRuns();
  asked = {
    runs,
    look: runs.then(
      (all) => firstLook(all, opened.picture.run, opened.picture.plots?.flat() ?? []),
      () => undefined,
    ),
  };
}

/** The answers requested so far; each further call requests them anew. */
export function firstAnswers(): FirstAnswers {
  if (!asked) askFirst();
  const answers = asked as FirstAnswers;
  asked = undefined;
  return answers;
}
