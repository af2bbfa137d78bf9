// SPDX-License-Identifier: Apache-2.0
// The names of the console's panels, as in their address.
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
  'vehicle',
  'users',
];
