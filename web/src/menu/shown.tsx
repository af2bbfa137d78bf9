// SPDX-License-Identifier: Apache-2.0
// The button that follows the mouse from value to value, and the open menu, whose script is loaded with the first one.
import { signal } from '@preact/signals';
import type { FunctionComponent } from 'preact';
import { notify } from '../run/shown';
import { closeMenu, openOn, openedMenu, pointed } from './model';
import './style.css';

const loaded = signal<{ View: FunctionComponent } | undefined>(undefined);
let begun = false;

function load(): void {
  if (begun) return;
  begun = true;
  import('./view').then(
    ({ MenuView }) => (loaded.value = { View: MenuView }),
    () => {
      begun = false;
      closeMenu();
      notify('The menu could not be loaded: not connected. Open it again later.');
    },
  );
}

export function Menu() {
  const [at, menu] = [pointed.value, openedMenu.value];
  if (menu) load();
  return (
    <>
      {at && !menu && (
        <button
          type="button"
          class="menu-button"
          style={{ left: `${at.x}px`, top: `${at.y}px` }}
          aria-label={`menu of ${at.on.dataset.menu?.split(' ').slice(1).join(' ')}`}
          tabIndex={-1}
          data-testid="menu-button"
          onClick={(event) => openOn(at.on, { x: event.clientX, y: event.clientY })}
        >
          ⋮
        </button>
      )}
      {menu && loaded.value && <loaded.value.View key={`${menu.kind} ${menu.name}`} />}
    </>
  );
}
