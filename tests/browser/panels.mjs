// SPDX-License-Identifier: Apache-2.0
// The panels of the console, by the names in their address.
export const PANELS = [
  'timeline',
  'descent',
  'phases',
  'tones',
  'plots',
  'events',
  'waiting',
  'commands',
  'channels',
  'alarms',
  'notes',
  'packets',
  'verdicts',
  'links',
  'flown',
  'recorded',
  'rehearsal',
  'campaigns',
  'users',
];
