// SPDX-License-Identifier: Apache-2.0
// What can be done with a value, from it to anything else. What cannot be done now says why.
import { openReport } from '../anomaly/opened';
import { CHOICES, PANELS, full, placeOf, showAt, toggleFull } from '../places/model';
import { isFull, isInPlots, isOwnPlot, plotIt, plotOver, plotsToJoin, takeOut } from '../plots/chosen';
import { isShown, layouts, showLayout } from '../layouts/model';
import type { DictionaryChannel } from '../gen/aeolis/v1/run_pb';
import { dictionary, shownRun } from '../run/shown';
import { fromEntry } from '../run/time';
import { focusPanel } from '../shortcuts/model';
import { pointAt } from '../situation/model';
import { SOUNDS, chooseSound, overPast, sound, toggleOverPast, whyNo } from '../sound/model';
import type { Opened } from './model';

/** What an item opens in place of the menu. */
export type Sheet = 'limits' | 'why' | 'bytes' | 'link' | 'layouts';

export interface Item {
  words: string;
  act?: () => void;
  opens?: Sheet;
  /** Why it cannot be done now. */
  why?: string | undefined;
  /** Of a choice, or of a box to tick: whether it is chosen. */
  checked?: boolean;
  isBox?: boolean;
  key?: string;
}
/** Groups of items, a line between two. */
export type Items = Item[][];

const LINK: Item = { words: 'Copy a link to what is shown', opens: 'link', key: 'q' };

function channelItems(channel: DictionaryChannel): Items {
  const { name, packet } = channel;
  const hasNone = shownRun() ? undefined : 'there is no run';
  return [
    [
      {
        words: 'Plot it',
        act: () => plotIt(name),
        why: isOwnPlot(name) ? 'it has a plot' : isFull() ? 'no room for another plot' : undefined,
      },
      ...plotsToJoin(name).map(({ at, title }) => ({ words: `Plot it over ${title}`, act: () => plotOver(name, at) })),
      ...(isInPlots(name) ? [{ words: 'Take it out of the plots', act: () => takeOut(name) }] : []),
    ],
    [
      { words: 'Its bytes', opens: 'bytes', why: hasNone ?? (packet === '' ? 'no packet brings it' : undefined) },
      { words: 'Its alarm limits', opens: 'limits', why: channel.limits.length === 0 ? 'it has none' : undefined },
      { words: 'Why: what it rests on', opens: 'why', why: hasNone },
    ],
    [LINK],
  ];
}

function pointItem(e_s: number | undefined): Item {
  return e_s === undefined
    ? { words: 'Point at its instant', why: 'not known' }
    : { words: `Point at ${fromEntry(e_s, { tenths: true })} in plots and timeline`, act: () => pointAt(e_s) };
}

/** When a timepoint or an event was, by what is shown. */
function instantOf(name: string): number | undefined {
  const run = shownRun();
  const pair = [...(run?.firings.values() ?? [])].find((each) => each.name === name);
  const event = run?.events.find(({ fact }) => fact.name.toLowerCase() === name.toLowerCase());
  const sclk = (pair?.live ?? pair?.recorded)?.firedSclk ?? event?.fact.sclk;
  return run && sclk !== undefined ? sclk - run.entrySclk : undefined;
}

function panelItems(name: string): Items {
  const place = placeOf(name);
  const chosen = place === 'middle' || place === 'low';
  const alone = name === 'data' ? undefined : () => window.open(`?panel=${name}`, '_blank', 'noopener');
  return [
    [
      { words: full.value === name ? 'Back to its size' : 'Full size', act: () => toggleFull(name), key: 'z' },
      ...(alone && Object.hasOwn(PANELS, name) ? [{ words: 'Alone, for another monitor', act: alone }] : []),
    ],
    chosen && full.value === undefined
      ? CHOICES.filter((each) => each !== name).map((each) => ({
          words: `${PANELS[each]} here`,
          act: () => showAt(place, each),
        }))
      : [],
    [LINK],
  ];
}

function displayItems(): Items {
  const kept = layouts.value;
  return [
    [LINK, { words: 'Anomaly report of what is on the screen', act: openReport, key: '!' }],
    SOUNDS.map((each) => ({
      words: `Call-outs: ${each === 'words' ? 'in words' : each === 'tones' ? 'by tones' : 'off'}`,
      checked: sound.value === each,
      act: () => chooseSound(each),
      why: whyNo(each),
      ...(each === 'off' && { key: '0' }),
    })),
    sound.value === 'off'
      ? []
      : [{ words: 'Call out while a past is shown, too', checked: overPast.value, isBox: true, act: toggleOverPast }],
    [
      { words: 'Layout: as the console comes', checked: isShown(), act: () => showLayout() },
      ...(kept ?? []).map((each) => ({
        words: `Layout: ${each.name}`,
        checked: isShown(each),
        act: () => showLayout(each),
      })),
      { words: 'Save or remove layouts …', opens: 'layouts' },
    ],
  ];
}

/** The items of a menu; undefined: there is nothing of this name. */
export function itemsOf({ kind, name, e_s }: Pick<Opened, 'kind' | 'name' | 'e_s'>): Items | undefined {
  switch (kind) {
    case 'channel': {
      const channel = dictionary.value?.pick([name]);
      return channel && channelItems(channel);
    }
    case 'packet':
      return [
        [
          { words: 'Its packets', opens: 'bytes' },
          { words: 'Why: what is known of it', opens: 'why' },
        ],
        [LINK],
      ];
    case 'link':
      return [
        [
          { words: 'All links', act: () => focusPanel('links') },
          { words: 'Why: what is known of it', opens: 'why' },
        ],
        [LINK],
      ];
    case 'timepoint':
      return [[pointItem(e_s ?? instantOf(name)), { words: 'Why: what it rests on', opens: 'why' }], [LINK]];
    case 'instant':
      return [[pointItem(e_s)], [LINK]];
    case 'panel':
      return panelItems(name);
    case 'display':
      return displayItems();
    default:
      return undefined;
  }
}
