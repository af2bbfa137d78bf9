// SPDX-License-Identifier: Apache-2.0
// The next act of a rehearsal: it is flown to a time as fast as possible, and held there.
import { signal } from '@preact/signals';
import { change } from '../run/connection';
import { runNow } from '../run/shown';
import { fromEntry, readFromEntry } from '../run/time';

const to = signal('');
const problem = signal('');
const busy = signal(false);
const sure = signal(false); // that it flies past the landing

/** The server's notation of a time from entry. */
const asTold = (e_s: number): string => `E${e_s < 0 ? '-' : '+'}${Math.abs(e_s)}`;

/** What is wrong with the time; empty: nothing. Without the vehicle's clock the server says whether it has passed. */
export function badJump(text: string, now_e_s: number | undefined): string {
  const e_s = readFromEntry(text);
  if (e_s === undefined) return 'a time from entry, such as E-0:47:00';
  return now_e_s === undefined || e_s > now_e_s ? '' : `${fromEntry(e_s)} has passed at the vehicle`;
}

async function jump(run: number): Promise<void> {
  busy.value = true;
  problem.value = '';
  try {
    await change('/rehearsals/current', { run, jump: asTold(readFromEntry(to.value) ?? NaN) });
    to.value = '';
    sure.value = false;
  } catch (error) {
    problem.value = error instanceof Error ? error.message : String(error);
  } finally {
    busy.value = false;
  }
}

export function JumpForm() {
  const run = runNow();
  if (!run?.going) return null;
  const now_e_s = run.clocks?.eS;
  const bad = to.value === '' ? '' : badJump(to.value, now_e_s);
  const flies_past = bad === '' && (now_e_s ?? 0) < 0 && (readFromEntry(to.value) ?? -1) > 0;
  return (
    <form
      class="table-tools"
      onSubmit={(event) => {
        event.preventDefault();
        if (to.value === '' || bad !== '' || busy.value) return;
        if (flies_past && !sure.value) sure.value = true;
        else void jump(run.id);
      }}
    >
      <label title="flown as fast as possible, and held there; nobody can command meanwhile">
        next act at{' '}
        <input
          class="seed jump-to"
          data-testid="jump-to"
          placeholder="E-0:47:00"
          value={to.value}
          aria-invalid={bad !== ''}
          onInput={(event) => {
            to.value = event.currentTarget.value;
            problem.value = '';
            sure.value = false;
          }}
        />
      </label>
      <button type="submit" disabled={to.value === '' || bad !== '' || busy.value} data-testid="jump">
        {sure.value ? '▲ press again: it flies past entry' : 'jump there'}
      </button>
      <span role="status" class={problem.value ? 'status-alarm' : 'status-dim'} data-testid="jump-words">
        {problem.value ? `✖ ${problem.value}` : bad ? `✖ ${bad}` : ''}
      </span>
    </form>
  );
}
