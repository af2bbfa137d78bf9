// SPDX-License-Identifier: Apache-2.0
// Fetches detail for a zoomed stretch. The history held of a channel is thinned over the whole run; a shorter stretch
// is requested again at the resolution of the plot. Only the newest wish counts, with one round of requests at a time.
import { effect, untracked } from '@preact/signals';
import { seriesPath } from '../recorded/model';
import { columnsOf } from '../stream/series_answer';
import type { SeriesAnswer } from '../stream/series_answer';
import { ask } from './connection';
import { asHeard, plottedChannels, store } from './shown';
import { zoomedTo } from './window';

const POINTS = 1000; // chosen: per channel, one a pixel of a usual plot; more would take longer than a zoom step may
const CHANNELS_A_QUESTION = 8; // several small requests are answered side by side

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
          // Live samples newer than the answer stay.
          for (const column of columnsOf(list)) run.addRange([column], from, Math.min(to, column.sclk.at(-1) ?? to));
        }),
      );
    } catch {
      // The held samples stay; the header reports a lost connection.
    }
  }
  underWay = false;
}

export function refineWhatIsLookedAt(): void {
  effect(() => {
    const span = zoomedTo(); // live data and a whole range already have the right resolution
    wanted = span ? `${store.value?.id} ${span.from} ${span.to} ${asHeard.value} ${plottedChannels().join()}` : '';
    if (span) untracked(() => void refine());
    else done = wanted; // a later view of the same stretch asks again
  });
}
