// SPDX-License-Identifier: Apache-2.0
// The plan with which a rehearsal is to start: none, one that the server offers, or a file of the instructor's own.
import { signal } from '@preact/signals';
import { call, wordsFor } from '../run/api';
import type { Fault } from './instructor';

/** A plan on offer (schema/aeolis/v1/plan.proto). */
export interface PlanEntry {
  name: string;
  title: string;
  purpose: string;
  scenario: string; // for which it was written; empty: any
  injects: number;
}

/** An inject of the library, by hand or by a plan. */
export interface LibraryInject {
  name: string;
  title: string;
  does: string; // the fault in words
  shows: string;
  team: string[];
  fault: Fault;
}

const PLAN_OCTETS_MAX = 256 * 1024; // the server's limit

export const NONE = '';
export const OWN = '/'; // no name of a file

export const offered = signal<readonly PlanEntry[]>([]);
export const library = signal<readonly LibraryInject[]>([]);
export const offerProblem = signal('');
/** NONE, OWN, or the name of an offered plan. */
export const choice = signal<string>(NONE);
export const ownPlan = signal<{ name: string; text: string } | { problem: string } | undefined>(undefined);

export async function askPlans(): Promise<void> {
  try {
    const list = await call<{ plans: PlanEntry[]; library: LibraryInject[] }>('GET', '/plans');
    offered.value = list.plans;
    library.value = list.library;
    offerProblem.value = '';
  } catch (error) {
    offerProblem.value = wordsFor(error);
  }
}

export async function takeFile(file: File | undefined): Promise<void> {
  if (!file) return;
  if (file.size > PLAN_OCTETS_MAX) {
    ownPlan.value = { problem: `${file.name} has ${file.size} octets; a plan has at most ${PLAN_OCTETS_MAX}` };
    return;
  }
  if (file.size === 0) {
    ownPlan.value = { problem: `${file.name} is empty` }; // an empty text would start without a plan
    return;
  }
  try {
    ownPlan.value = { name: file.name, text: await file.text() };
  } catch {
    ownPlan.value = { problem: `${file.name} cannot be read` };
  }
}

export const chosenEntry = (): PlanEntry | undefined => offered.value.find((each) => each.name === choice.value);

/** "written for nominal", if a plan was written for another scenario. */
export const writtenFor = ({ scenario }: PlanEntry, chosen: string): string =>
  scenario === '' || scenario === chosen ? '' : `written for ${scenario}`;

/** Why no rehearsal can start with the choice; empty: one can. */
export function whyNotPlan(): string {
  if (choice.value !== OWN) return '';
  if (!ownPlan.value) return 'choose the file of the plan';
  return 'problem' in ownPlan.value ? ownPlan.value.problem : '';
}

/** The choice in the words of the order to start. */
export function planOrder(): { plan?: string; inline_plan?: string } {
  if (choice.value === NONE) return {};
  if (choice.value !== OWN) return { plan: choice.value };
  return ownPlan.value && 'text' in ownPlan.value ? { inline_plan: ownPlan.value.text } : {};
}

/** Forgets the choice. The people rehearsed may look at the same screen. */
export function forgetPlan(): void {
  choice.value = NONE;
  ownPlan.value = undefined;
}
