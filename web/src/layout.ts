// SPDX-License-Identifier: Apache-2.0
// The default layout. With vehicle/layout.ts, carrier/layout.ts and positions/layout.ts, which are loaded with their
// panels, it is all that knows names of a mission. Each pick lists names in order of preference. If the dictionary has
// none of them, the panel does without or takes the first channels.

export const LAYOUT = {
  phase: ['edl_phase'],
  altitude: ['altitude_m'],
  speed: ['speed_mps'],
  nextDesired: ['next_desired_sclk'],
  nextMinimum: ['next_minimum_sclk'],
  currentTimepoint: ['timepoint_index'],
  timepointState: ['timepoint_state'],
  /** The event that ground makes when Doppler shows a feature of the flight. */
  seenByDoppler: 'SEEN_BY_DOPPLER',

  /**
   * Plots from top to bottom. `per` converts the dictionary's unit to the displayed one. The axis is linear up to
   * `linearBelow`, in the displayed unit, and logarithmic above: for what ends far below where it began.
   */
  plots: [
    { title: 'Altitude', channel: ['altitude_m'], unit: 'km', per: 1000, digits: 2, linearBelow: 0.1 },
    { title: 'Speed', channel: ['speed_mps'], unit: 'm/s', per: 1, digits: 1, linearBelow: undefined },
    {
      title: 'Deceleration',
      channel: ['sensed_deceleration_g', 'drag_mps2'],
      unit: undefined,
      per: 1,
      digits: 2,
      linearBelow: undefined,
    },
    { title: 'Bank', channel: ['bank_deg'], unit: 'deg', per: 1, digits: 1, linearBelow: undefined },
  ],

  /**
   * The strip of phases: the values of the phase channel that belong to each. `untilEntry`: a value that belongs to this
   * phase before entry and to the next one after it. `from`: the timepoint that begins the phase: for its prediction, and
   * for when only tones are heard.
   */
  phases: [
    {
      title: 'Cruise',
      of: ['pre_edl', 'late_cruise', 'edl_approach', 'edl_main', 'exo_atmospheric'],
      untilEntry: 'wait_for_guidance',
      from: undefined,
      plain:
        'The vehicle coasts towards Mars. It drops its cruise stage and turns the heat shield forward. From “do edl” on it follows its own timeline.',
    },
    {
      title: 'Entry',
      of: ['wait_for_guidance', 'range_control', 'heading_alignment', 'straighten_up', 'wait_for_parachute'],
      untilEntry: undefined,
      from: 'entry_interface',
      plain:
        'It brakes in the thin air, from 5.8 km/s, and steers by rolling left and right. Around the hottest minute the radio is silent: that is expected, and the timeline names it.',
    },
    {
      title: 'Parachute',
      of: ['parachute_descent'],
      untilEntry: undefined,
      from: 'parachute_deploy',
      plain: 'The parachute is open. The heat shield drops away, and the radar looks for the ground.',
    },
    {
      title: 'Powered descent',
      of: ['powered_descent', 'sky_crane'],
      untilEntry: undefined,
      from: 'powered_approach',
      plain:
        'It let go of parachute and shell and brakes with eight engines. Twenty metres up, it lets the rover down on a bridle.',
    },
    {
      title: 'Touchdown',
      of: ['landed', 'flyaway'],
      untilEntry: undefined,
      from: 'touchdown',
      plain:
        'The vehicle has reported touchdown, and the descent stage flies away. Then the recording comes down: all that could not be heard live.',
    },
  ],
  /**
   * Parts of a timepoint's note that are left out of sentences: marks of a number's quality, (H), (M) and (L), the
   * prediction, which has its own lane, whose choice a number is, and why the timeline can be held there.
   */
  noteMarks: [
    /\s*\([^()]*\b[HML]\b[^()]*\)/g,
    /^OD137\b.*$|[;:]\s*OD137 .*$/,
    /^chosen\b:?\s*|(^|[;,.]?\s+)(time |spacing )?chosen\b/gi,
    /\s*Held for it: .*$|^Design time\b.*$/,
  ],
  /**
   * The comparison that the vehicle makes for a timepoint, shown until flight itself explains what holds it. `bound` is
   * a channel of its report.
   */
  watches: [
    { timepoint: 'parachute_deploy', channel: 'speed_mps', comparison: '<=', bound: 'parachute_speed_mps' },
    { timepoint: 'heatshield_separation', channel: 'speed_mps', comparison: '<=', bound: 'heatshield_speed_mps' },
  ],
  /** Arguments of commands that number a row of the timeline. */
  numbered: [
    { argument: 'timepoint', of: 'timepoint' },
    { argument: 'anchor', of: 'anchor' },
  ],
  /** The first rows of the table of channels. */
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

  /** The commands that begin a landing, in words for a newcomer. `tone` reports that the command was accepted. */
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

  /** The landing's target, by arguments of the ground's solution. */
  landing: {
    target: { latitude_deg: 'target_latitude_deg', longitude_deg: 'target_longitude_deg', radius_m: 'target_radius_m' },
  },
  /** The timepoint at which the descent picture ends. */
  landed: 'touchdown',
  /** After touchdown the vehicle is two parts; these channels belong to the one that flies away. */
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

  /** Common words for jargon. A picture shows only the short form in brackets. */
  words: {
    sufr: 'straighten up and fly right (SUFR)',
    sufr_start: 'straighten up and fly right',
    x_band_tones: 'X-band tones',
    uhf_start: 'UHF start',
    uhf_stop: 'UHF stop',
  },
  /** What a name of the vehicle's own reports is elsewhere, so that nobody takes them for two things. */
  alsoCalled: { name: 'Second Chance', is: 'backup computer' },
  /**
   * Moments between timepoints that people wait for, each announced by an event and a tone of that name. `before`: the
   * next timepoint.
   */
  moments: [
    { name: 'peak_deceleration', before: 'sufr' },
    { name: 'heading_alignment', before: 'sufr' },
  ],

  /** Seconds from entry that the timeline shows by default. */
  window: { from: -60, to: 470 },
  /** Timepoints with a label in the timeline; the others have marks only. */
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
