// SPDX-License-Identifier: Apache-2.0
// Converts the stream's batches to columns: one series of samples per channel, and facts in order of sequence number.
import type { Batch } from '../gen/aeolis/v1/stream_pb';
import { secondsOfErt } from '../run/time';
import type { BatchOfFacts, Column, Fact } from './messages';
import { named } from './names';

export const SOURCE_RECORDED = 2; // Source.RECORDED, so that the page need not load the schema

class GrowingColumn {
  sclk: number[] = [];
  value: number[] = [];
}

/** Collects batches until they are taken, so that the page gets one message for many. */
export class ColumnCollector {
  private columns = new Map<string, GrowingColumn>();
  private facts: Fact[] = [];
  private thinned = false;
  private clocks: BatchOfFacts['clocks'];
  private completeThrough = 0;
  private run = 0;
  private any = false;

  /**
   * `packetOf[id]`: the channels of the same packet. A channel missing from a sample of its packet is undefined on
   * board.
   */
  constructor(private readonly packetOf: ReadonlyMap<number, readonly number[]> = new Map()) {}

  get empty(): boolean {
    return !this.any;
  }

  add(batch: Batch): void {
    this.any = true;
    this.run = Number(batch.run);
    this.completeThrough = Math.max(this.completeThrough, Number(batch.completeThrough));
    if (batch.clocks) this.clocks = batch.clocks;
    for (const item of batch.items) {
      const seq = Number(item.seq);
      const { case: kind, value } = item.item;
      if (kind === undefined) continue;
      if (kind === 'samples') {
        this.thinned ||= value.thinned;
        this.addSamples(value.sclk, value.ids, value.values, value.source === SOURCE_RECORDED);
      } else {
        this.facts.push({ kind, seq, ert_s: secondsOfErt(item.ertUs), fact: named(item.item) } as Fact);
      }
    }
  }

  take(): BatchOfFacts {
    const columns: Column[] = [];
    for (const [key, column] of this.columns) {
      columns.push({
        id: Number(key.slice(1)),
        recorded: key[0] === 'r',
        sclk: Float64Array.from(column.sclk),
        value: Float64Array.from(column.value),
      });
    }
    const taken: BatchOfFacts = {
      run: this.run,
      completeThrough: this.completeThrough,
      facts: this.facts,
      columns,
      thinned: this.thinned,
      clocks: this.clocks,
    };
    this.columns = new Map();
    this.facts = [];
    this.thinned = false;
    this.clocks = undefined;
    this.any = false;
    return taken;
  }

  private addSamples(sclk: number, ids: readonly number[], values: readonly number[], recorded: boolean): void {
    const prefix = recorded ? 'r' : 'l';
    for (let i = 0; i < ids.length; ++i) this.push(prefix + ids[i], sclk, values[i] ?? NaN);
    const first = ids[0];
    const packet = first === undefined ? undefined : this.packetOf.get(first);
    if (packet && packet.length > ids.length) {
      const present = new Set(ids);
      for (const id of packet) if (!present.has(id)) this.push(prefix + id, sclk, NaN);
    }
  }

  private push(key: string, sclk: number, value: number): void {
    let column = this.columns.get(key);
    if (!column) {
      column = new GrowingColumn();
      this.columns.set(key, column);
    }
    column.sclk.push(sclk);
    column.value.push(value);
  }
}
