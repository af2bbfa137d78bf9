// SPDX-License-Identifier: Apache-2.0
// What the page and its worker tell each other. Everything here is plain data that can be posted.
// Sequence and run numbers are JavaScript numbers: exact up to 2^53.
import type { Clocks, Explanation, LinkChange, TimepointFiring, Unit } from '../gen/aeolis/v1/items_pb';
import type { CommandReply, RunState } from '../gen/aeolis/v1/run_pb';
import type { NamedAlarm, NamedEvent, NamedStage, NamedTone } from './names';

/** Samples of one channel, side by side. A value that is undefined on board is NaN. */
export interface Column {
  id: number;
  sclk: Float64Array;
  value: Float64Array;
  recorded: boolean;
}

/** A numbered item that is not a sample, flattened. `ert_s`: its ERT, seconds since 1970. */
export type Fact = { seq: number; ert_s: number } & (
  | { kind: 'event'; fact: NamedEvent }
  | { kind: 'tone'; fact: NamedTone }
  | { kind: 'commandStage'; fact: NamedStage }
  | { kind: 'timepoint'; fact: TimepointFiring }
  | { kind: 'explanation'; fact: Explanation }
  | { kind: 'link'; fact: LinkChange }
  | { kind: 'alarm'; fact: NamedAlarm }
  | { kind: 'unit'; fact: Unit }
);

export interface BatchOfFacts {
  run: number;
  completeThrough: number;
  facts: Fact[];
  columns: Column[];
  thinned: boolean;
  clocks: Clocks | undefined;
}

/** "catching_up": connected, what was missed is on its way. "lost": no connection, trying again. */
export type StreamState = 'connecting' | 'catching_up' | 'live' | 'lost';

export type FromWorker =
  | { type: 'stream'; state: StreamState; attempt: number; gaps: number; serverVersion: string }
  | { type: 'run'; run: RunState | undefined; fresh: boolean }
  | { type: 'other_archive' } // and there another run of the number that is shown
  | { type: 'resumed'; run: number; after: number; through: number; attempts: number }
  | { type: 'batch'; batch: BatchOfFacts }
  | { type: 'history'; run: number; names: readonly string[]; columns: Column[]; live: boolean } // names: all that were asked for; live: samples that came so, and no other
  | { type: 'reply'; reply: CommandReply }
  | { type: 'refusal'; reason: string } // by the server, of something that is no command: it is nobody's answer
  | { type: 'not_sent'; request: number } // a command that never left the page
  | { type: 'trouble'; words: string } // the worker's own
  | { type: 'answer'; ask: number; ok: true; value: unknown }
  | { type: 'answer'; ask: number; ok: false; error: string; status: number }; // 0: no answer came

export type ControlAction = { action: 'pause'; pause: boolean } | { action: 'pace'; pace: number } | { action: 'stop' };

export type Question =
  | 'timepoints'
  | 'scenarios'
  | 'series'
  | 'packets'
  | 'recording'
  | 'proof'
  | 'report'
  | 'commands';

/** What a controller wants of the uplink, as CommandRequest has it: a command, or an action on one that waits. What is left out is not asked. */
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
  controller?: string; // who asks
}
export type QueueAction = 'release' | 'hold' | 'cancel' | 'approve';

export type ToWorker =
  | { type: 'open'; run: number; packets: Record<number, number[]>; plotted: string[]; others: string[] }
  | { type: 'watch'; run: number }
  | { type: 'reconnect' } // at once: whoever was turned away has logged in
  | { type: 'refresh_history'; all: boolean; live: boolean } // live: only what came so, as fine as if nothing else had come
  | { type: 'command'; request: number; run: number; intent: CommandIntent }
  | { type: 'control'; run: number; control: ControlAction }
  | { type: 'ask'; ask: number; question: Question; path: string };
