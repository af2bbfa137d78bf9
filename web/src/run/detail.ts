// SPDX-License-Identifier: Apache-2.0
// What is held of a channel's past is thinned over the whole run. Once a shorter stretch of it is looked at, that stretch is asked for
// again, as fine as it can be drawn: what is wanted last, and one question at a time.
import { effect, untracked } from '@preact/signals';
import { seriesPath } from '../recorded/model';
import { columnsOf } from '../stream/series_answer';
import type { SeriesAnswer } from '../stream/series_answer';
import { ask } from './connection';
import { asHeard, plottedChannels, store } from './shown';
import { zoomedTo } from './window';

const POINTS = 1000; // ours: of a channel, one a pixel of a usual plot; more takes longer to come than a step of zoom may
const CHANNELS_A_QUESTION = 8; // several small questions are answered side by side

let wanted = '';
let done = '';
let underWay = false;

async function refine(): Promise<void> {
  if (underWay) return;
  underWay = true;
  while (done !== wanted) {
    done = wanted;
    const [run, span, live] = [store.peek(), zoomedTo(), asHeard.value];
    if (!run || !span) break;
    const [from, to] = [run.entrySclk + span.from, run.entrySclk + span.to];
    const names = plottedChannels();
    const questions = Array.from({ length: Math.ceil(names.length / CHANNELS_A_QUESTION) }, (_, i) =>
      names.slice(i * CHANNELS_A_QUESTION, (i + 1) * CHANNELS_A_QUESTION),
    );
    try {
      await Promise.all(
        questions.map(async (some) => {
          const list = await ask<SeriesAnswer[]>('series', seriesPath(run.id, some, from, to, POINTS, live));
          if (store.peek() !== run) return;
          performance.mark('aeolis-detail');
          // Live samples that came while the answer was on its way are newer than it, and stay.
          for (const column of columnsOf(list)) run.addRange([column], from, Math.min(to, column.sclk.at(-1) ?? to));
        }),
      );
    } catch {
      // What is held stays; the header says when there is no connection.
    }
  }
  underWay = false;
}

export function refineWhatIsLookedAt(): void {
  effect(() => {
    const span = zoomedTo(); // what follows the run is fine enough as it comes, a whole range as fine as it was asked for
    wanted = span ? `${store.value?.id} ${span.from} ${span.to} ${asHeard.value}` : '';
    if (span) untracked(() => void refine());
    else done = wanted; // the same stretch is asked for anew when it is looked at again
  });
}
