// SPDX-License-Identifier: Apache-2.0
// The next act of a rehearsal: it is flown to a time as fast as possible, and held there.
import { signal } from '@preact/signals';
import { change } from '../run/connection';
import { runNow } from '../run/shown';
import { fromEntry, readFromEntry } from '../run/time';

const to = signal('');
const problem = signal('');
const busy = signal(false);

/** The server's notation of a time from entry. */
const asTold = (e_s: number): string => `E${e_s < 0 ? '-' : '+'}${Math.abs(e_s)}`;

/** What is wrong with the time; empty: nothing. */
export function badJump(text: string, now_e_s: number): string {
  const e_s = readFromEntry(text);
  if (e_s === undefined) return 'a time from entry, such as E-0:47:00';
  return e_s > now_e_s ? '' : `${fromEntry(e_s)} has passed at the vehicle`;
}

async function jump(run: number): Promise<void> {
  busy.value = true;
  problem.value = '';
  try {
    await change('/rehearsals/current', { run, jump: asTold(readFromEntry(to.value) ?? NaN) });
    to.value = '';
  } catch (error) {
    problem.value = error instanceof Error ? error.message : String(error);
  } finally {
    busy.value = false;
  }
}

export function JumpForm() {
  const run = runNow();
  if (!run?.going) return null;
  const bad = to.value === '' ? '' : badJump(to.value, (run.clocks?.eS ?? run.seenE) || 0);
  return (
    <form
      class="table-tools"
      onSubmit={(event) => {
        event.preventDefault();
        if (to.value !== '' && bad === '' && !busy.value) void jump(run.id);
      }}
    >
      <label title="flown as fast as possible, and held there; nobody can command meanwhile">
        next act at{' '}
        <input
          class="seed"
          data-testid="jump-to"
          placeholder="E-0:47:00"
          value={to.value}
          aria-invalid={bad !== ''}
          onInput={(event) => {
            to.value = event.currentTarget.value;
            problem.value = '';
          }}
        />
      </label>
      <button type="submit" disabled={to.value === '' || bad !== '' || busy.value} data-testid="jump">
        jump there
      </button>
      <span role="status" class={problem.value ? 'status-alarm' : 'status-dim'} data-testid="jump-words">
        {problem.value ? `✖ ${problem.value}` : bad ? `✖ ${bad}` : ''}
      </span>
    </form>
  );
}
