// SPDX-License-Identifier: Apache-2.0
// The frame of every panel: its title, its mode, which no panel can omit, and the content at its right.
import type { ComponentChildren } from 'preact';
import { ModeMark } from '../mode/view';

interface Properties {
  name: string;
  title: ComponentChildren;
  extra?: ComponentChildren;
  children: ComponentChildren;
}

export function Panel({ name, title, extra, children }: Properties) {
  return (
    <section class={`panel panel-${name}`} data-testid={`panel-${name}`} aria-label={name}>
      <header class="panel-head">
        <h2>{title}</h2>
        <div class="panel-extra">{extra}</div>
        <ModeMark />
      </header>
      <div class="panel-body">{children}</div>
    </section>
  );
}
