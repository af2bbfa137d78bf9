// The page's side of the worker: what is connected, which run is looked at, and the signals the panels read.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Signal } from '@preact/signals';
import type { AnchorRow, CommandReply, RunState, ScenarioList, TimepointList, TimepointRow } from '../gen/aeolis/v1/run_pb';
import type { CommandIntent, ControlAction, FromWorker, Question, StreamState, ToWorker } from '../stream/messages';
import { LAYOUT } from '../layout';
import { modeOf, resumedWords } from '../mode/model';
import type { Mode } from '../mode/model';
import { access, admitted, learnAccess, mayAct } from '../access/model';
import { refreshAlarms } from '../alarms/model';
import { Refused, call, giveUpReads, turnedAway, wordsFor } from './api';
import { Dictionary } from './dictionary';
import { namedChannels, wantedRun } from './address';
import { firstAnswers } from './first_look';
import type { FirstLook } from './first_look';
import { isSameRun } from './same';
import { askDictionary, askRuns, isGoing } from './start';
import { RunStore } from './store';

export const stream = signal<{ state: StreamState; attempt: number; gaps: number; serverVersion: string }>({
  state: 'connecting', attempt: 0, gaps: 0, serverVersion: '',
});
export const isLost = computed(() => stream.value.state === 'lost');
export const store = signal<RunStore | undefined>(undefined);
/** What belongs to the run that is shown: once it is another one, as it was at first. */
export function signalOfRun<T>(first: T): Signal<T> {
  const value = signal(first);
  const shown = computed(() => store.value?.id);
  effect(() => {
    void shown.value;
    untracked(() => (value.value = first));
  });
  return value;
}
export const dictionary = signal<Dictionary | undefined>(undefined);
export const timepoints = signal<TimepointRow[]>([]);
export const anchors = signal<AnchorRow[]>([]);
export const runs = signal<RunState[]>([]);
export const scenarios = signal<{ name: string; title: string }[]>([]);
/** The run asked for: 0 is "the one that is going on". */
export const watched = signal(0);
/** Five times a second, when something has changed. Numbers on the screen follow this and nothing faster. */
export const tick = signal(0);
/** Follows it a frame later: for tables so long that they take a frame of their own. */
export const rowsTick = signal(0);
/** A part of the run looked at as the past, in seconds from entry; undefined: not a past view. */
export const pastRange = signal<{ from: number; to: number } | undefined>(undefined);
/** Of a past view: with what only the recording told, or as it was heard then. */
export const withRecording = signal(false);

/** The run as every panel shows it. */
export function shownRun(): RunStore | undefined {
  const run = store.value;
  return pastRange.value && !withRecording.value ? run?.asHeardBy(cutoff.value, packetOf) : run;
}
const packetOf = (channel: number): string | undefined => dictionary.value?.channel(channel)?.packet;
/** The same, read by a view: it is then shown again at each tick, for a store changes without becoming another. */
export function runNow(): RunStore | undefined {
  void tick.value;
  return shownRun();
}

export interface Notice {
  id: number;
  text: string;
}
export const notices = signal<Notice[]>([]);
let lastNotice = 0;

export function notify(text: string): void {
  const shown = notices.value.filter((notice) => notice.text !== text);
  notices.value = [...shown.slice(-3), { id: ++lastNotice, text }];
}
export function dismissNotice(id?: number): void {
  notices.value = id === undefined ? [] : notices.value.filter((notice) => notice.id !== id);
}

/** SCLK up to which things are shown: the end of the past view, else all. */
export const cutoff = computed(() =>
  pastRange.value && store.value ? store.value.entrySclk + pastRange.value.to : Infinity);

/** A replay: the past view whose end moves on. `pastRange` is then what has been replayed so far. */
export const replay = signal<{ pace: number; playing: boolean } | undefined>(undefined);

/** Read with `tick`: a run's own state changes without a new store. */
export function modeNow(): Mode {
  void tick.value;
  return modeOf(store.value, pastRange.value !== undefined, replay.value !== undefined);
}

/** Of a mission that is only listened to. */
export const hasNoCommands = (): boolean => dictionary.value?.commands.length === 0;

/** Whether a command can be sent from what is shown. */
export function takesCommands(): boolean {
  return ['live', 'rehearsal'].includes(modeNow()) && mayAct() && !hasNoCommands();
}

export function lookAtPast(range: { from: number; to: number }, recorded: boolean): void {
  withRecording.value = recorded;
  pastRange.value = range;
}

export function backToLive(): void {
  replay.value = undefined;
  pastRange.value = undefined;
  if (begun) watch(0);
}

/** A run that began while the past of another was looked at: the stream is of it, and so will be what is shown, once who looks comes back. */
let begun: bigint | undefined;

function staysInThePast(of: RunStore, run: RunState): void {
  if (begun === run.run) return;
  begun = run.run;
  notify(`Run ${begun}, ${run.scenario}, has begun; Esc leaves the past of run ${of.id} for it.`);
}

let lostAt_e_s = NaN; // when the connection broke, as the header showed it

const ALARMS_EVERY_S = 5; // ours: what is shelved comes back without an item
const FIRST_LOOK_MS = 500; // ours: what follows does not wait longer for it
const SESSION_MS = 5000; // ours: a stream by which the server does not know this browser is worth more than none

const wholeHistory = new WeakSet<RunStore>(); // what of it has come needs no first look any more

let worker: Worker | undefined;
const forWorker: ToWorker[] = []; // until there is one
let lastAsk = 0;
let lastRequest = 0;
const asked = new Map<number, { resolve: (value: unknown) => void; reject: (error: Error) => void }>();
const requests = new Map<number, { resolve: (reply: CommandReply) => void; reject: (error: Error) => void }>();
/** Sent and given up on: what an answer that comes late is about. */
const unanswered = new Map<number, string>();

function post(message: ToWorker): void {
  if (worker) worker.postMessage(message);
  else forWorker.push(message);
}

/**
 * Since the connection broke, until the server that came back has said that it has the very run that is shown: what answers may have another archive,
 * with no such run, or another one of its number.
 */
let inDoubt = false;

/** Throws then: before anything of the run is asked. */
export function refuseInDoubt(): void {
  if (inDoubt) throw new Refused(0, 'not connected: nothing was asked');
}

/** Asks an HTTP route by the worker; rejects with the server's own words. */
export async function ask<T>(question: Question, path: string): Promise<T> {
  if (path.startsWith('/runs/')) refuseInDoubt();
  const number = ++lastAsk;
  return new Promise<T>((resolve, reject) => {
    asked.set(number, { resolve: resolve as (value: unknown) => void, reject });
    post({ type: 'ask', ask: number, question, path });
  });
}

/** Why nothing can be sent now; undefined where the server has said that this very run is what it has, and all of it is here. */
export function whyNotSent(): string | undefined {
  const { state } = stream.value;
  return state === 'live' ? undefined : state === 'catching_up' ? 'catching up: nothing was sent' : NOT_SENT;
}

/** Of the run that is shown, if no other is named: another that goes on meanwhile is not touched. */
export function control(action: ControlAction, run = store.value?.id ?? 0): void {
  const why = whyNotSent();
  if (why === undefined) post({ type: 'control', run, control: action });
  else notify(why);
}

/** Asks of the run that is shown, over HTTP: what has a small answer. */
export async function read<T>(path: string): Promise<T> {
  refuseInDoubt();
  return call<T>('GET', path);
}

/** Changes something of it, so too. */
export async function change<T>(path: string, body: object, within_ms?: number): Promise<T> {
  const why = whyNotSent();
  if (why === undefined) return call<T>('POST', path, body, within_ms);
  await learnAccess().catch(() => undefined); // the end of a session ends the connection, too
  throw new Refused(409, access.value.state === 'out' ? 'log in first' : why);
}

/** What is looked at stays until the new run is there, or the one that was cut off has caught up. Throws the server's words. */
export async function startRehearsal(order: { scenario: string; seed: string; pace: number } | { continue_run: number; pace: number }, isWaitedFor = () => true): Promise<void> {
  await call('POST', '/rehearsals', order, Infinity); // one that was cut off is flown again as far as it had come before the answer is there
  if (isWaitedFor()) watch(0);
}

const NOT_SENT = 'not connected: nothing was sent';
const ANSWER_WITHIN_MS = 30_000; // ours: longer than any question of the server may take

/** Sent, and no answer will come: it may have been taken or not. */
export class OutcomeUnknown extends Error {}

/** Sends once. Rejects when nothing was sent, and with OutcomeUnknown when it was and no answer came. Only the reply that bears its number is its answer. */
export function sendCommand(intent: CommandIntent): Promise<CommandReply> {
  const why = whyNotSent();
  if (why !== undefined) return Promise.reject(new Error(why));
  const request = ++lastRequest;
  return new Promise((resolve, reject) => {
    requests.set(request, { resolve, reject });
    setTimeout(() => {
      if (!requests.delete(request)) return;
      if (!intent.dryRun) unanswered.set(request, intent.command ?? `${intent.action} of command ${intent.number}`);
      reject(new OutcomeUnknown(`no answer came in ${ANSWER_WITHIN_MS / 1000} s: whether it was taken is not known; the history below will say`));
    }, ANSWER_WITHIN_MS);
    post({ type: 'command', request, run: store.value?.id ?? 0, intent });
  });
}

export function watch(run: number): void {
  watched.value = run;
  begun = undefined;
  backToLive();
  const url = new URL(location.href);
  if (run === 0) url.searchParams.delete('run');
  else url.searchParams.set('run', String(run));
  history.replaceState(null, '', url);
  store.value = undefined;
  timepoints.value = [];
  anchors.value = [];
  post({ type: 'watch', run });
}

/** Thinned together with the recording, few of what came live are among the points: a past as it was heard has its own. */
const askedLive = new WeakSet<RunStore>();
export const asHeard = computed(() => pastRange.value !== undefined && !withRecording.value);

/** What came thinned is asked for again: while the run goes on only what is drawn, for the archive has work to do. */
function refreshHistory(of: RunStore): void {
  if (!of.going) of.thinnedSinceHistory = false;
  post({ type: 'refresh_history', all: !of.going, live: false });
  if (asHeard.value) post({ type: 'refresh_history', all: true, live: true }); // the answer above replaces the one of live alone
  else askedLive.delete(of);
}

export function onMessage(message: FromWorker): void {
  switch (message.type) {
    case 'stream': {
      const before = stream.value.state;
      stream.value = message;
      if (message.state === 'lost') inDoubt = true;
      if (message.state === 'lost' && before !== 'lost') {
        giveUpReads();
        void learnAccess().catch(() => undefined); // a session that ended closes the stream
        lostAt_e_s = store.value?.seenE ?? NaN;
        for (const request of requests.values()) {
          request.reject(new OutcomeUnknown('the connection was lost before an answer came: whether it was taken is not known; the history below will say'));
        }
        requests.clear();
      }
      break;
    }
    case 'run':
      takeRun(message.run);
      break;
    case 'other_archive':
      takeOtherArchive();
      break;
    case 'resumed':
      if (store.value?.id === message.run) notify(resumedWords(message, store.value.run, lostAt_e_s));
      break;
    case 'batch':
      if (store.value?.id === message.batch.run) store.value.add(message.batch);
      break;
    case 'history':
      if (store.value?.id === message.run) {
        wholeHistory.add(store.value);
        store.value.addHistory(message.columns, message.names);
      }
      break;
    case 'reply': {
      const request = Number(message.reply.request);
      requests.get(request)?.resolve(message.reply);
      requests.delete(request);
      const { accepted, command, reason } = message.reply;
      const late = unanswered.get(request);
      if (late !== undefined) notify(`${late}: the answer has come late. ${accepted ? `It was taken${command > 0n ? ` as #${command}` : ''}.` : `It was refused: ${reason}; nothing was sent.`}`);
      unanswered.delete(request);
      break;
    }
    case 'not_sent':
      requests.get(message.request)?.reject(new Error(NOT_SENT));
      requests.delete(message.request);
      break;
    case 'refusal':
      if (inDoubt) void refreshRuns(); // it may be the run that is shown of which the server knows nothing
      notify(message.reason);
      break;
    case 'trouble':
      notify(message.words);
      break;
    case 'answer': {
      const question = asked.get(message.ask);
      asked.delete(message.ask);
      if (message.ok) question?.resolve(message.value);
      else {
        if (message.status === 401) turnedAway.value += 1;
        question?.reject(new Refused(message.status, message.error));
      }
      break;
    }
  }
}

const LEFT = 'aeolis-left'; // what is said once the page has begun anew

/**
 * The server has an archive in which what is shown never was. Everything here is of the old one, down to the dictionary: the page begins
 * anew, and goes to the run that goes on.
 */
function takeOtherArchive(): void {
  const run = store.value;
  inDoubt = true;
  stream.value = { ...stream.value, state: 'catching_up' };
  sessionStorage.setItem(LEFT, `The server has another archive now${run ? `: run ${run.id}, ${run.run.scenario}, which was shown here, is not in it` : ''}.`);
  const url = new URL(location.href);
  url.searchParams.delete('run');
  history.replaceState(null, '', url);
  location.reload();
}

function takeRun(run: RunState | undefined): void {
  if (!run || run.run === 0n) return;
  const known = store.value;
  if (known?.id === Number(run.run)) {
    if (!isSameRun(known.run, run)) return takeOtherArchive();
    inDoubt = false;
    known.update(run);
  } else if (watched.value === 0 && known && pastRange.value) {
    staysInThePast(known, run);
  } else if (watched.value === 0 || watched.value === Number(run.run)) {
    const drawn = new Set(plottedChannels().map((name) => dictionary.value?.pick([name])?.id));
    inDoubt = false;
    store.value = new RunStore(run, (channel) => drawn.has(channel));
    backToLive();
  } else {
    return;
  }
  void refreshTimepoints();
  runs.value = [run, ...runs.value.filter((other) => other.run !== run.run)].sort((a, b) => Number(b.run - a.run));
}

let timepointsUnderWay = false;
let timepointsOf: RunStore | undefined; // whose they are
async function refreshTimepoints(): Promise<void> {
  const of = store.value;
  if (!of || timepointsUnderWay) return;
  timepointsUnderWay = true;
  try {
    const list = await ask<TimepointList>('timepoints', `/runs/${of.id}/timepoints`);
    if (store.value === of) [timepoints.value, anchors.value, timepointsOf] = [list.timepoints, list.anchors, of];
  } catch {
    // The timeline says that it has no plan; the next round asks again.
  } finally {
    timepointsUnderWay = false;
    if (store.value !== of) void refreshTimepoints();
  }
}

export async function refreshRuns(): Promise<void> {
  const [before, shown, doubted] = [runs.value, store.value, inDoubt];
  try {
    const all = await askRuns();
    const isOther = (run: RunState) => all.some((each) => each.run === run.run && !isSameRun(each, run));
    if (before.some(isOther) || (shown && shown === store.value && !all.some((each) => each.run === shown.run.run))) return takeOtherArchive();
    if (doubted && shown) inDoubt = false; // it is among them
    const held = store.value;
    // What is over stays over: an answer from before its end may come after it. One that was cut off may go on.
    runs.value = all.map((run) => (held && run.run === held.run.run && held.run.state === 'finished' ? held.run : run));
    const mine = runs.value.find((run) => run.run === held?.run.run);
    if (mine && held && (!held.going || begun)) held.update(mine);
    // A run that began while the one we follow was already over, or lost with its server: go there.
    const going = runs.value.find(isGoing);
    if (watched.value !== 0 || !going || !held || held.going || going.run === held.run.run) return;
    if (pastRange.value) staysInThePast(held, going);
    else watch(0);
  } catch {
    // Not connected; the header says so.
  }
}

async function everySeconds(seconds: number, what: () => Promise<void>): Promise<never> {
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, seconds * 1000));
    await what();
  }
}

/** What is drawn over time: its history comes finer. */
export function plottedChannels(): string[] {
  const picks = [...namedChannels().map((name) => [name]), ...LAYOUT.plots.map((plot) => plot.channel), LAYOUT.altitude, LAYOUT.speed, LAYOUT.phase];
  return [...new Set(picks.map((names) => dictionary.value?.pick(names)?.name).filter((name) => name !== undefined))];
}

/** Its schema takes as long to load as a picture to draw: it starts once the first look is on its way to the screen. */
function startWorker(): void {
  worker = new Worker(new URL('../stream/worker.ts', import.meta.url), { type: 'module' });
  worker.onmessage = (event: MessageEvent<FromWorker>) => onMessage(event.data);
  worker.onerror = (event) => notify(`the stream's worker failed: ${event.message}`);
  forWorker.splice(0).forEach(post);
}

/** Learns the dictionary, chooses the run that is going on or the last one, takes a first look at it, and connects. */
export async function begin(): Promise<void> {
  const left = sessionStorage.getItem(LEFT);
  if (left !== null) notify(left);
  sessionStorage.removeItem(LEFT);
  const wanted = wantedRun();
  let first: Promise<FirstLook | undefined> | undefined;
  const startFrom = () => {
    const { runs, look } = firstAnswers();
    first = look;
    return Promise.all([runs, askDictionary()]);
  };
  let knowing: Promise<void>;
  for (let attempt = 0; ; ++attempt) {
    try {
      knowing = learnAccess();
      knowing.catch(() => undefined); // looked at below
      const [all, reply] = await startFrom().catch(async (error: unknown) => {
        if (!(error instanceof Refused) || error.status !== 401) throw error;
        await knowing.then(learnAccess); // what turned us away may not be all that it says
        await admitted();
        return startFrom();
      });
      dictionary.value = new Dictionary(reply);
      runs.value = all;
      break;
    } catch (error) {
      stream.value = { ...stream.value, state: 'lost', attempt: attempt + 1 };
      if (attempt === 3) notify(`the server does not answer: ${error instanceof Error ? error.message : ''}`);
      await new Promise((resolve) => setTimeout(resolve, Math.min(5000, 250 * 2 ** attempt)));
    }
  }
  const chosen = runs.value.some((run) => Number(run.run) === wanted)
    ? wanted
    : runs.value.some(isGoing) ? 0 : Number(runs.value[0]?.run ?? 0);
  if (wanted > 0 && chosen !== wanted) notify(`Run ${wanted} is not in this archive; what is shown is ${chosen === 0 ? 'the run that goes on' : chosen > 0 ? `run ${chosen}` : 'nothing'}.`);
  watched.value = chosen;
  knowing.catch((error: unknown) => notify(`the server does not say who you are: ${wordsFor(error)}`));
  const words = dictionary.value as Dictionary;
  const plotted = plottedChannels();
  const others = words.channels.map((channel) => channel.name).filter((name) => !plotted.includes(name));
  const lookAt = runs.value.find((run) => (chosen === 0 ? isGoing(run) : Number(run.run) === chosen));
  takeRun(lookAt);
  const looked = first?.then((look) => {
    if (look && store.value?.id === look.run && !wholeHistory.has(store.value)) store.value.addHistory(look.columns);
  });
  const passed = (ms: number) => new Promise((resolve) => setTimeout(resolve, ms));
  const known = Promise.race([knowing.catch(() => undefined), passed(SESSION_MS)]);
  await Promise.race([looked, passed(FIRST_LOOK_MS)]);
  await known; // with the answer comes the cookie by which the stream's server knows this browser
  startWorker();
  post({ type: 'open', run: chosen, packets: Object.fromEntries(words.packets), plotted, others });
  ask<ScenarioList>('scenarios', '/scenarios').then(
    (list) => (scenarios.value = list.scenarios), () => undefined);
  let wasIn = true;
  effect(() => {
    const isIn = access.value.state !== 'out';
    if (isIn && !wasIn) post({ type: 'reconnect' });
    wasIn = isIn;
  });
  effect(() => {
    const run = store.value;
    if (!run || !asHeard.value || stream.value.state !== 'live' || askedLive.has(run)) return;
    askedLive.add(run);
    post({ type: 'refresh_history', all: true, live: true });
  });
  let told = -1;
  let since = 0;
  void everySeconds(1, async () => {
    const run = store.value;
    if (!run || stream.value.state !== 'live' || (run.alarmsVersion === told && ++since < ALARMS_EVERY_S)) return;
    [told, since] = [run.alarmsVersion, 0];
    await refreshAlarms();
  });
  void everySeconds(3, refreshRuns);
  void everySeconds(2, async () => {
    if (store.value?.going || store.value !== timepointsOf) await refreshTimepoints();
  });
  void everySeconds(5, async () => {
    if (store.value?.thinnedSinceHistory && stream.value.state === 'live') refreshHistory(store.value);
  });
}

/** For tests of views: a page without a worker, or with one that only `hears`; what it would say is given to onMessage. */
export function useForTest(run: RunStore | undefined, words: Dictionary | undefined, hears?: (message: ToWorker) => void): void {
  worker = hears && ({ postMessage: hears } as Worker);
  stream.value = { ...stream.value, state: 'live' };
  inDoubt = false;
  store.value = run;
  dictionary.value = words;
  tick.value += 1;
}

effect(() => {
  document.documentElement.dataset['stream'] = stream.value.state;
});
