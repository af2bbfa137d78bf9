// SPDX-License-Identifier: Apache-2.0
// The frame of every panel: its title, its mode, which no panel can omit, and the content at its right.
import type { ComponentChildren } from 'preact';
import { ModeMark } from '../mode/view';

interface Properties {
  name: string;
  title: ComponentChildren;
  extra?: ComponentChildren;
  /** What the menu of its head is about; left out: the panel. */
  head?: string;
  children: ComponentChildren;
}

export function Panel({ name, title, extra, head, children }: Properties) {
  return (
    <section
      class={`panel panel-${name}`}
      data-testid={`panel-${name}`}
      data-panel={name.startsWith('plot-') ? 'plots' : name}
      aria-label={name}
    >
      <header class="panel-head" data-menu={head ?? `panel ${name}`}>
        <h2>{title}</h2>
        <div class="panel-extra">{extra}</div>
        <ModeMark />
      </header>
      <div class="panel-body">{children}</div>
    </section>
  );
}
