// SPDX-License-Identifier: Apache-2.0
// Lists of the server that come in pages.
import { call } from './api';

/** Reads a list whole. @returns its last page, with the rows of all */
export async function readAll<L extends Record<F, unknown[]>, F extends string>(path: string, rows: F): Promise<L> {
  const all: unknown[] = [];
  for (let after = ''; ; ) {
    const page = await call<Partial<L> & { next_after?: string }>('GET', path + after);
    all.push(...(page[rows] ?? []));
    if (!Number(page.next_after ?? 0)) return { ...page, [rows]: all } as L;
    after = `?after=${page.next_after}`;
  }
}
