// SPDX-License-Identifier: Apache-2.0
// The library of injects: one is chosen, read, and injected by hand.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { busy, inject } from './instructor';
import { askPlans, library } from './plan_choice';

const chosen = signal('');

export function LibraryForm() {
  useEffect(() => void askPlans(), []);
  if (library.value.length === 0) return null;
  const entry = library.value.find((each) => each.name === chosen.value);
  return (
    <form
      class="table-tools"
      data-testid="library"
      aria-label="library of injects"
      onSubmit={(event) => {
        event.preventDefault();
        if (entry) void inject(entry.fault);
      }}
    >
      <label>
        from the library{' '}
        <select
          value={chosen.value}
          data-testid="library-choice"
          onChange={(event) => (chosen.value = event.currentTarget.value)}
        >
          <option value="">choose</option>
          {library.value.map(({ name, title }) => (
            <option key={name} value={name}>
              {title}
            </option>
          ))}
        </select>
      </label>
      <button type="submit" disabled={!entry || busy.value} data-testid="library-inject">
        inject now
      </button>
      {entry && (
        <div class="library-entry" data-testid="library-entry">
          <p>▲ {entry.does}</p>
          <p>{entry.shows}</p>
          <ul>
            {entry.team.map((each) => (
              <li key={each}>{each}</li>
            ))}
          </ul>
        </div>
      )}
    </form>
  );
}
