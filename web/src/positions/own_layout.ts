// SPDX-License-Identifier: Apache-2.0
// The layout of a position: the one that ships, or a person's own of the position's name.
import type { Layout } from '../layouts/model';
import { layouts, loadLayouts, problem, showLayout } from '../layouts/model';
import { positionWords } from '../procedures/position';
import { notify } from '../run/shown';
import { POSITION_VIEWS } from './layout';

/** The layout of a position: the person's own of its name in any case, else the one that ships. */
export function layoutOf(position: string, own: readonly Layout[]): Layout | undefined {
  const name = positionWords(position);
  const view = POSITION_VIEWS[position];
  return (
    own.find((each) => each.name.toLowerCase() === name.toLowerCase()) ??
    (view === undefined ? undefined : { name, view, saved: '' })
  );
}

export async function showLayoutOf(position: string): Promise<void> {
  if (!layouts.value) await loadLayouts();
  const layout = layoutOf(position, layouts.value ?? []);
  if (!layout) return;
  showLayout(layout);
  if (!layouts.value) notify(`${layout.name} as it ships, for ${problem.value}`);
}
