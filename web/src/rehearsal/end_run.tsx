// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import { control } from '../run/connection';

const ending = signal(''); // name and run of the button that was pressed once

/** A button that ends the run. It ends the landing for everyone, so it takes two presses. */
export function EndRun({ run, name, words }: { run: number; name: string; words: string }) {
  const mine = `${name} ${run}`;
  const sure = ending.value === mine;
  return (
    <button
      type="button"
      class={sure ? 'danger' : ''}
      data-testid={name}
      onBlur={() => (ending.value = '')}
      onKeyDown={(event) => {
        if (event.key !== 'Escape' || !sure) return;
        ending.value = '';
        event.stopPropagation();
      }}
      onClick={() => {
        if (sure) control({ action: 'stop' }, run);
        ending.value = sure ? '' : mine;
      }}
    >
      {sure ? `▲ press again: run ${run} ends for everyone` : words}
    </button>
  );
}
