// SPDX-License-Identifier: Apache-2.0
// The call-outs: what is new in the server's situation, the events that begin a phase, alarms that are new or have grown
// worse. Their words are the server's. What comes within a second is one call.
import { effect } from '@preact/signals';
import { fresh } from '../alarms/model';
import type { AlarmState } from '../alarms/model';
import { LAYOUT } from '../layout';
import { stream } from '../run/connection';
import { isWorst } from '../run/limits';
import { pastRange, store, tick } from '../run/shown';
import type { RunStore } from '../run/store';
import { overPast, sound, whyNo } from './model';
import type { Sound } from './model';

type Kind = 'alarm' | 'caution' | 'news';
export interface Call {
  kind: Kind;
  words: string;
}

const GATHER_MS = 1000; // chosen: a burst of alarms is told within it
const MOST_SENTENCES = 3; // chosen: more is not listened to

const PHASES: ReadonlySet<string> = new Set(LAYOUT.phases.flatMap(({ from }) => from ?? []));

/** What has come of a run since the last look at it, as calls. */
export class Listener {
  private run: RunStore | undefined;
  private event = 0;
  private said = new Set<string>();

  /** The first look at a run, and any while `isSilent`, only learns what is there. */
  look(run: RunStore | undefined, isSilent: boolean): Call[] {
    const isFirst = run !== this.run;
    this.run = run;
    if (isFirst) [this.event, this.said] = [0, new Set()];
    if (!run) return [];
    const calls: Call[] = [];
    const entries = run.situations.at(-1)?.fact.entries ?? [];
    for (const { rank, sentence } of entries) {
      if ((rank === 'danger' || rank === 'news') && !this.said.has(sentence))
        calls.push({ kind: rank === 'danger' ? 'alarm' : 'news', words: sentence });
    }
    this.said = new Set(entries.map(({ sentence }) => sentence));
    const before = this.event;
    for (const { seq, live, fact } of run.events) {
      if (seq <= before) continue;
      this.event = Math.max(this.event, seq);
      if (live && PHASES.has(fact.name.toLowerCase())) calls.push({ kind: 'news', words: fact.text || fact.name });
    }
    return isFirst || isSilent ? [] : calls;
  }
}

/** One call for alarms that are new or have grown worse. */
export function alarmCall(alarms: readonly AlarmState[]): Call | undefined {
  const [first] = alarms;
  if (!first) return undefined;
  const worst = alarms.find((alarm) => isWorst(alarm.worst)) ?? first;
  const what = `${worst.name.replaceAll('_', ' ')}, ${worst.worst}`;
  return {
    kind: isWorst(worst.worst) ? 'alarm' : 'caution',
    words: alarms.length === 1 ? `Alarm: ${what}` : `${alarms.length} alarms, the worst: ${what}`,
  };
}

/** Several calls as one: the worst kind, and as many sentences as are listened to. */
export function oneCall(calls: readonly Call[]): Call | undefined {
  if (calls.length === 0) return undefined;
  const order: readonly Kind[] = ['alarm', 'caution', 'news'];
  const sorted = [...calls].sort((one, other) => order.indexOf(one.kind) - order.indexOf(other.kind));
  const words = [...new Set(sorted.map((call) => call.words))];
  const more = words.length - MOST_SENTENCES;
  return {
    kind: sorted[0]?.kind ?? 'news',
    words: [...words.slice(0, MOST_SENTENCES), ...(more > 0 ? [`and ${more} more`] : [])].join('. '),
  };
}

let audio: AudioContext | undefined;
const TONES: Record<Kind, readonly number[]> = { alarm: [880, 660, 880], caution: [523], news: [440, 587] };

function toned(kind: Kind): void {
  audio ??= new AudioContext();
  void audio.resume(); // a browser lets no page make sound before a key or a click
  for (const [i, hertz] of TONES[kind].entries()) {
    const tone = audio.createOscillator();
    const volume = audio.createGain();
    volume.gain.value = 0.15;
    tone.frequency.value = hertz;
    tone.connect(volume).connect(audio.destination);
    tone.start(audio.currentTime + i * 0.22);
    tone.stop(audio.currentTime + i * 0.22 + 0.18);
  }
}

/** "E+1:40" as it is said aloud. */
export const aloud = (words: string): string =>
  words
    .replace(
      /E([+−-])(\d+):(\d\d)/g,
      (_, sign: string, minutes: string, seconds: string) =>
        `entry ${sign === '+' ? 'plus' : 'minus'} ${minutes} ${seconds}`,
    )
    .replaceAll('_', ' ');

export function makeSound(how: Sound, call: Call): void {
  if (how === 'tones') toned(call.kind);
  if (how === 'words') {
    const utterance = new SpeechSynthesisUtterance(aloud(call.words));
    utterance.lang = 'en';
    speechSynthesis.speak(utterance);
  }
}

/** What a choice of sound sounds like. */
export function sample(how: Sound): void {
  if (how === 'off') globalThis.speechSynthesis?.cancel();
  else if (whyNo(how) === undefined) makeSound(how, { kind: 'news', words: 'Call-outs are on' });
}

/** Silent while a past is shown, unless chosen, and while what was missed is still coming. */
const isSilent = () =>
  sound.peek() === 'off' || stream.value.state !== 'live' || (pastRange.value !== undefined && !overPast.value);

let isListening = false;

export function listen(): void {
  if (isListening) return;
  isListening = true;
  const listener = new Listener();
  let gathered: Call[] = [];
  const take = (calls: readonly Call[]) => {
    if (calls.length === 0) return;
    if (gathered.length === 0)
      setTimeout(() => {
        const call = oneCall(gathered);
        gathered = [];
        if (call) makeSound(sound.peek(), call);
      }, GATHER_MS);
    gathered.push(...calls);
  };
  effect(() => {
    void tick.value;
    take(listener.look(store.value, isSilent()));
  });
  effect(() => {
    const call = alarmCall(fresh.value);
    if (call && !isSilent()) take([call]);
  });
}
