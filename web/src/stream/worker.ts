// SPDX-License-Identifier: Apache-2.0
// Owns the socket: connects, subscribes, resumes after a break, checks the sequence, decodes, and posts columnar
// batches every 25 ms at most on average, those with samples somewhat sooner. It also sends HTTP requests, so that no
// large answer is parsed on the page's thread.
//
// A run is loaded in two steps. The first is everything except samples, from the beginning; that answer is small.
// Then samples are subscribed from there on, and their history before that is fetched, thinned by the server. So there
// is no seam, and no million samples pass through the socket.
import { create, fromBinary, fromJson, toBinary } from '@bufbuild/protobuf';
import type { DescMessage, MessageInitShape } from '@bufbuild/protobuf';
import { PredictionSchema } from '../gen/worker/aeolis/v1/prediction_pb';
import {
  AsFlownReportSchema,
  CommandListSchema,
  PacketListSchema,
  ProofReportSchema,
  RecordingSummarySchema,
  ScenarioListSchema,
  TimepointListSchema,
} from '../gen/worker/aeolis/v1/run_pb';
import { ClientMessageSchema, ServerMessageSchema } from '../gen/worker/aeolis/v1/stream_pb';
import type { Batch, RehearsalControlSchema, ServerMessage } from '../gen/worker/aeolis/v1/stream_pb';
import { Pace } from '../run/pace';
import { isSameRun } from '../run/same';
import { ColumnCollector } from './columns';
import type { Column, ControlAction, FromWorker, Question, StreamState, ToWorker } from './messages';
import { namedRun } from './names';
import type { NamedRun } from './names';
import { SequenceCheck, backoffSeconds } from './sequence';
import { columnsOf, readSeriesList } from './series_answer';

const POST_EVERY_MS = 25;
const POST_SAMPLES_EVERY_MS = 45; // plotted samples do not wait for other items; samples arrive every 50 ms
const PLOTTED_POINTS = 6000; // per plotted channel: a few a pixel, so that one step of zoom still has detail
const OTHER_POINTS = 400; // per other channel: for the table and a first look
const CHANNELS_A_QUESTION = 64; // the server's limit
const SILENT_MS = 5000; // chosen: a running run sends its clocks ten times a second
const LOOKS = 3; // chosen: over a silence of fifteen seconds
const LOOK_EVERY_MS = 1000;
const QUIET_MS = 2000; // chosen: this long without a batch is a silence
const MAX_RATE_HZ = 20; // the rate at which the page draws; history has the rest

const post = (message: FromWorker, columns: Column[] = []) =>
  self.postMessage(message, {
    transfer: columns.flatMap(({ sclk, value }) => [sclk.buffer, value.buffer] as ArrayBuffer[]),
  });

const apiUrl = new URL('/api/v1', self.location.origin).href;
const socketUrl = `${apiUrl.replace(/^http/, 'ws')}/stream`;

let socket: WebSocket | undefined;
let attempt = 0;
let retry: ReturnType<typeof setTimeout> | undefined;
let wantedRun = 0;
let currentRun = 0;
let known: NamedRun | undefined; // the newest reported state of the current run
let serverVersion = '';
let check = new SequenceCheck();
let plotted: string[] = [];
let others: string[] = [];
let leftOut = false;
let quiet: ReturnType<typeof setTimeout> | undefined;
let collector = new ColumnCollector();
let posting: { timer: ReturnType<typeof setTimeout>; at_ms: number } | undefined;
const posts = new Pace(POST_EVERY_MS, 5);
const samplePosts = new Pace(POST_SAMPLES_EVERY_MS, 5);
let state: StreamState = 'connecting';
let step: 'facts' | 'samples' = 'facts';
let historyDue = false;
let stopAt = 0; // the last number when the subscription began; later items are live
// during a break: the number through which items were complete at its start
let lost: { after: number; attempts: number } | undefined;
let lookAt_ms = Infinity; // when to ask whether the server still answers
let looks = 0; // since the last message on the socket
let asks = new AbortController(); // aborts pending requests when the connection has died
// Whether the newest subscription has been answered. Earlier batches belong to the one that it replaces, and lack what
// that one left out.
let welcomed = false;
// Whether to subscribe by the run's number, because the server that came back no longer has it as the current one.
let exact = false;

function say(next: StreamState): void {
  if (next === 'live') flush(); // the page then has all that it is said to have
  state = next;
  if (next === 'live' && lost) {
    post({ type: 'resumed', run: currentRun, ...lost, through: check.completeThrough });
    lost = undefined;
  }
  post({ type: 'stream', state, attempt, gaps: check.gaps, serverVersion });
}

function send(message: MessageInitShape<typeof ClientMessageSchema>['message']): boolean {
  if (!socket || socket.readyState !== WebSocket.OPEN) return false;
  socket.send(toBinary(ClientMessageSchema, create(ClientMessageSchema, { message })) as Uint8Array<ArrayBuffer>);
  return true;
}

function subscribe(): void {
  welcomed = !send({
    case: 'subscribe',
    value: {
      run: BigInt(exact ? currentRun || wantedRun : wantedRun),
      afterSeq: BigInt(check.completeThrough),
      allChannels: step === 'samples',
      maxRateHz: MAX_RATE_HZ,
    },
  });
}

function connect(): void {
  retry = undefined;
  say(attempt === 0 ? 'connecting' : 'lost');
  const mine = new WebSocket(socketUrl, ['aeolis.v1.protobuf']);
  mine.binaryType = 'arraybuffer';
  socket = mine;
  heard();
  mine.onopen = () => {
    attempt = 0;
    say('catching_up');
    subscribe();
  };
  mine.onmessage = (event: MessageEvent<ArrayBuffer>) => {
    if (socket !== mine) return;
    heard();
    receive(new Uint8Array(event.data));
  };
  mine.onclose = () => lose(mine);
}

function lose(its: WebSocket): void {
  if (socket !== its) return;
  socket = undefined;
  ++attempt;
  if (state === 'live') lost = { after: check.completeThrough, attempts: 0 };
  if (lost) lost.attempts = attempt;
  say('lost');
  retry = setTimeout(connect, backoffSeconds(attempt) * 1000);
}

function heard(): void {
  lookAt_ms = performance.now() + SILENT_MS;
  looks = 0;
}

/**
 * Detects a connection that died silently. After a silence the server gets a small request; without an answer the
 * connection is lost. If the server answers but a running rehearsal stays silent for long, the socket alone is dead. No
 * second subscription is used for this: beside one whose answer is under way it could duplicate facts or leave out
 * samples.
 */
async function watchSilence(): Promise<void> {
  const its = socket;
  if (!its || performance.now() < lookAt_ms) return;
  lookAt_ms = Infinity;
  ++looks;
  const answers = await fetch('/healthz', { cache: 'no-store', signal: AbortSignal.timeout(SILENT_MS) }).then(
    () => true,
    () => false,
  );
  if (socket !== its || lookAt_ms !== Infinity) return; // meanwhile the socket brought a message or was lost
  lookAt_ms = performance.now() + SILENT_MS;
  // A real venue may be silent, and a rehearsal waits while its archive cannot store. But an opening or a catching-up
  // must always be answered.
  const speaks = known?.state === 'running' && known.venue !== 'downlink' && known.archiveFault === '';
  if (answers && !((speaks || state !== 'live') && looks >= LOOKS)) return;
  asks.abort();
  asks = new AbortController();
  lose(its);
  its.close(); // nobody waits for its closing handshake
}

/** Forgets the run and begins another. */
function restart(run: number): void {
  currentRun = run;
  known = undefined;
  lost = undefined;
  check = new SequenceCheck();
  collector = new ColumnCollector();
  step = 'facts';
  stopAt = 0;
  historyDue = false;
  leftOut = false;
  clearTimeout(quiet);
}

/**
 * Leaves a server that came back with another run of this number: its data must not mix with the run shown, and nothing
 * is sent to it.
 */
function leave(): void {
  const its = socket;
  socket = undefined;
  its?.close();
  post({ type: 'other_archive' });
}

function receive(bytes: Uint8Array): void {
  let message: ServerMessage['message'];
  try {
    message = fromBinary(ServerMessageSchema, bytes).message;
  } catch (error) {
    post({ type: 'trouble', words: `a message of the server could not be read: ${String(error)}` });
    return;
  }
  switch (message.case) {
    case 'welcome': {
      const welcome = message.value;
      welcomed = true;
      serverVersion = welcome.serverVersion;
      const its = welcome.runState && namedRun(welcome.runState);
      const run = Number(its?.run ?? 0);
      if (run === 0 && currentRun !== 0) {
        exact = true;
        subscribe();
        break;
      }
      if (run === 0) say('live');
      if (run === currentRun && known && its && !isSameRun(known, its)) {
        leave();
        return;
      }
      const fresh = run !== currentRun || step === 'facts';
      if (run !== currentRun) restart(run);
      known = its;
      stopAt = Number(welcome.lastSeq);
      post({ type: 'run', run: its, fresh });
      if (run !== 0 && step === 'facts' && stopAt === 0) goOnWithSamples();
      if (run !== 0 && step === 'samples') {
        if (check.completeThrough >= stopAt) say('live'); // nothing was missed
        fetchDueHistory(); // later batches have samples; earlier samples are in the archive
      }
      break;
    }
    case 'batch':
      receiveBatch(message.value);
      break;
    case 'commandReply':
      post({ type: 'reply', reply: message.value });
      break;
    case 'refusal':
      welcomed = true; // if it refused a subscription, the one before continues
      post({ type: 'refusal', reason: message.value.reason });
      break;
    case 'runState': {
      const run = namedRun(message.value);
      if (known?.run === run.run) known = run;
      post({ type: 'run', run, fresh: false });
      break;
    }
  }
}

function receiveBatch(batch: Batch): void {
  if (!welcomed) return;
  const run = Number(batch.run);
  if (run !== currentRun) {
    // The next run has begun on a subscription to the current run (0).
    restart(run);
    subscribe();
    return;
  }
  const first = batch.items[0];
  const verdict = check.judge(Number(batch.afterSeq), Number(batch.completeThrough), first && Number(first.seq));
  if (verdict === 'gap') {
    say('catching_up');
    subscribe();
    return;
  }
  if (verdict === 'repeats') return;
  collector.add(batch);
  const samples = batch.items.some(({ item }) => item.case === 'samples');
  leftOut ||= batch.leftOut > 0n;
  if (leftOut && (samples || batch.leftOut > 0n)) askOnceQuiet();
  if (step === 'facts' && check.completeThrough >= stopAt) goOnWithSamples();
  else if (step === 'samples' && state !== 'live' && check.completeThrough >= stopAt) say('live');
  postSoon(samples);
}

/** The last samples before a silence may be among those left out: once it is quiet, the archive is asked for them. */
function askOnceQuiet(): void {
  clearTimeout(quiet);
  quiet = setTimeout(() => {
    leftOut = false;
    if (state === 'live') void fetchHistory(questions(true), false);
  }, QUIET_MS);
}

/** Posts the collected batches when their pace allows; after a pause at once. */
function postSoon(samples: boolean): void {
  const now = performance.now();
  const wait_ms = Math.min(posts.wait(now), samples ? samplePosts.wait(now) : Infinity);
  if (posting && posting.at_ms <= now + wait_ms) return;
  clearTimeout(posting?.timer);
  posting = { timer: setTimeout(flush, wait_ms), at_ms: now + wait_ms };
}

function flush(): void {
  clearTimeout(posting?.timer);
  posting = undefined;
  const now = performance.now();
  posts.took(now);
  if (collector.empty) return;
  const batch = collector.take();
  if (batch.columns.length > 0) samplePosts.took(now);
  post({ type: 'batch', batch }, batch.columns);
}

function goOnWithSamples(): void {
  step = 'samples';
  historyDue = true;
  say('live');
  subscribe();
}

function fetchDueHistory(): void {
  if (!historyDue) return;
  historyDue = false;
  void fetchHistory(questions(true), false);
}

/** Channels, and the points of each. */
type Questions = readonly (readonly [names: readonly string[], points: number])[];
const questions = (all: boolean): Questions => [
  [plotted, PLOTTED_POINTS],
  [all ? others : [], OTHER_POINTS],
];

async function fetchHistory(of: Questions, live: boolean): Promise<void> {
  const run = currentRun;
  if (run === 0) return;
  try {
    for (const [names, points] of of) {
      for (let i = 0; i < names.length; i += CHANNELS_A_QUESTION) {
        const some = names.slice(i, i + CHANNELS_A_QUESTION);
        const columns = columnsOf(
          await askSeries(
            `/runs/${run}/channels?names=${some.map(encodeURIComponent).join(',')}&points=${points}&format=protobuf${live ? '&source=realtime' : ''}`,
          ),
        );
        if (run !== currentRun) return;
        post({ type: 'history', run, names: some, columns, live }, columns);
      }
    }
  } catch (error) {
    if ((error as Error).name === 'AbortError')
      historyDue = true; // once there is a connection again
    else post({ type: 'trouble', words: `history: ${error instanceof Error ? error.message : String(error)}` });
  }
}

const ANSWERS: Record<Exclude<Question, 'series'>, DescMessage> = {
  timepoints: TimepointListSchema,
  prediction: PredictionSchema,
  scenarios: ScenarioListSchema,
  packets: PacketListSchema,
  recording: RecordingSummarySchema,
  proof: ProofReportSchema,
  report: AsFlownReportSchema,
  commands: CommandListSchema,
};

/** The successful response, before its body is read. Throws the server's words with its status. */
async function get(path: string): Promise<Response> {
  const response = await fetch(apiUrl + path, { signal: asks.signal });
  if (response.ok) return response;
  const text = await response.text();
  let error = text.slice(0, 300);
  try {
    error = (JSON.parse(text) as { error?: string }).error ?? error;
  } catch {
    // The answer was not from our API; its text is quoted.
  }
  throw Object.assign(new Error(error || `${response.status} ${response.statusText}`), { status: response.status });
}

const ask = async (schema: DescMessage, path: string) =>
  fromJson(schema, await (await get(path)).json(), { ignoreUnknownFields: true });
const askSeries = async (path: string) => readSeriesList(new Uint8Array(await (await get(path)).arrayBuffer()));

async function answer(question: Question, path: string): Promise<{ value: unknown; columns?: Column[] }> {
  if (question !== 'series') return { value: await ask(ANSWERS[question], path) };
  const value = await askSeries(path);
  return { value, columns: columnsOf(value) };
}

self.onmessage = (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  switch (message.type) {
    case 'open':
      wantedRun = message.run;
      ({ plotted, others } = message);
      collector = new ColumnCollector();
      connect();
      setInterval(() => void watchSilence(), LOOK_EVERY_MS);
      break;
    case 'plot': {
      const before = new Set(plotted);
      ({ plotted, others } = message);
      const added = plotted.filter((name) => !before.has(name));
      void fetchHistory([[added, PLOTTED_POINTS]], false);
      if (message.live) void fetchHistory([[added, PLOTTED_POINTS]], true);
      break;
    }
    case 'watch':
      wantedRun = message.run;
      exact = false;
      restart(0);
      subscribe();
      break;
    case 'reconnect':
      if (retry !== undefined) {
        clearTimeout(retry);
        connect();
      }
      break;
    case 'refresh_history':
      void fetchHistory(questions(message.all), message.live);
      break;
    case 'command':
      if (
        !send({
          case: 'command',
          value: { ...message.intent, run: BigInt(message.run), request: BigInt(message.request) },
        })
      ) {
        post({ type: 'not_sent', request: message.request });
      }
      break;
    case 'control':
      if (!send({ case: 'control', value: { ...control(message.control), run: BigInt(message.run) } })) {
        post({ type: 'trouble', words: 'not connected: nothing was sent' });
      }
      break;
    case 'ask':
      answer(message.question, message.path).then(
        ({ value, columns }) => post({ type: 'answer', ask: message.ask, ok: true, value }, columns),
        (error: unknown) =>
          post({
            type: 'answer',
            ask: message.ask,
            ok: false,
            error: error instanceof Error ? error.message : String(error),
            status: (error as { status?: number }).status ?? 0,
          }),
      );
      break;
  }
};

function control(wanted: ControlAction): MessageInitShape<typeof RehearsalControlSchema> {
  switch (wanted.action) {
    case 'pause':
      return { action: { case: 'pause', value: wanted.pause } };
    case 'pace':
      return { action: { case: 'pace', value: wanted.pace } };
    case 'stop':
      return { action: { case: 'stop', value: true } };
  }
}
