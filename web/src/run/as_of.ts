// SPDX-License-Identifier: Apache-2.0
// An answer of the server about the run at the instant shown. It is asked for once, and again at another instant; what
// is of now is renewed by the stream.
import { computed } from '@preact/signals';
import { Refused } from './api';
import { read } from './connection';
import { cutoff, signalOfRun, store } from './shown';

const REPLAY_MS = 1000; // chosen: what people do, and statuses by what is received, change once a second at most

export class AsOf<Answer, Value> {
  /** `at`: the SCLK of the instant asked for; Infinity: now. */
  private readonly known = signalOfRun<{ at: number; value: Value } | undefined>(undefined);
  private asked: { run: object; at: number; ms: number } | undefined;
  private asking = false;

  /** `path` is below that of the run; `none`: the value of a server, or of a run, that lacks it. */
  constructor(
    private readonly path: string,
    private readonly of: (answer: Answer) => Value,
    private readonly none: Value,
  ) {}

  /** Undefined: not known. It is never of after the instant shown. */
  readonly value = computed<Value | undefined>(() => {
    const [known, at] = [this.known.value, cutoff.value];
    if (!known || (at === Infinity ? known.at !== Infinity : known.at > at)) return undefined;
    return known.value;
  });

  async refresh(): Promise<void> {
    const run = store.value;
    if (!run || this.asking) return;
    const now = { run, at: cutoff.value, ms: performance.now() };
    if (this.asked?.run === run) {
      if (this.asked.at === now.at) return;
      // an instant that moves on is followed at a pace; one in another view is asked for at once
      if (this.asked.at < now.at && now.at !== Infinity && now.ms - this.asked.ms < REPLAY_MS) return;
    }
    this.asking = true;
    try {
      const at = now.at === Infinity ? '' : `?at=${now.at}`;
      const answer = await read<Answer>(`/runs/${run.id}/${this.path}${at}`);
      this.asked = now;
      if (store.value === run) this.known.value = { at: now.at, value: this.of(answer) };
    } catch (error) {
      if (error instanceof Refused && [400, 404].includes(error.status)) {
        this.asked = now;
        if (store.value === run) this.known.value = { at: now.at, value: this.none };
      }
    } finally {
      this.asking = false;
    }
  }

  /** Changes what is known of now. */
  renew(change: (value: Value) => Value): void {
    const known = this.known.value;
    if (known?.at === Infinity) this.known.value = { ...known, value: change(known.value) };
  }
}
