import { SHORTCUTS, helpShown } from './model';
import './style.css';

/** In a corner and not over the display: the landing goes on. */
export function Help() {
  if (!helpShown.value) return null;
  return (
    <aside class="help" data-testid="help" aria-label="keys">
      <h2>Keys</h2>
      <dl>
        {SHORTCUTS.map((each) => (
          <div key={each.shown}><dt><kbd>{each.shown}</kbd></dt><dd>{each.words}</dd></div>
        ))}
      </dl>
    </aside>
  );
}
