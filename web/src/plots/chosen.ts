// SPDX-License-Identifier: Apache-2.0
// Which channels are plotted, together or each for itself.
import { LAYOUT } from '../layout';
import { MOST_PLOTS, MOST_TOGETHER, full } from '../places/model';
import { dictionary, plots } from '../run/shown';

/** The channels of each plot, from top to bottom. */
export function plotsNow(): readonly (readonly string[])[] {
  return (
    plots.value ??
    LAYOUT.plots.flatMap(({ channel }) => [dictionary.value?.pick(channel)?.name ?? []].flat()).map((name) => [name])
  );
}

export const titleOf = (names: readonly string[]): string =>
  [
    LAYOUT.plots.find(({ channel }) => (channel as readonly string[]).includes(names[0] ?? ''))?.title ?? names[0],
    ...names.slice(1),
  ].join(', ');

export const isOwnPlot = (channel: string): boolean => plotsNow().some((names) => names[0] === channel);
export const isInPlots = (channel: string): boolean => plotsNow().some((names) => names.includes(channel));
export const isFull = (): boolean => plotsNow().length >= MOST_PLOTS;

/** The plots that the channel can join, by their places. */
export const plotsToJoin = (channel: string): { at: number; title: string }[] =>
  plotsNow().flatMap((names, at) =>
    names.includes(channel) || names.length >= MOST_TOGETHER ? [] : [{ at, title: titleOf(names) }],
  );

export function plotIt(channel: string): void {
  if (isFull()) return;
  plots.value = [...plotsNow(), [channel]];
  bringPlotsUp(channel);
}

export function plotOver(channel: string, at: number): void {
  plots.value = plotsNow().map((names, i) => (i === at ? [...names, channel] : names));
  bringPlotsUp(plots.value[at]?.[0] ?? channel);
}

/** Takes the channel out of every plot; of none left, the plots are those of the console. */
export function takeOut(channel: string): void {
  const left = plotsNow()
    .map((names) => names.filter((name) => name !== channel))
    .filter((names) => names.length > 0);
  plots.value = left.length > 0 ? left : undefined;
}

function bringPlotsUp(channel: string): void {
  if (full.value !== undefined) full.value = 'plots';
  requestAnimationFrame(() =>
    document.querySelector(`.plots [data-menu="channel ${CSS.escape(channel)}"]`)?.scrollIntoView({ block: 'nearest' }),
  );
}
