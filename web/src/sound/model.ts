// SPDX-License-Identifier: Apache-2.0
// Whether phases, news and alarms are called out, by tones or in words. Off at first; the choice stays over reloads. What
// makes the sound is loaded once it is wanted.
import { effect, signal } from '@preact/signals';

export const SOUNDS = ['off', 'tones', 'words'] as const;
export type Sound = (typeof SOUNDS)[number];

const [KEPT, KEPT_PAST] = ['aeolis-sound', 'aeolis-sound-past'];
const kept = localStorage.getItem(KEPT);
export const sound = signal<Sound>(SOUNDS.find((each) => each === kept) ?? 'off');
/** Whether what happens now is called out also while a past is shown. */
export const overPast = signal(localStorage.getItem(KEPT_PAST) === 'yes');

/** Why a sound is not to be had in this browser; undefined: it is. */
export function whyNo(which: Sound): string | undefined {
  if (which === 'tones' && !('AudioContext' in globalThis)) return 'this browser makes no tones';
  if (which === 'words' && !('SpeechSynthesisUtterance' in globalThis)) return 'this browser does not speak';
  return undefined;
}

export function chooseSound(next: Sound): void {
  sound.value = next;
  localStorage.setItem(KEPT, next);
  void import('./calls').then(({ sample }) => sample(next));
}

export function nextSound(): void {
  const possible = SOUNDS.filter((each) => whyNo(each) === undefined);
  chooseSound(possible[(possible.indexOf(sound.value) + 1) % possible.length] ?? 'off');
}

export function toggleOverPast(): void {
  overPast.value = !overPast.value;
  localStorage.setItem(KEPT_PAST, overPast.value ? 'yes' : 'no');
}

export function listenForCalls(): void {
  effect(() => {
    if (sound.value !== 'off') void import('./calls').then(({ listen }) => listen());
  });
}
