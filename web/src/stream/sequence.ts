// SPDX-License-Identifier: Apache-2.0
// Proves that nothing is missing: each batch must continue what was complete before it.

export type Verdict = 'continues' | 'repeats' | 'gap';

export class SequenceCheck {
  gaps = 0;
  constructor(public completeThrough = 0) {}

  /**
   * `afterSeq` is what the server says the batch continues from; 0 when it does not say.
   * 'repeats': all of it was here before. 'gap': something is missing; ask again from `completeThrough`.
   */
  judge(afterSeq: number, completeThrough: number, firstSeq: number | undefined): Verdict {
    if (afterSeq > this.completeThrough) {
      ++this.gaps;
      return 'gap';
    }
    const repeats =
      firstSeq !== undefined && firstSeq <= this.completeThrough && completeThrough <= this.completeThrough;
    this.completeThrough = Math.max(this.completeThrough, completeThrough);
    return repeats ? 'repeats' : 'continues';
  }
}

/** Seconds to wait before the n-th attempt to connect: 0.25, 0.5, 1, 2, 4, then 5. */
export function backoffSeconds(attempt: number): number {
  return Math.min(5, 0.25 * 2 ** Math.min(attempt, 10));
}
