// The frame of every panel: its title, what stands at its right, and the mark of a past view, which no panel can omit.
import type { ComponentChildren } from 'preact';
import { modeNow } from './run/session';

interface Properties {
  name: string;
  title: ComponentChildren;
  extra?: ComponentChildren;
  children: ComponentChildren;
}

export function Panel({ name, title, extra, children }: Properties) {
  const mode = modeNow();
  return (
    <section class={`panel panel-${name}`} data-testid={`panel-${name}`} aria-label={name}>
      <header class="panel-head">
        <h2>{title}</h2>
        {mode === 'past' && <span class="past-mark">past</span>}
        <div class="panel-extra">{extra}</div>
      </header>
      <div class="panel-body">{children}</div>
    </section>
  );
}
