// SPDX-License-Identifier: Apache-2.0
// The anchors that timepoints hang from, as a tree: each with its parent, its offset from it, when it is, and what says so.
import { LAYOUT } from '../layout';
import type { AnchorRow, TimepointRow } from '../gen/aeolis/v1/run_pb';
import { inWords } from '../run/dictionary';
import type { Dictionary } from '../run/dictionary';
import type { RunStore } from '../run/store';
import { anchorsFound, anchorsNow } from './predict';
import type { Anchors, Change } from './predict';

export interface AnchorLine {
  id: number;
  name: string;
  /** 0: the root. */
  depth: number;
  parent: string;
  /** From the parent: as a command has set it, else as the plan has it. */
  offset_s: number | undefined;
  /** From entry; undefined of the root, and where nothing is known. */
  e_s: number | undefined;
  state: 'defined' | 'predicted' | 'undefined';
  by: string;
}

/** Each anchor after its parent. */
export function anchorTree(
  store: RunStore,
  words: Dictionary,
  rows: readonly AnchorRow[],
  plan: readonly TimepointRow[],
  predictedAnchors: Anchors,
  cutoff: number,
  changes: readonly Change[],
): AnchorLine[] {
  const found = anchorsFound(store, plan, cutoff);
  const now = anchorsNow(store, plan, predictedAnchors, cutoff, changes);
  const lines: AnchorLine[] = [];
  const add = (row: AnchorRow, depth: number): void => {
    const change = changes.findLast((each) => each.anchor?.name === row.name)?.anchor;
    const planned = plan.find(
      (point) => point.anchor === row.name && point.plannedES !== undefined && point.desiredOffsetS !== undefined,
    );
    const parent = lines.find((line) => line.name === row.parent);
    const reports = words.pick([`${row.name}${LAYOUT.anchorReports}`]);
    const reported = reports && store.latest(reports.id, cutoff)?.value;
    const known = ((): Pick<AnchorLine, 'e_s' | 'state' | 'by'> => {
      if (row.parent === '') return { e_s: undefined, state: 'defined', by: 'zero of the clock on board' };
      if (reports && reported !== undefined && Number.isFinite(reported))
        return { e_s: reported - store.entrySclk, state: 'defined', by: `the vehicle, ${reports.name}` };
      const told = found.get(row.name);
      if (told) return { e_s: told.e_s, state: 'defined', by: `${inWords(told.name)} fired, ${told.how}` };
      if (change) return { e_s: now.get(row.name), state: 'defined', by: 'a command, carried out' };
      if (row.offsetS !== undefined && parent?.e_s !== undefined)
        return { e_s: parent.e_s + row.offsetS, state: parent.state, by: `offset from ${inWords(parent.name)}` };
      if (planned)
        return {
          e_s: (planned.plannedES as number) - (planned.desiredOffsetS as number),
          state: 'predicted',
          by: 'ground’s plan',
        };
      const e_s = now.get(row.name);
      return e_s === undefined
        ? { e_s, state: 'undefined', by: 'nothing yet' }
        : { e_s, state: 'predicted', by: 'prediction' };
    })();
    lines.push({
      id: row.id,
      name: row.name,
      depth,
      parent: row.parent,
      offset_s: change ? change.by_s + (change.after === '' ? store.entrySclk : 0) : row.offsetS,
      ...known,
    });
    if (depth < rows.length) for (const child of rows) if (child.parent === row.name) add(child, depth + 1);
  };
  for (const row of rows) if (row.parent === '') add(row, 0);
  return lines;
}
