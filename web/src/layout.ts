// SPDX-License-Identifier: Apache-2.0
// The default layout: the one place that knows names of a mission. Each pick is a list of names in order of preference;
// where the dictionary has none of them, the panel does without or takes the first channels there are.

export const LAYOUT = {
  phase: ['edl_phase'],
  altitude: ['altitude_m'],
  speed: ['speed_mps'],
  nextDesired: ['next_desired_sclk'],
  nextMinimum: ['next_minimum_sclk'],
  currentTimepoint: ['timepoint_index'],
  timepointState: ['timepoint_state'],

  /** Plots, from the top. `per` scales the dictionary's unit to the one shown. */
  plots: [
    { title: 'Altitude', channel: ['altitude_m'], unit: 'km', per: 1000, digits: 2 },
    { title: 'Speed', channel: ['speed_mps'], unit: 'm/s', per: 1, digits: 1 },
    { title: 'Deceleration', channel: ['sensed_deceleration_g', 'drag_mps2'], unit: undefined, per: 1, digits: 2 },
    { title: 'Bank', channel: ['bank_deg'], unit: 'deg', per: 1, digits: 1 },
  ],

  /**
   * The strip of phases, which values of the phase channel belong to each, and when it is predicted to begin: entry by
   * definition, the others published [od137]. `untilEntry`: belongs to it only before entry, then to the next. `from`: the
   * timepoint with which it begins, for when only tones tell.
   */
  phases: [
    {
      title: 'Cruise',
      of: ['pre_edl', 'late_cruise', 'exo_atmospheric'],
      untilEntry: 'wait_for_guidance',
      predicted_e_s: undefined,
      from: undefined,
      plain:
        'The vehicle coasts towards Mars. It drops its cruise stage and turns the heat shield forward. From “do edl” on it follows its own timeline.',
    },
    {
      title: 'Entry',
      of: ['wait_for_guidance', 'range_control', 'heading_alignment', 'straighten_up', 'wait_for_parachute'],
      untilEntry: undefined,
      predicted_e_s: 0,
      from: 'entry_interface',
      plain:
        'It brakes in the thin air, from 5.8 km/s, and steers by rolling left and right. Around the hottest minute the radio is silent: that is expected, and the timeline names it.',
    },
    {
      title: 'Parachute',
      of: ['parachute_descent'],
      untilEntry: undefined,
      predicted_e_s: 255.9,
      from: 'parachute_deploy',
      plain: 'The parachute is open. The heat shield drops away, and the radar looks for the ground.',
    },
    {
      title: 'Powered descent',
      of: ['powered_descent', 'sky_crane'],
      untilEntry: undefined,
      predicted_e_s: 378.2,
      from: 'powered_approach',
      plain:
        'It let go of parachute and shell and brakes with eight engines. Twenty metres up, it lets the rover down on a bridle.',
    },
    {
      title: 'Landed',
      of: ['landed', 'flyaway'],
      untilEntry: undefined,
      predicted_e_s: 431.5,
      from: 'touchdown',
      plain:
        'The rover is on the ground, the descent stage has flown away. Now the recording comes down: all that could not be heard live.',
    },
  ],
  /** The mission whose landing the predicted corridor and phases are of. */
  predictedFor: 'MSL',
  /** Left out of a timepoint's note where it is read as a sentence: marks of whose a number is, (H), (M) and (L), and the prediction, which has a lane. */
  noteMarks: [/\s*\([^()]*\b[HML]\b[^()]*\)/g, /;\s*OD137 .*$/],
  /**
   * What the vehicle compares for a timepoint or moment: shown until flight itself explains what holds it. `bound` is a channel of its
   * own report, or a parameter that it does not report (dictionaries/msl/parameters.csv). `since`: how long the timepoint is ago.
   */
  watches: [
    { timepoint: 'heading_alignment', channel: 'speed_mps', comparison: '<=', bound: 1100 },
    { timepoint: 'parachute_deploy', channel: 'speed_mps', comparison: '<=', bound: 'parachute_speed_mps' },
    { timepoint: 'heatshield_separation', channel: 'speed_mps', comparison: '<=', bound: 'heatshield_speed_mps' },
    { timepoint: 'heatshield_separation', since: 'parachute_deploy', bound: 20 },
  ],
  /** Shown first in the table of channels. */
  channels: [
    'edl_phase',
    'altitude_m',
    'speed_mps',
    'descent_rate_mps',
    'sensed_deceleration_g',
    'bank_deg',
    'bank_command_deg',
    'range_to_go_m',
    'crossrange_m',
    'mach',
    'dynamic_pressure_Pa',
    'radar_altitude_m',
    'propellant_kg',
    'timepoint_index',
    'timepoint_state',
    'tone_current',
    'uhf_queue_octets',
    'nvm_used_octets',
  ],

  /** What begins a landing, in words for someone who opened the page five minutes ago. `tone` says that it was taken. */
  firstSteps: [
    {
      command: 'EDL_SET_PARAMETERS',
      words: 'set edl parameters',
      tone: 'parameters_accepted',
      why: 'tells the vehicle where it is and where to land; the form is filled from ground’s navigation solution',
    },
    {
      command: 'EDL_DO_EDL',
      words: 'do edl',
      tone: 'edl_enabled',
      why: 'starts the timeline on board; from then on the vehicle flies alone',
    },
  ],

  /** What the review of a rehearsal says of its landing: flight's own words, and where the vehicle believed to be. */
  landing: {
    event: 'TOUCHDOWN',
    position: ['nav_position_x_m', 'nav_position_y_m', 'nav_position_z_m'],
    target: { latitude_deg: 'target_latitude_deg', longitude_deg: 'target_longitude_deg', radius_m: 'target_radius_m' },
  },
  /** The timepoint at which the descent picture ends. */
  landed: 'touchdown',
  /** From then on the vehicle is two: these are of the one that flies away. */
  afterLanding: {
    whose: 'descent stage',
    channels: [
      'altitude_m',
      'speed_mps',
      'descent_rate_mps',
      'sensed_deceleration_g',
      'bank_deg',
      'bank_command_deg',
      'mach',
      'dynamic_pressure_Pa',
      'radar_altitude_m',
      'range_to_go_m',
      'crossrange_m',
    ],
  },

  /** What people call a thing, where its name is jargon; a picture has only the short form in brackets. */
  words: { sufr: 'straighten up and fly right (SUFR)', sufr_start: 'straighten up and fly right' },
  /**
   * What people wait for between timepoints, told by an event and a tone of that name. `before`: the timepoint that comes after it.
   * `predicted_e_s` is published [od137].
   */
  moments: [
    {
      name: 'peak_deceleration',
      before: 'sufr',
      predicted_e_s: 79.35,
      plain: 'The hottest and hardest half minute; flight says so once it has passed.',
    },
    {
      name: 'heading_alignment',
      before: 'sufr',
      predicted_e_s: undefined,
      plain: 'From then on it steers straight at the target.',
    },
  ],

  /** Seconds from entry that the timeline shows when nothing else is chosen. */
  window: { from: -60, to: 470 },
  /** Named moments that get a label in the timeline; the others are marks only. */
  labelled: [
    'coolant_vent',
    'cruise_stage_separation',
    'turn_to_entry',
    'entry_interface',
    'entry_guidance',
    'sufr',
    'parachute_deploy',
    'heatshield_separation',
    'radar_processing',
    'engine_priming',
    'backshell_separation',
    'powered_approach',
    'sky_crane',
    'rover_separation',
    'touchdown',
    'engines_off',
  ],
} as const;
