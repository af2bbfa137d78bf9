// SPDX-License-Identifier: Apache-2.0
// Layouts: what the grid's places show, kept by the server under a name. A person's own, or everyone's without accounts.
import { signal } from '@preact/signals';
import { showView, viewNow } from '../places/model';
import { call, wordsFor } from '../run/api';
import { pictureOf, queryOf } from '../run/address';
import { readAll } from '../run/pages';
import { notify } from '../run/shown';

export interface Layout {
  name: string;
  view?: string;
  saved: string;
}

export const layouts = signal<Layout[] | undefined>(undefined);
export const most = signal(0);
export const problem = signal('');
export const busy = signal(false);

export async function loadLayouts(): Promise<void> {
  try {
    const list = await readAll<{ layouts: Layout[]; layouts_max: number }, 'layouts'>('/layouts', 'layouts');
    list.layouts.sort((a, b) => (a.name < b.name ? -1 : 1));
    [layouts.value, most.value, problem.value] = [list.layouts, list.layouts_max, ''];
  } catch (error) {
    problem.value = `the layouts are not known: ${wordsFor(error)}`;
  }
}

const pathOf = (name: string) => `/layouts/${encodeURIComponent(name)}`;

/** The first problem stays in sight. @returns whether it is done */
async function changed(what: string, change: () => Promise<unknown>): Promise<boolean> {
  if (busy.value) return false;
  busy.value = true;
  problem.value = '';
  try {
    await change();
    await loadLayouts();
    return true;
  } catch (error) {
    problem.value = `${what}: ${wordsFor(error)}`;
    return false;
  } finally {
    busy.value = false;
  }
}

export const saveLayout = (name: string): Promise<boolean> =>
  changed(`${name} was not saved`, () => call('PUT', pathOf(name.trim()), { view: queryOf(viewNow()) }));

export const removeLayout = (name: string): Promise<boolean> =>
  changed(`${name} was not removed`, () => call('DELETE', pathOf(name)));

/** Shows a layout, or with none what the console comes with. */
export function showLayout(layout?: Layout): void {
  const { picture, problems } = pictureOf(layout?.view ?? '');
  for (const words of [...problems, ...showView(picture)]) notify(layout ? `${layout.name}: ${words}` : words);
}

/** Whether what is shown is this layout; undefined: what the console comes with. */
export const isShown = (layout?: Layout): boolean => queryOf(viewNow()) === (layout?.view ?? '');
