// SPDX-License-Identifier: Apache-2.0
// Converts the stream's batches to columns: one series of samples per channel, facts in order of sequence number, and
// after them the newest status of each procedure and the room behind the newest act on a position.
import { toJson } from '@bufbuild/protobuf';
import type { Samples } from '../gen/aeolis/v1/items_pb';
import type { PositionAct } from '../gen/aeolis/v1/positions_pb';
import type { ProcedureStatus } from '../gen/aeolis/v1/procedures_pb';
import type { Batch } from '../gen/aeolis/v1/stream_pb';
import { PositionBoardSchema } from '../gen/worker/aeolis/v1/positions_pb';
import { ProcedureStatusSchema } from '../gen/worker/aeolis/v1/procedures_pb';
import type { Board } from '../positions/model';
import { secondsOfErt } from '../run/time';
import type { BatchOfFacts, Column, Fact, Newest } from './messages';
import { named } from './names';

/** As the API has it. */
const AS_JSON = { useProtoFieldName: true, alwaysEmitImplicit: true };

export const SOURCE_RECORDED = 2; // Source.RECORDED, so that the page need not load the schema

class GrowingColumn {
  sclk: number[] = [];
  value: number[] = [];
  texts: (string | undefined)[] | undefined;
  newest: Newest | undefined;
}

/** Collects batches until they are taken, so that the page gets one message for many. */
export class ColumnCollector {
  private columns = new Map<string, GrowingColumn>();
  private facts: Fact[] = [];
  /** The newest status of each procedure: each is whole, and a long run has thousands. */
  private procedures = new Map<number, { seq: number; ert_s: number; status: ProcedureStatus }>();
  /** The newest act on a position: the whole room stands behind it. */
  private positions: { seq: number; ert_s: number; act: PositionAct } | undefined;
  private thinned = false;
  private clocks: BatchOfFacts['clocks'];
  private completeThrough = 0;
  private run = 0;
  private any = false;

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
        this.addSamples(value, secondsOfErt(item.ertUs));
      } else if (kind === 'procedure') {
        this.procedures.set(value.number, { seq, ert_s: secondsOfErt(item.ertUs), status: value });
      } else if (kind === 'positionAct') {
        this.positions = { seq, ert_s: secondsOfErt(item.ertUs), act: value };
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
        ...(column.texts && { texts: column.texts }),
        ...(column.newest && { newest: column.newest }),
      });
    }
    const taken: BatchOfFacts = {
      run: this.run,
      completeThrough: this.completeThrough,
      facts: [...this.facts, ...this.statuses(), ...this.room()],
      columns,
      thinned: this.thinned,
      clocks: this.clocks,
    };
    this.columns = new Map();
    this.facts = [];
    this.procedures = new Map();
    this.positions = undefined;
    this.thinned = false;
    this.clocks = undefined;
    this.any = false;
    return taken;
  }

  private statuses(): Fact[] {
    return [...this.procedures].map(([number, { seq, ert_s, status }]) => {
      const json = toJson(ProcedureStatusSchema, status, AS_JSON);
      return { kind: 'procedure', seq, ert_s, fact: { number, status: json } };
    });
  }

  private room(): Fact[] {
    const { seq = 0, ert_s = 0, act } = this.positions ?? {};
    if (!act?.board) return [];
    const board = toJson(PositionBoardSchema, act.board, AS_JSON) as unknown as Board;
    return [{ kind: 'positionAct', seq, ert_s, fact: { board } }];
  }

  private addSamples({ sclk, ids, values, source, exact, sclkByReception }: Samples, ert_s: number): void {
    const recorded = source === SOURCE_RECORDED;
    const texts = exact.length > 0 ? new Map(exact.map(({ id, text }) => [id, text])) : undefined;
    for (let i = 0; i < ids.length; ++i) {
      const id = ids[i] as number;
      const column = this.column((recorded ? 'r' : 'l') + id);
      const value = values[i] ?? NaN;
      const text = texts?.get(id);
      column.sclk.push(sclk);
      column.value.push(value);
      if (text !== undefined || column.texts) {
        column.texts ??= column.value.slice(1).map(() => undefined);
        column.texts.push(text);
      }
      if (!recorded) column.newest = { sclk, value, text, ert_s, byReception: sclkByReception };
    }
  }

  private column(key: string): GrowingColumn {
    let column = this.columns.get(key);
    if (!column) {
      column = new GrowingColumn();
      this.columns.set(key, column);
    }
    return column;
  }
}
