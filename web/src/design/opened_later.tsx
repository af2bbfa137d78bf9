// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import type { FunctionComponent } from 'preact';

/** A part whose script is loaded when it is first opened, so that the page's first load stays small. */
export function openedLater<Props extends object = object>(
  load: () => Promise<FunctionComponent<Props>>,
): FunctionComponent<Props> {
  const panel = signal<{ Shown: FunctionComponent<Props> } | 'failed'>();
  let begun = false;
  return (props) => {
    if (!begun) {
      begun = true;
      load().then(
        (Shown) => (panel.value = { Shown }),
        () => (panel.value = 'failed'),
      );
    }
    if (panel.value === 'failed') return <p role="alert">This part could not be loaded. Reload the page.</p>;
    return panel.value ? (
      <panel.value.Shown {...props} />
    ) : (
      <p data-loading role="status">
        Loading …
      </p>
    );
  };
}
