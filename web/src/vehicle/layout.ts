// SPDX-License-Identifier: Apache-2.0
// The part of the default layout (../layout.ts) that only the vehicle and the touchdown need; loaded with them, so that
// the page's first load stays small. Like there, each pick lists names in order of preference.

/** One thing that happens to the vehicle, and every channel or timepoint that can tell of it. */
export interface Telling {
  flag?: string; // 1 once it has happened, as flight believes
  pyros?: readonly string[]; // all of them have fired
  timepoint?: string;
  verified?: boolean; // the timepoint tells only if its device has said that it is done
}

export const VEHICLE = {
  attitude: ['nav_attitude_w', 'nav_attitude_x', 'nav_attitude_y', 'nav_attitude_z'], // from B to M
  position: ['nav_position_x_m', 'nav_position_y_m', 'nav_position_z_m'], // in M
  velocity: ['nav_velocity_x_mps', 'nav_velocity_y_mps', 'nav_velocity_z_mps'], // in M
  bank: ['bank_deg'],
  mode: ['descent_mode'],
  thrust: ['engine_thrust_N', 'thrust_command_N'],
  throttles: [
    'throttle_1_percent',
    'throttle_2_percent',
    'throttle_3_percent',
    'throttle_4_percent',
    'throttle_5_percent',
    'throttle_6_percent',
    'throttle_7_percent',
    'throttle_8_percent',
  ],
  bridle: ['bridle_m'],
  propellant: ['propellant_kg'],
  descentRate: ['descent_rate_mps'],
  horizontalSpeed: ['horizontal_speed_mps'],

  /** The label of a pyro's channel once it has fired, and those by which it has not. */
  fired: 'fired',
  notFired: ['not_commanded', 'refused', 'unanswered'],
  happenings: {
    cruiseStageGone: {
      flag: 'cruise_stage_gone',
      pyros: ['pyro_cruise_stage_separation'],
      timepoint: 'cruise_stage_separation',
    },
    cruiseMass1Gone: { pyros: ['pyro_cruise_balance_1'], timepoint: 'cruise_balance_1' },
    cruiseMass2Gone: { pyros: ['pyro_cruise_balance_2'], timepoint: 'cruise_balance_2' },
    entryMasses1Gone: { pyros: ['pyro_entry_balance_1'], timepoint: 'balance_1' },
    entryMasses2Gone: { pyros: ['pyro_entry_balance_2'], timepoint: 'balance_2' },
    entryMasses3Gone: { pyros: ['pyro_entry_balance_3'], timepoint: 'balance_3' },
    parachuteOut: { flag: 'parachute_out', pyros: ['pyro_parachute_mortar'], timepoint: 'parachute_deploy' },
    heatshieldGone: {
      flag: 'heatshield_gone',
      pyros: ['pyro_heatshield_separation'],
      timepoint: 'heatshield_separation',
    },
    backshellGone: { flag: 'backshell_gone', pyros: ['pyro_backshell_separation'], timepoint: 'backshell_separation' },
    skyCrane: { flag: 'sky_crane_started', timepoint: 'sky_crane' },
    roverSeparated: { flag: 'rover_separated', pyros: ['pyro_rover_separation'], timepoint: 'rover_separation' },
    bridleGone: { flag: 'bridle_gone', pyros: ['pyro_bridle_cutter'], timepoint: 'bridle_cut' },
    flyaway: { flag: 'flyaway_started', timepoint: 'flyaway' },
    enginesOff: { timepoint: 'engines_off', verified: true }, // the flag is the order, not the deed
  } satisfies Record<string, Telling>,
} as const;

export type Happening = keyof typeof VEHICLE.happenings;

/** What still comes after a touchdown, as one link brings it. */
export const RECORDING_LINK = 'relay';
