// SPDX-License-Identifier: Apache-2.0
// One channel's samples in order of SCLK, bounded; those of one instant in the order of reception. Live samples are
// appended; history from the archive replaces the samples in its range. An equal sample of the same instant is taken for
// the same one, which history and stream both brought. When full, the older half is thinned to the least and the
// largest of every four.

const LIMIT = 1 << 16; // points: at most 1 MB a channel
const SAME_INSTANT = 64; // chosen: samples of one instant among which a repeated one is looked for
export const LIMIT_NOT_DRAWN = 1 << 11; // for a channel shown only as a number; a past view asks for its former value

export class Series {
  sclk = new Float64Array(64);
  value = new Float64Array(64);
  length = 0;
  /** Counts changes, so that a drawing knows whether it is current. */
  version = 0;

  constructor(private limit = LIMIT) {}

  /** From now on it is drawn, and holds as much as any that is. */
  widen(): void {
    this.limit = LIMIT;
  }

  append(sclk: Float64Array, value: Float64Array): void {
    ++this.version;
    for (let i = 0; i < sclk.length; ++i) {
      const at = sclk[i] as number;
      const last = this.length > 0 ? (this.sclk[this.length - 1] as number) : -Infinity;
      if (at > last) this.push(at, value[i] as number);
      else this.insert(at, value[i] as number);
    }
  }

  /** Inserts history. Of the held samples only those newer than its last sample, or not newer than `through`, stay. */
  replaceBefore(sclk: Float64Array, value: Float64Array, through = -Infinity): void {
    const first = sclk.findIndex((at) => at > through);
    if (first < 0) return;
    const endsAt = this.firstAfter(sclk[sclk.length - 1] as number);
    this.exchange(this.firstAfter(through), endsAt, sclk.subarray(first), value.subarray(first));
  }

  /** Replaces all samples within [from, to] by these. */
  replace(from: number, to: number, sclk: Float64Array, value: Float64Array): void {
    this.exchange(this.firstNotBefore(from), this.firstAfter(to), sclk, value);
  }

  private exchange(startsAt: number, endsAt: number, sclk: Float64Array, value: Float64Array): void {
    ++this.version;
    const tailSclk = this.sclk.slice(endsAt, this.length);
    const tailValue = this.value.slice(endsAt, this.length);
    this.length = startsAt;
    for (let i = 0; i < sclk.length; ++i) this.push(sclk[i] as number, value[i] as number);
    for (let i = 0; i < tailSclk.length; ++i) this.push(tailSclk[i] as number, tailValue[i] as number);
  }

  private firstNotBefore(sclk: number): number {
    let index = this.firstAfter(sclk);
    while (index > 0 && this.sclk[index - 1] === sclk) --index;
    return index;
  }

  /** Index of the first sample later than `sclk`. */
  firstAfter(sclk: number): number {
    let low = 0;
    let high = this.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((this.sclk[middle] as number) <= sclk) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  get newestSclk(): number {
    return this.length > 0 ? (this.sclk[this.length - 1] as number) : -Infinity;
  }

  /** The newest sample at or before `sclk`. */
  at(sclk: number): { sclk: number; value: number } | undefined {
    const index = this.firstAfter(sclk) - 1;
    return index < 0 ? undefined : { sclk: this.sclk[index] as number, value: this.value[index] as number };
  }

  /**
   * A copy without the samples of these instants. It has the same version, since it is drawn in place of the original.
   */
  without(instants: ReadonlySet<number>): Series {
    const copy = new Series(this.limit);
    copy.version = this.version;
    for (let i = 0; i < this.length; ++i) {
      if (!instants.has(this.sclk[i] as number)) copy.push(this.sclk[i] as number, this.value[i] as number);
    }
    return copy;
  }

  private push(sclk: number, value: number): void {
    if (this.length === this.sclk.length) this.grow();
    this.sclk[this.length] = sclk;
    this.value[this.length] = value;
    ++this.length;
  }

  private insert(sclk: number, value: number): void {
    const index = this.firstAfter(sclk);
    for (let i = index - 1; i >= 0 && i >= index - SAME_INSTANT && this.sclk[i] === sclk; --i)
      if (Object.is(this.value[i], value)) return; // a repeated sample
    if (this.length === this.sclk.length) {
      this.grow();
      this.insert(sclk, value); // its place may have moved
      return;
    }
    this.sclk.copyWithin(index + 1, index, this.length);
    this.value.copyWithin(index + 1, index, this.length);
    this.sclk[index] = sclk;
    this.value[index] = value;
    ++this.length;
  }

  private grow(): void {
    if (this.length >= this.limit) {
      this.thinOlderHalf();
      return;
    }
    const sclk = new Float64Array(this.length * 2);
    const value = new Float64Array(this.length * 2);
    sclk.set(this.sclk);
    value.set(this.value);
    this.sclk = sclk;
    this.value = value;
  }

  private thinOlderHalf(): void {
    const half = this.length >> 1;
    let to = 0;
    for (let from = 0; from + 4 <= half; from += 4) {
      let least = from;
      let largest = from;
      for (let i = from + 1; i < from + 4; ++i) {
        const value = this.value[i] as number;
        if (value < (this.value[least] as number) || Number.isNaN(this.value[least])) least = i;
        if (value > (this.value[largest] as number) || Number.isNaN(this.value[largest])) largest = i;
      }
      for (const i of least < largest ? [least, largest] : least > largest ? [largest, least] : [least]) {
        this.sclk[to] = this.sclk[i] as number;
        this.value[to] = this.value[i] as number;
        ++to;
      }
    }
    this.sclk.copyWithin(to, half, this.length);
    this.value.copyWithin(to, half, this.length);
    this.length -= half - to;
  }
}
