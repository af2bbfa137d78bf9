// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import type { FunctionComponent } from 'preact';

/** A panel whose script is loaded when it is first opened, so that the page's first load stays small. */
export function openedLater(load: () => Promise<FunctionComponent>): FunctionComponent {
  const panel = signal<{ Shown: FunctionComponent } | 'failed'>();
  let begun = false;
  return () => {
    if (!begun) {
      begun = true;
      load().then(
        (Shown) => (panel.value = { Shown }),
        () => (panel.value = 'failed'),
      );
    }
    if (panel.value === 'failed') return <p role="alert">This panel could not be loaded. Reload the page.</p>;
    return panel.value ? <panel.value.Shown /> : <p data-loading>Loading …</p>;
  };
}
