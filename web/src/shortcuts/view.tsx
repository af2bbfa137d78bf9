// SPDX-License-Identifier: Apache-2.0
import { TABS } from '../places/model';
import { SHORTCUTS, helpShown } from './model';
import './style.css';

const PANELS = [
  'timeline',
  'descent',
  'phases',
  'tones',
  'plots',
  'events',
  'waiting',
  'commands',
  ...TABS.map((tab) => tab.id),
];

/** The help, in a corner and not over important panels, since the landing goes on. */
export function Help() {
  if (!helpShown.value) return null;
  return (
    <aside class="help" data-testid="help" aria-label="keys">
      <h2>
        Keys{' '}
        <button type="button" class="quiet" onClick={() => (helpShown.value = false)}>
          close <kbd>Esc</kbd>
        </button>
      </h2>
      <dl style={{ '--rows': Math.ceil(SHORTCUTS.length / 2) }}>
        {SHORTCUTS.map((each) => (
          <div key={each.shown}>
            <dt>
              <kbd>{each.shown}</kbd>
            </dt>
            <dd>{each.words}</dd>
          </div>
        ))}
      </dl>
      <p>
        For further monitors, a panel alone:{' '}
        {PANELS.map((panel) => (
          <>
            <a key={panel} href={`?panel=${panel}`} target="_blank" rel="noopener">
              {panel}
            </a>{' '}
          </>
        ))}
      </p>
    </aside>
  );
}
