// The first five minutes: what to press now, why, and what is happening, in plain words. From opening the page to landing.
import { signal } from '@preact/signals';
import { step as commandStep } from '../commands/line';
import type { Step } from '../commands/model';
import { LAYOUT } from '../layout';
import { phaseSteps } from '../phases/model';
import { cutoff, dictionary, modeNow, runNow } from '../run/session';
import type { Dictionary } from '../run/dictionary';
import type { RunStore } from '../run/store';
import type { Mode } from '../mode/model';
import { statusAgainst, stepEvidence } from '../waiting/model';

const KEY = 'aeolis-guide';
export const guideShown = signal(localStorage.getItem(KEY) !== 'hidden');

export function toggleGuide(): void {
  guideShown.value = !guideShown.value;
  localStorage.setItem(KEY, guideShown.value ? 'shown' : 'hidden');
}

/** `key` is shown as a key, `type` as what is typed. */
export interface Press {
  key?: string;
  type?: string;
  words: string;
}
export interface GuideStep {
  number: number;
  title: string;
  why: string;
  press: Press[];
  /** Which part of the screen is meant; it is outlined. */
  wants: 'command' | 'pace' | 'nothing';
}

export const GUIDE_STEPS = 6;
const NEAR_ENTRY_S = -90; // ours: from here on it is worth watching
const FAST = 20; // ours: paces above run through the landing in seconds

type FirstStep = (typeof LAYOUT.firstSteps)[number];

function commandPress(step: FirstStep, at: Step): Press[] {
  switch (at) {
    case 'review':
      return [{ key: 'Enter', words: 'when you have read it: it goes on, with what is shown' }, { key: 'Esc', words: 'goes back' }];
    case 'armed':
      return [{ type: step.command, words: 'so that nobody sends it by mistake' }, { key: 'Enter', words: 'sends it' }];
    case 'sending':
      return [{ words: 'It is on its way.' }];
    default:
      return [{ key: '/', words: 'opens the command line' }, { type: step.words, words: '' }, { key: 'Enter', words: 'shows what would be sent; nothing is sent yet' }];
  }
}

export function guideStep(run: RunStore | undefined, words: Dictionary, mode: Mode, at: Step, until: number): GuideStep | undefined {
  if (mode === 'range' || mode === 'replay') {
    return { number: GUIDE_STEPS, title: 'You are looking at the past', why: 'Every panel shows what was known then, and nothing later.', press: [{ key: 'Esc', words: 'goes back' }], wants: 'nothing' };
  }
  if (!run) return { number: 1, title: 'Start a rehearsal', why: 'A simulated landing, as it would be heard on Earth.', press: [{ key: 's', words: 'goes to the runs; choose one and press Enter' }], wants: 'nothing' };
  if (mode === 'live') return undefined; // the real thing is not where one learns
  if (mode === 'ended') return afterwards(run);

  const missing = LAYOUT.firstSteps.findIndex((each) => stepEvidence(run, each) === undefined && words.command(each.command));
  const step = LAYOUT.firstSteps[missing];
  if (step && run.firings.size === 0) {
    const sent = [...run.commands.values()].some((row) => row.name === step.command);
    if (sent && at === 'type') {
      return { number: missing + 1, title: 'Sent. Waiting for the vehicle to say so', why: 'A command counts once the vehicle answers, not when it leaves. Its stages are in the command panel.', press: [], wants: 'nothing' };
    }
    const against = missing > 0 && at === 'type' ? statusAgainst(run, words, step) : undefined;
    if (against) {
      return {
        number: missing + 1, title: 'Taken. Waiting for the vehicle’s status to say so', wants: 'nothing', press: [],
        why: `${against.value}: until it changes, “${step.words}” would be refused. The status comes about once a second.`,
      };
    }
    return {
      number: missing + 1, title: missing === 0 ? 'Tell the vehicle where it is' : 'Let it begin', why: `“${step.words}” ${step.why}.`,
      press: commandPress(step, at), wants: 'command',
    };
  }
  const phases = phaseSteps(run, words, until);
  const now = phases.findIndex((phase) => phase.state === 'now');
  const plain = LAYOUT.phases.find((phase) => phase.title === phases[now]?.title)?.plain ?? 'The vehicle flies by itself.';
  const pace = run.run.pace === 0 ? Infinity : run.run.pace;
  const paused = run.run.state === 'paused';
  if (now <= 0 && run.seenE < NEAR_ENTRY_S) {
    return {
      number: 3, title: 'Nothing to do until entry', why: plain, wants: pace < FAST ? 'pace' : 'nothing',
      press: paused ? [{ key: 'p', words: 'goes on' }]
        : pace < FAST ? [{ key: '+', words: 'a few times, to 100×: the minutes before entry pass in seconds' }] : [{ words: `At ${pace === Infinity ? 'this pace' : `${pace}×`} it is soon there.` }],
    };
  }
  const down = now === phases.length - 1; // nothing is left to be watched
  const press: Press[] = paused ? [{ key: 'p', words: 'goes on' }]
    : down ? [{ words: `${Math.round(run.run.relayProgress * 100)} % of the recording is down.` }]
    : pace > FAST ? [{ key: '−', words: 'to 10× or less, to see it happen' }] : [{ words: 'Watch the dot: it should stay inside the grey corridor.' }];
  return { number: now <= 0 ? 3 : Math.min(GUIDE_STEPS - 1, now + 2), title: now <= 0 ? 'Entry is near' : phases[now]?.title ?? '', why: plain, press, wants: !paused && !down && pace > FAST ? 'pace' : 'nothing' };
}

function afterwards(run: RunStore): GuideStep {
  const landed = run.run.outcome === 'touchdown';
  return {
    number: GUIDE_STEPS,
    title: landed ? 'You have landed it' : 'This run is over',
    why: landed ? 'The recording is compared with all that was heard live, octet by octet.' : 'All that was known is kept, and what went wrong is among the events.',
    press: [{ key: 'v', words: 'the verdicts' }, { key: 'y', words: 'see it again' }, { key: 's', words: 'start another' }],
    wants: 'nothing',
  };
}

export function guideNow(): GuideStep | undefined {
  const words = dictionary.value;
  if (!guideShown.value || !words) return undefined;
  return guideStep(runNow(), words, modeNow(), commandStep.value, cutoff.value);
}
