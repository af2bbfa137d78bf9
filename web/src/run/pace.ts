// SPDX-License-Identifier: Apache-2.0
/** Lets something through every `every_ms` on the average: what came late lets the next come sooner, by no less than `least_ms`. */
export class Pace {
  private next = -Infinity;

  constructor(
    private readonly every_ms: number,
    private readonly least_ms: number,
  ) {}

  /** How long it is still to wait; none: 0. */
  wait(now_ms: number): number {
    return Math.max(0, this.next - now_ms);
  }

  took(now_ms: number): void {
    this.next = Math.max(this.next + this.every_ms, now_ms + this.least_ms);
  }
}
