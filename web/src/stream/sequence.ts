// SPDX-License-Identifier: Apache-2.0
// Checks that nothing is missing: each batch must continue at the end of the complete part.

export type Verdict = 'continues' | 'repeats' | 'gap';

export class SequenceCheck {
  gaps = 0;
  constructor(public completeThrough = 0) {}

  /**
   * Judges a batch. `afterSeq` is the number from which it continues by the server's word; 0 if the server does not
   * say. 'repeats': all of it is known already. 'gap': items are missing; subscribe again from `completeThrough`.
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
