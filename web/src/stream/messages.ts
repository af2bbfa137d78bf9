// SPDX-License-Identifier: Apache-2.0
// Messages between the page and its worker, as plain data. Sequence and run numbers are JavaScript numbers, exact up to
// 2^53.
import type { JsonValue } from '@bufbuild/protobuf';
import type { Clocks, Explanation, Staleness, Packet } from '../gen/aeolis/v1/items_pb';
import type { CommandReply } from '../gen/aeolis/v1/run_pb';
import type { Board } from '../positions/model';
import type {
  NamedAlarm,
  NamedEvent,
  NamedFiring,
  NamedLink,
  NamedRun,
  NamedSituation,
  NamedStage,
  NamedTone,
} from './names';

/** Samples of one channel as two columns. A value that is undefined on board is NaN. */
export interface Column {
  id: number;
  sclk: Float64Array;
  value: Float64Array;
  recorded: boolean;
  /** Of a channel whose values a number does not hold, one a sample: its exact value; undefined on board: undefined. */
  texts?: (string | undefined)[];
  /** The sample received last, if the column knows it. */
  newest?: Newest;
}

/** A sample with its time of reception, seconds since 1970. */
export interface Newest {
  sclk: number;
  value: number;
  text: string | undefined;
  ert_s: number;
  /** Its packet holds no time: `sclk` is when it was received. */
  byReception: boolean;
}

/** A numbered item that is not a sample, flattened. `ert_s`: its ERT, seconds since 1970. */
export type Fact = { seq: number; ert_s: number } & (
  | { kind: 'event'; fact: NamedEvent }
  | { kind: 'tone'; fact: NamedTone }
  | { kind: 'commandStage'; fact: NamedStage }
  | { kind: 'timepoint'; fact: NamedFiring }
  | { kind: 'explanation'; fact: Explanation }
  | { kind: 'link'; fact: NamedLink }
  | { kind: 'staleness'; fact: Staleness }
  | { kind: 'alarm'; fact: NamedAlarm }
  | { kind: 'unit'; fact: Packet }
  | { kind: 'situation'; fact: NamedSituation }
  | { kind: 'procedure'; fact: ProcedureFact }
  | { kind: 'positionAct'; fact: PositionsFact }
);

/** The whole status of a procedure: `status` is a ProcedureStatus as JSON, just as the API has it. */
export interface ProcedureFact {
  number: number;
  status: JsonValue;
}

/** How the room stands behind the newest act: a PositionBoard as JSON, just as the API has it. */
export interface PositionsFact {
  board: Board;
}

export interface BatchOfFacts {
  run: number;
  completeThrough: number;
  facts: Fact[];
  columns: Column[];
  thinned: boolean;
  clocks: Clocks | undefined;
}

/** "catching_up": connected, and missed items are under way. "lost": no connection, trying again. */
export type StreamState = 'connecting' | 'catching_up' | 'live' | 'lost';

export type FromWorker =
  | { type: 'stream'; state: StreamState; attempt: number; gaps: number; serverVersion: string }
  | { type: 'run'; run: NamedRun | undefined; fresh: boolean }
  | { type: 'other_archive' } // which has another run of the shown run's number
  | { type: 'resumed'; run: number; after: number; through: number; attempts: number }
  | { type: 'batch'; batch: BatchOfFacts }
  // names: all requested channels; live: the answer has live samples only
  | { type: 'history'; run: number; names: readonly string[]; columns: Column[]; live: boolean }
  | { type: 'reply'; reply: CommandReply }
  | { type: 'refusal'; reason: string } // by the server, of a message that is not a command; it answers no request
  | { type: 'not_sent'; request: number } // a command that never left the page
  | { type: 'trouble'; words: string } // of the worker itself
  | { type: 'answer'; ask: number; ok: true; value: unknown }
  | { type: 'answer'; ask: number; ok: false; error: string; status: number }; // status 0: no answer arrived

export type ControlAction = { action: 'pause'; pause: boolean } | { action: 'pace'; pace: number } | { action: 'stop' };

export type Question =
  | 'timepoints'
  | 'prediction'
  | 'scenarios'
  | 'series'
  | 'packets'
  | 'recording'
  | 'proof'
  | 'report'
  | 'commands';

/** A command for the uplink, or an action on a waiting one, as in CommandRequest. Missing fields are not sent. */
export interface CommandIntent {
  command?: string;
  arguments?: { name: string; value: number }[];
  armed?: boolean;
  confirmation?: string;
  fromSolution?: boolean;
  dryRun?: boolean;
  service?: string;
  releaseAt?: string;
  hold?: boolean;
  priority?: number;
  action?: QueueAction;
  number?: bigint;
  controller?: string; // name of the person asking
}
export type QueueAction = 'release' | 'hold' | 'cancel' | 'approve';

export type ToWorker =
  | { type: 'open'; run: number; plotted: string[]; others: string[] }
  // other channels are plotted from now on; live: as for refresh_history
  | { type: 'plot'; plotted: string[]; others: string[]; live: boolean }
  | { type: 'watch'; run: number }
  | { type: 'reconnect' } // at once, after a log-in
  // live: only live samples, as densely as if there were no others
  | { type: 'refresh_history'; all: boolean; live: boolean }
  | { type: 'command'; request: number; run: number; intent: CommandIntent }
  | { type: 'control'; run: number; control: ControlAction }
  | { type: 'ask'; ask: number; question: Question; path: string };
