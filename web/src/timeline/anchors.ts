// SPDX-License-Identifier: Apache-2.0
// The anchors of the timeline as a tree: parent, offset, time and evidence of each.
import { SOURCES } from '../design/status';
import type { AnchorRow, TimepointRow } from '../gen/aeolis/v1/run_pb';
import { inWords } from '../run/dictionary';

export interface AnchorLine {
  id: number;
  name: string;
  /** 0: the root. */
  depth: number;
  parent: string;
  /** From the parent: by a command, else by the plan. */
  offset_s: number | undefined;
  /** From entry; undefined for the root and for unknown anchors. */
  e_s: number | undefined;
  state: 'defined' | 'predicted' | 'undefined';
  by: string;
}

const STATES = ['defined', 'predicted', 'undefined'] as const;

function basisWords(row: AnchorRow, plan: readonly TimepointRow[]): string {
  switch (row.basis) {
    case 'clock':
      return 'zero of the clock on board';
    case 'report':
      return 'the vehicle’s own report';
    case 'firing': {
      const by = plan.find((point) => point.name === row.fired)?.heardBy;
      const source = by === 'uhf' || by === 'recording' || by === 'tone' ? `, ${SOURCES[by].word}` : '';
      return `${inWords(row.fired)} fired${source}`;
    }
    case 'command':
      return 'a command, carried out';
    case 'parent':
      return `offset from ${inWords(row.parent)}`;
    case 'plan':
      return 'ground’s plan';
    case 'design':
      return 'prediction';
    case 'overdue':
      return 'prediction; it is overdue';
    default:
      return 'nothing yet';
  }
}

/** Each anchor after its parent. */
export function anchorTree(rows: readonly AnchorRow[], plan: readonly TimepointRow[]): AnchorLine[] {
  const lines: AnchorLine[] = [];
  const add = (row: AnchorRow, depth: number): void => {
    lines.push({
      id: row.id,
      name: row.name,
      depth,
      parent: row.parent,
      offset_s: row.currentOffsetS,
      e_s: row.eS,
      state: STATES.find((state) => state === row.state) ?? 'undefined',
      by: basisWords(row, plan),
    });
    if (depth < rows.length) for (const child of rows) if (child.parent === row.name) add(child, depth + 1);
  };
  for (const row of rows) if (row.parent === '') add(row, 0);
  return lines;
}
