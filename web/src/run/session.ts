// SPDX-License-Identifier: Apache-2.0
// What leads from run to run: which one is followed, what of it is learnt from the server and when, and how the page begins.
import { batch, effect } from '@preact/signals';
import type { RunState, ScenarioList, TimepointList } from '../gen/aeolis/v1/run_pb';
import type { FromWorker, ToWorker } from '../stream/messages';
import { resumedWords } from '../mode/model';
import { access, admitted, learnAccess } from '../access/model';
import { refreshAlarms } from '../alarms/model';
import { Refused, call, giveUpReads, wordsFor } from './api';
import { ask, giveUpCommands, inDoubt, post, sendBy, stream, takeAnswer } from './connection';
import { Dictionary } from './dictionary';
import { wantedRun } from './address';
import { firstAnswers } from './first_look';
import type { FirstLook } from './first_look';
import { isSameRun } from './same';
import {
  asHeard,
  dictionary,
  notify,
  pastRange,
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
import { refreshAgainst } from '../waiting/told';
import { TimelinePace, timelineAnswer, timelineQuestion } from '../timeline/asked';

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
const TIMELINE_LOOK_S = 0.25; // ours: whether there is anything to ask about it
const FIRST_LOOK_MS = 500; // ours: what follows does not wait longer for it
const SESSION_MS = 5000; // ours: a stream by which the server does not know this browser is worth more than none

const wholeHistory = new WeakSet<RunStore>(); // what of it has come needs no first look any more

/** What is looked at stays until the new run is there, or the one that was cut off has caught up. Throws the server's words. */
export async function startRehearsal(
  order: { scenario: string; seed: string; pace: number } | { continue_run: number; pace: number },
  isWaitedFor = () => true,
): Promise<void> {
  await call('POST', '/rehearsals', order, Infinity); // one that was cut off is flown again as far as it had come before the answer is there
  if (isWaitedFor()) watch(0);
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
  post({ type: 'watch', run });
}

/** Thinned together with the recording, few of what came live are among the points: a past as it was heard has its own. */
const askedLive = new WeakSet<RunStore>();
/** What came thinned is asked for again: while the run goes on only what is drawn, for the archive has work to do. */
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
        void learnAccess().catch(() => undefined); // a session that ended closes the stream
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
      if (inDoubt.peek()) void refreshRuns(); // it may be the run that is shown of which the server knows nothing
      notify(message.reason);
      break;
    case 'trouble':
      notify(message.words);
      break;
  }
}

const LEFT = 'aeolis-left'; // what is said once the page has begun anew

/**
 * The server has an archive in which what is shown never was. Everything here is of the old one, down to the dictionary: the page begins
 * anew, and goes to the run that goes on.
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
  url.searchParams.delete('run');
  history.replaceState(null, '', url);
  location.reload();
}

function takeRun(run: RunState | undefined): void {
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
    const drawn = new Set(plottedChannels().map((name) => dictionary.value?.pick([name])?.id));
    inDoubt.value = false;
    store.value = new RunStore(run, (channel) => drawn.has(channel));
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
    failed = true; // The timeline says that it has no plan; the next round asks again.
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
    const isOther = (run: RunState) => all.some((each) => each.run === run.run && !isSameRun(each, run));
    if (before.some(isOther) || (shown && shown === store.value && !all.some((each) => each.run === shown.run.run)))
      return takeOtherArchive();
    if (doubted && shown) inDoubt.value = false; // it is among them
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

/** Its schema takes as long to load as a picture to draw: it starts once the first look is on its way to the screen. */
function startWorker(): void {
  const worker = new Worker(new URL('../stream/worker.ts', import.meta.url), { type: 'module' });
  worker.onmessage = (event: MessageEvent<FromWorker>) => onMessage(event.data);
  worker.onerror = (event) => notify(`the stream's worker failed: ${event.message}`);
  sendBy(worker);
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
    : runs.value.some(isGoing)
      ? 0
      : Number(runs.value[0]?.run ?? 0);
  if (wanted > 0 && chosen !== wanted)
    notify(
      `Run ${wanted} is not in this archive; what is shown is ${chosen === 0 ? 'the run that goes on' : chosen > 0 ? `run ${chosen}` : 'nothing'}.`,
    );
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
    (list) => (scenarios.value = list.scenarios),
    () => undefined,
  );
  let wasIn = true;
  effect(() => {
    const isIn = access.value.state !== 'out';
    if (isIn && !wasIn) post({ type: 'reconnect' });
    wasIn = isIn;
  });
  effect(() => {
    const run = store.value;
    if (run && stream.value.state === 'lost') askedLive.delete(run); // what was asked gets no answer any more
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
  void everySeconds(1, refreshAgainst);
  void everySeconds(TIMELINE_LOOK_S, async () => {
    const run = store.value;
    if (run && timelinePace.isDue(run, timelineQuestion.peek().text, performance.now())) await refreshTimepoints();
  });
  void everySeconds(5, async () => {
    if (store.value?.thinnedSinceHistory && stream.value.state === 'live') refreshHistory(store.value);
  });
}

/** For tests of views: a page without a worker, or with one that only `hears`; what it would say is given to onMessage. */
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
