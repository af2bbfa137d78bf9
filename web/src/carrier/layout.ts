// SPDX-License-Identifier: Apache-2.0
// The part of the default layout (../layout.ts) that only the carrier needs; loaded with it. Each pick lists names in
// order of preference.

export const CARRIER = {
  lock: ['carrier_lock'],
  residual: ['carrier_residual_hz'],
  sigma: ['carrier_sigma_hz'],
  rate: ['carrier_rate_hz_s'],
  level: ['carrier_cn0_dbhz'],
  lost: 'searching', // the value of the lock
} as const;

/** The packet of a spectrum, and its numbers. */
export const SPECTRUM = {
  packet: 'StationSpectrum',
  first: 'spectrum_first_hz',
  step: 'spectrum_step_hz',
  frequencies: 512,
} as const;
