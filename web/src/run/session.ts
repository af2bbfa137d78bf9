// SPDX-License-Identifier: Apache-2.0
// The page's way from run to run: which run is followed, which data are requested when, and how the page begins.
import { batch, effect } from '@preact/signals';
import type { ScenarioList, TimepointList } from '../gen/aeolis/v1/run_pb';
import type { NamedRun } from '../stream/names';
import type { FromWorker, ToWorker } from '../stream/messages';
import { resumedWords } from '../mode/model';
import { access, admitted, learnAccess } from '../access/model';
import { refreshAlarms } from '../alarms/model';
import { Refused, call, giveUpReads, wordsFor } from './api';
import { ask, giveUpCommands, inDoubt, post, sendBy, stream, takeAnswer } from './connection';
import { Dictionary } from './dictionary';
import { opened } from './address';
import { firstAnswers } from './first_look';
import type { FirstLook } from './first_look';
import { refreshLimits } from './limits';
import { isSameRun } from './same';
import { refreshStaleness } from './staleness';
import {
  asHeard,
  asked,
  dictionary,
  notify,
  pastRange,
  isPlotted,
  plottedChannels,
  replay,
  runs,
  scenarios,
  store,
  tick,
  timepoints,
  watched,
} from './shown';
import { askDictionary, askRuns, isGoing } from './start';
import { RunStore } from './store';
import { refreshPrediction } from '../prediction/model';
import { refreshAgainst } from '../waiting/told';
import { TimelinePace, timelineAnswer, timelineQuestion } from '../timeline/asked';

export function backToLive(): void {
  replay.value = undefined;
  pastRange.value = undefined;
  if (begun) watch(0);
}

/**
 * The run that began while the past of another is shown. The stream already follows it; the page shows it once the past
 * is left.
 */
let begun: bigint | undefined;

function staysInThePast(of: RunStore, run: NamedRun): void {
  if (begun === run.run) return;
  begun = run.run;
  notify(`Run ${begun}, ${run.scenario}, has begun; Esc leaves the past of run ${of.id} for it.`);
}

let lostAt_e_s = NaN; // time from entry on the header when the connection broke

const ALARMS_EVERY_S = 5; // chosen: a shelved alarm returns without an item
const TIMELINE_LOOK_S = 0.25; // chosen: interval of checks for news of the timeline
const FIRST_LOOK_MS = 500; // chosen: longest delay of the start by the first look
// chosen: longest wait for the session; a stream on which the server does not know this browser is better than none
const SESSION_MS = 5000;

const wholeHistory = new WeakSet<RunStore>(); // runs whose history has arrived, which need no first look

/**
 * Starts or continues a rehearsal. The view stays until the new run exists, or the cut-off run has caught up. Throws
 * the server's words.
 */
export async function startRehearsal(
  order:
    | { scenario: string; seed: string; pace: number; plan?: string; inline_plan?: string }
    | { continue_run: number; pace: number }
    | { fork: { run: number; at: string; seed?: string; paused: boolean }; pace: number },
  isWaitedFor = () => true,
): Promise<void> {
  // for a cut-off run and a fork the answer arrives after it has been flown again
  await call('POST', '/rehearsals', order, Infinity);
  if (isWaitedFor()) watch(0);
}

export function watch(run: number): void {
  [watched.value, asked.value] = [run, run];
  begun = undefined;
  backToLive();
  store.value = undefined;
  timepoints.value = [];
  post({ type: 'watch', run });
}

/**
 * Runs whose live samples were requested separately. A thinned mixture with the recording has few live points, so a
 * past as heard has its own.
 */
const askedLive = new WeakSet<RunStore>();
/** Requests thinned history again. During the run only plotted channels, since the archive is busy. */
function refreshHistory(of: RunStore): void {
  if (!of.going) of.thinnedSinceHistory = false;
  post({ type: 'refresh_history', all: !of.going, live: false });
  if (asHeard.value) post({ type: 'refresh_history', all: true, live: true });
  else askedLive.delete(of);
}

export function onMessage(message: FromWorker): void {
  switch (message.type) {
    case 'stream': {
      const before = stream.value.state;
      stream.value = message;
      if (message.state === 'lost') inDoubt.value = true;
      if (message.state === 'lost' && before !== 'lost') {
        giveUpReads();
        void learnAccess().catch(() => undefined); // the end of a session closes the stream
        lostAt_e_s = store.value?.seenE ?? NaN;
        giveUpCommands();
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
        store.value.addHistory(message.columns, message.names, message.live);
      }
      break;
    case 'reply':
    case 'not_sent':
    case 'answer':
      takeAnswer(message);
      break;
    case 'refusal':
      if (inDoubt.peek()) void refreshRuns(); // the server may not know the run shown
      notify(message.reason);
      break;
    case 'trouble':
      notify(message.words);
      break;
  }
}

const LEFT = 'aeolis-left'; // key of the notice that follows a reload

/**
 * Handles a server with another archive, which never had the run shown. All data here belong to the old archive, down
 * to the dictionary. So the page reloads and goes to the current run.
 */
function takeOtherArchive(): void {
  const run = store.value;
  inDoubt.value = true;
  stream.value = { ...stream.value, state: 'catching_up' };
  sessionStorage.setItem(
    LEFT,
    `The server has another archive now${run ? `: run ${run.id}, ${run.run.scenario}, which was shown here, is not in it` : ''}.`,
  );
  const url = new URL(location.href);
  for (const part of ['run', 'past', 'with', 'span', 'at']) url.searchParams.delete(part);
  history.replaceState(null, '', url);
  location.reload();
}

function takeRun(run: NamedRun | undefined): void {
  if (!run || run.run === 0n) return;
  const known = store.value;
  if (known?.id === Number(run.run)) {
    if (!isSameRun(known.run, run)) {
      takeOtherArchive();
      return;
    }
    inDoubt.value = false;
    known.update(run);
  } else if (watched.value === 0 && known && pastRange.value) {
    staysInThePast(known, run);
  } else if (watched.value === 0 || watched.value === Number(run.run)) {
    inDoubt.value = false;
    store.value = new RunStore(run, isPlotted);
    backToLive();
  } else {
    return;
  }
  void refreshTimepoints();
  runs.value = [run, ...runs.value.filter((other) => other.run !== run.run)].sort((a, b) => Number(b.run - a.run));
}

let timepointsUnderWay = false;
const timelinePace = new TimelinePace();
async function refreshTimepoints(): Promise<void> {
  const of = store.value;
  if (!of || timepointsUnderWay) return;
  timepointsUnderWay = true;
  const [asked, version] = [timelineQuestion.peek(), of.timelineVersion];
  let failed = false;
  try {
    const list = await ask<TimepointList>('timepoints', `/runs/${of.id}/timepoints${asked.text}`);
    if (store.value === of)
      batch(() => {
        timepoints.value = list.timepoints;
        timelineAnswer.value = { asked, list, at_ms: performance.now() };
      });
  } catch {
    failed = true; // the timeline says that it has no plan; the next round asks again
  } finally {
    timepointsUnderWay = false;
    timelinePace.asked(of, asked.text, version, performance.now(), failed);
    if (store.value !== of) void refreshTimepoints();
  }
}

export async function refreshRuns(): Promise<void> {
  const [before, shown, doubted] = [runs.value, store.value, inDoubt.peek()];
  try {
    const all = await askRuns();
    const isOther = (run: NamedRun) => all.some((each) => each.run === run.run && !isSameRun(each, run));
    if (before.some(isOther) || (shown && shown === store.value && !all.some((each) => each.run === shown.run.run)))
      return takeOtherArchive();
    if (doubted && shown) inDoubt.value = false; // the run shown is among them
    const held = store.value;
    // A finished run stays finished: an answer from before its end may arrive after it. A cut-off run may continue.
    runs.value = all.map((run) => (held && run.run === held.run.run && held.run.state === 'finished' ? held.run : run));
    const mine = runs.value.find((run) => run.run === held?.run.run);
    if (mine && held && (!held.going || begun)) held.update(mine);
    // A run began while the followed one was already over, or lost with its server: go there.
    const going = runs.value.find(isGoing);
    if (watched.value !== 0 || !going || !held || held.going || going.run === held.run.run) return;
    if (pastRange.value) staysInThePast(held, going);
    else watch(0);
  } catch {
    // Not connected; the header says so.
  }
}

async function askScenarios(after = 0n): Promise<void> {
  const list = await ask<ScenarioList>('scenarios', `/scenarios${after ? `?after=${after}` : ''}`);
  scenarios.value = [...scenarios.value, ...list.scenarios];
  if (list.nextAfter) await askScenarios(list.nextAfter);
}

async function everySeconds(seconds: number, what: () => Promise<void>): Promise<never> {
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, seconds * 1000));
    await what();
  }
}

/**
 * Starts the worker. Its schema takes as long to load as a picture to draw, so it starts once the first look is under
 * way.
 */
function startWorker(): void {
  const worker = new Worker(new URL('../stream/worker.ts', import.meta.url), { type: 'module' });
  worker.onmessage = (event: MessageEvent<FromWorker>) => onMessage(event.data);
  worker.onerror = (event) => notify(`the stream's worker failed: ${event.message}`);
  sendBy(worker);
}

/** The channels whose history has many points, and the others. */
function channelsOf(words: Dictionary): { plotted: string[]; others: string[] } {
  const plotted = plottedChannels();
  return {
    plotted,
    others: words.channels.map((channel) => channel.name).filter((name) => !plotted.includes(name)),
  };
}

/** Loads the dictionary, chooses the current or the newest run, takes a first look at it, and connects. */
export async function begin(): Promise<void> {
  const left = sessionStorage.getItem(LEFT);
  if (left !== null) notify(left);
  sessionStorage.removeItem(LEFT);
  const wanted = opened.picture.run;
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
      knowing.catch(() => undefined); // handled below
      const [all, reply] = await startFrom().catch(async (error: unknown) => {
        if (!(error instanceof Refused) || error.status !== 401) throw error;
        await knowing.then(learnAccess); // the session tells more than the status 401
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
    : runs.value.some(isGoing)
      ? 0
      : Number(runs.value[0]?.run ?? 0);
  if (wanted > 0 && chosen !== wanted)
    notify(
      `Run ${wanted} is not in this archive; what is shown is ${chosen === 0 ? 'the run that goes on' : chosen > 0 ? `run ${chosen}` : 'nothing'}.`,
    );
  [watched.value, asked.value] = [chosen, chosen === wanted ? wanted : 0];
  knowing.catch((error: unknown) => notify(`the server does not say who you are: ${wordsFor(error)}`));
  const words = dictionary.value as Dictionary;
  const lookAt = runs.value.find((run) => (chosen === 0 ? isGoing(run) : Number(run.run) === chosen));
  takeRun(lookAt);
  const looked = first?.then((look) => {
    if (look && store.value?.id === look.run && !wholeHistory.has(store.value)) store.value.addHistory(look.columns);
  });
  const passed = (ms: number) => new Promise((resolve) => setTimeout(resolve, ms));
  const known = Promise.race([knowing.catch(() => undefined), passed(SESSION_MS)]);
  await Promise.race([looked, passed(FIRST_LOOK_MS)]);
  await known; // the answer carries the cookie by which the stream's server knows this browser
  startWorker();
  post({ type: 'open', run: chosen, ...channelsOf(words) });
  let before = plottedChannels().join();
  effect(() => {
    const now = plottedChannels().join();
    if (now !== before) post({ type: 'plot', ...channelsOf(words), live: asHeard.peek() });
    before = now;
  });
  void askScenarios().catch(() => undefined);
  let wasIn = true;
  effect(() => {
    const isIn = access.value.state !== 'out';
    if (isIn && !wasIn) post({ type: 'reconnect' });
    wasIn = isIn;
  });
  effect(() => {
    const run = store.value;
    if (run && stream.value.state === 'lost') askedLive.delete(run); // pending requests get no answer any more
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
  void everySeconds(1, async () => {
    if (stream.value.state === 'live') await refreshPrediction();
  });
  void everySeconds(1, refreshLimits);
  void everySeconds(1, refreshStaleness);
  void everySeconds(3, refreshRuns);
  void everySeconds(1, refreshAgainst);
  void everySeconds(TIMELINE_LOOK_S, async () => {
    const run = store.value;
    if (run && timelinePace.isDue(run, timelineQuestion.peek().text, performance.now())) await refreshTimepoints();
  });
  void everySeconds(5, async () => {
    if (store.value?.thinnedSinceHistory && stream.value.state === 'live') refreshHistory(store.value);
  });
}

/**
 * For tests of views: a page without a worker, or with one that only `hears`. The test passes the worker's messages to
 * onMessage.
 */
export function useForTest(
  run: RunStore | undefined,
  words: Dictionary | undefined,
  hears?: (message: ToWorker) => void,
): void {
  sendBy(hears && ({ postMessage: hears } as Worker));
  stream.value = { ...stream.value, state: 'live' };
  inDoubt.value = false;
  store.value = run;
  dictionary.value = words;
  tick.value += 1;
}

effect(() => {
  document.documentElement.dataset.stream = stream.value.state;
});
