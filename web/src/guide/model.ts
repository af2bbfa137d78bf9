// SPDX-License-Identifier: Apache-2.0
// The guide through a first landing, from opening the page to touchdown: what to press, why, and what is happening.
import { signal } from '@preact/signals';
import { lineFocused, previewNow, step as commandStep } from '../commands/line';
import type { Step } from '../commands/model';
import { LAYOUT } from '../layout';
import { phaseSteps } from '../phases/model';
import type { TimepointRow } from '../gen/aeolis/v1/run_pb';
import { heardOf } from '../timeline/heard';
import { liveOutages } from '../timeline/model';
import { isLost } from '../run/connection';
import { cutoff, dictionary, modeNow, runNow, timepoints, withRecording } from '../run/shown';
import type { Dictionary } from '../run/dictionary';
import type { RunStore } from '../run/store';
import type { Mode } from '../mode/model';
import { mayAct, mayRehearse } from '../access/model';
import { entriesAt, isAmiss } from '../situation/model';
import { missingStep, tooLate } from '../waiting/model';
import type { Told } from '../waiting/model';
import { told as toldNow } from '../waiting/told';

const KEY = 'aeolis-guide';
export const guideShown = signal(localStorage.getItem(KEY) !== 'hidden');

export function toggleGuide(): void {
  guideShown.value = !guideShown.value;
  localStorage.setItem(KEY, guideShown.value ? 'shown' : 'hidden');
}

/** A step. `key` is shown as a key, `type` as text to type. */
export interface Press {
  key?: string;
  type?: string;
  words: string;
  /** Unseen, in its room: nothing below it moves when the focus does. */
  done?: boolean;
}
interface GuideStep {
  number: number;
  title: string;
  why: string;
  press: Press[];
  /** The part of the screen that the step is about; it is outlined. */
  wants: 'command' | 'pace' | 'nothing';
}

export const GUIDE_STEPS = 6;
const NEAR_ENTRY_S = -90; // chosen: from here on the landing is worth watching
const FAST = 20; // chosen: a faster pace flies the landing in seconds

const GO_ON: Press = { key: 'p', words: 'lets the paused rehearsal go on' };

type FirstStep = (typeof LAYOUT.firstSteps)[number];

function commandPress(step: FirstStep, at: Step, opened: boolean): Press[] {
  switch (at) {
    case 'review':
      return [
        { key: 'Enter', words: 'when you have read it: it goes on, with what is shown' },
        { key: 'Esc', words: 'goes back' },
      ];
    case 'armed':
      return [
        { type: step.command, words: 'so that nobody sends it by mistake' },
        { key: 'Enter', words: 'sends it' },
      ];
    case 'sending':
      return [{ words: 'It is on its way.' }];
    default:
      return [
        { key: '/', words: 'opens the command line', done: opened },
        { type: step.words, words: '' },
        { key: 'Enter', words: 'shows what would be sent; nothing is sent yet' },
      ];
  }
}

export function guideStep(
  run: RunStore | undefined,
  words: Dictionary,
  plan: readonly TimepointRow[],
  mode: Mode,
  at: Step,
  until: number,
  recorded = false,
  told: Told = {},
  opened = false,
): GuideStep | undefined {
  if (mode === 'range' || mode === 'replay') {
    return {
      number: GUIDE_STEPS,
      title: 'You are looking at the past',
      why: recorded
        ? 'Every panel shows what had happened by then, with what only the recording told later.'
        : 'Every panel shows what had been heard by then, and nothing later.',
      press: [
        { key: 'w', words: recorded ? 'shows what had been heard then' : 'shows it with the recording' },
        { key: 'Esc', words: 'goes back' },
      ],
      wants: 'nothing',
    };
  }
  if (!run)
    return {
      number: 1,
      title: 'Start a rehearsal',
      why: 'A simulated landing, as it would be heard on Earth.',
      press: [{ key: 's', words: 'goes to the runs; choose one and press Enter' }],
      wants: 'nothing',
    };
  if (mode === 'live') return undefined; // a real landing is not for learning
  if (mode === 'ended') return afterwards(run);

  const missing = heardOf(run, plan, until).size === 0 ? missingStep(run, words, Infinity, told.against) : undefined;
  if (missing) {
    const { step, state, evidence, against } = missing;
    const number = missing.number + 1;
    const late = tooLate(run, words, told.beginBy_e_s, until);
    if (late !== undefined) {
      return {
        number: 1,
        title: 'Too late for this run: start another',
        why: late,
        wants: 'nothing',
        press: [
          { key: 's', words: 'goes to the runs' },
          { words: `“end run ${run.id}”, pressed twice, ends this one` },
          { words: '“start a rehearsal” begins anew' },
        ],
      };
    }
    const nothing: Pick<GuideStep, 'number' | 'press' | 'wants'> = { number, press: [], wants: 'nothing' };
    if (at === 'type' && state === 'sent') {
      return {
        ...nothing,
        title: 'Sent. Waiting for the vehicle to say so',
        why: 'A command counts once the vehicle answers, not when it leaves. Its stages are in the command panel.',
      };
    }
    if (at === 'type' && state === 'on_ground') {
      return {
        ...nothing,
        wants: 'command',
        title: 'It waits on the ground',
        why: `“${step.words}” ${evidence}. In the command panel it can be released or approved, or cancelled and sent anew.`,
      };
    }
    if (at === 'type' && against) {
      return {
        ...nothing,
        title: 'Taken. Waiting for the vehicle’s status to say so',
        why: `${against.words.split(':')[0]} ${against.value}: until it changes, “${step.words}” would be refused. The status comes about once a second.`,
      };
    }
    return {
      number,
      title: missing.number === 0 ? 'Tell the vehicle where it is' : 'Let it begin',
      why: `“${step.words}” ${step.why}.`,
      press: commandPress(step, at, opened),
      wants: 'command',
    };
  }
  const phases = phaseSteps(run, words, plan, until);
  const now = phases.findIndex((phase) => phase.state === 'now');
  // What a lesson says of a good day is not said on a bad one.
  const amiss = entriesAt(run, until).some(isAmiss);
  const plain = amiss
    ? 'Not all goes as it should: the large line above says what, or its list does. What is no longer heard is old.'
    : (LAYOUT.phases.find((phase) => phase.title === phases[now]?.title)?.plain ?? 'The vehicle flies by itself.');
  const pace = run.run.pace === 0 ? Infinity : run.run.pace;
  const paused = run.run.state === 'paused';
  if (now <= 0 && run.seenE < NEAR_ENTRY_S && !amiss) {
    return {
      number: 3,
      title: 'Nothing to do until entry',
      why: plain,
      wants: pace < FAST ? 'pace' : 'nothing',
      press: paused
        ? [GO_ON]
        : pace < FAST
          ? [
              {
                key: '+',
                words: 'pressed a few times makes it faster, to 100×: the minutes before entry pass in seconds',
              },
            ]
          : [{ words: `At ${pace === Infinity ? 'this pace' : `${pace}×`} it is soon there.` }],
    };
  }
  const down = now === phases.length - 1; // nothing is left to watch
  const press: Press[] = paused
    ? [GO_ON]
    : down
      ? [
          {
            words:
              run.run.relayProgress > 0
                ? `${Math.floor(run.run.relayProgress * 100)} % of the recording is down.`
                : 'How much of the recording is down is not known.',
          },
        ]
      : pace > FAST
        ? [{ key: '−', words: 'to 10× or less, to see it happen' }]
        : amiss
          ? [{ key: 'm', words: 'lists all that matters now' }]
          : isSilent(run, until)
            ? [{ words: 'Watch the dashed ring: there it is predicted now.' }]
            : [{ words: 'Watch the dot come down the grey line, the predicted path.' }];
  return {
    number: now <= 0 ? 3 : Math.min(GUIDE_STEPS - 1, now + 2),
    title: now <= 0 && !amiss ? 'Entry is near' : (phases[Math.max(now, 0)]?.title ?? ''),
    why: plain,
    press,
    wants: !paused && !down && pace > FAST ? 'pace' : 'nothing',
  };
}

/** Whether all links are silent by which height and speed come. */
const isSilent = (run: RunStore, until: number): boolean =>
  liveOutages(run, Infinity, until).some(({ from, to }) => {
    const now_e_s = Math.min(run.seenSclk, until) - run.entrySclk;
    return from < now_e_s && now_e_s <= to;
  });

function afterwards(run: RunStore): GuideStep {
  const landed = run.run.outcome === 'touchdown';
  const [look, another] = [
    [
      { key: 'v', words: 'the verdicts' },
      { key: 'y', words: 'see it again' },
    ],
    { key: 's', words: 'start another' },
  ];
  return {
    number: GUIDE_STEPS,
    title: landed ? 'You have landed it' : 'This run is over',
    why: landed
      ? 'The recording is compared with all that was heard live, octet by octet.'
      : 'All that was known is kept, and what went wrong is among the events.',
    press: landed ? [...look, another] : [another, ...look],
    wants: 'nothing',
  };
}

export function guideNow(): GuideStep | undefined {
  const words = dictionary.value;
  if (!guideShown.value || !words) return undefined;
  const step = guideStep(
    runNow(),
    words,
    timepoints.value,
    modeNow(),
    commandStep.value,
    cutoff.value,
    withRecording.value,
    toldNow.value,
    lineFocused.value,
  );
  // Nobody is told to press what would be refused: no observer, and not while there is no connection.
  const reaches = !isLost.value || cutoff.value !== Infinity;
  const allowed = reaches && (step?.wants === 'command' ? mayAct() : modeNow() !== 'rehearsal' || mayRehearse());
  if (step && !allowed) return { ...step, press: [], wants: 'nothing' };
  const isRefused = commandStep.value === 'review' && previewNow.value?.accepted === false;
  return step && isRefused ? { ...step, press: step.press.filter(({ key }) => key !== 'Enter') } : step;
}
