// SPDX-License-Identifier: Apache-2.0
/**
 * Lets one action pass every `every_ms` on average. After a late one the next may follow sooner, after `least_ms` at
 * least.
 */
export class Pace {
  private next = -Infinity;

  constructor(
    private readonly every_ms: number,
    private readonly least_ms: number,
  ) {}

  /** The remaining wait; 0: none. */
  wait(now_ms: number): number {
    return Math.max(0, this.next - now_ms);
  }

  took(now_ms: number): void {
    this.next = Math.max(this.next + this.every_ms, now_ms + this.least_ms);
  }
}
