// SPDX-License-Identifier: Apache-2.0
// Procedures for tests, as the server answers; times as day-of-year texts.
import type { Execution, Step, Watchdog } from '../procedures/model';
import { ertUs } from './fixtures';

export const us = (text: string): string => String(ertUs(text));

export const aStep = (step: string, fields: Partial<Step> = {}): Step => ({
  step,
  part: 'body',
  who: 'gnc',
  text: `Do ${step}.`,
  state: 'waiting',
  acts: [],
  reason_wanted: false,
  hold: '',
  limits: '',
  conditions: [],
  choices: [],
  signatures_wanted: [],
  signatures: [],
  by: '',
  reason: '',
  next: '',
  ...fields,
});

export const aWatchdog = (watchdog: string, fields: Partial<Watchdog> = {}): Watchdog => ({
  watchdog,
  who: 'systems',
  text: `Look at ${watchdog}.`,
  conditions: [],
  begin: '',
  hold: false,
  acts: [],
  ...fields,
});

export const anExecution = (fields: Partial<Execution> = {}): Execution => ({
  number: 1,
  procedure: 'poll',
  title: 'A poll',
  revision: 1,
  approvals: [],
  part: 'body',
  over: false,
  held: '',
  begun_us: us('2012-219T04:50:00.0'),
  begun_by: 'Ann (flight_director)',
  steps: [],
  watchdogs: [],
  acts: ['hold', 'stop'],
  ...fields,
});

export const inItem = (procedure: Execution, seq = 1) => ({ seq: String(seq), procedure });
