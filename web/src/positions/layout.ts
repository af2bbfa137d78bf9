// SPDX-License-Identifier: Apache-2.0
// What the places of the grid show for a position, in the words of an address: as the mission's rooms divide the work.
export const POSITION_VIEWS: Readonly<Record<string, string>> = {
  flight_director: 'data=procedures&middle=alarms',
  command: 'data=procedures&low=links',
  edl_communications: 'data=links&middle=tones&low=packets',
  gnc: 'low=vehicle&channels=altitude_m+radar_altitude_m,speed_mps+descent_rate_mps,bank_deg+bank_command_deg,range_to_go_m+crossrange_m',
  navigation:
    'data=flown&channels=residual_position_m,residual_altitude_m,residual_speed_mps,altitude_m+shadow_altitude_m',
  relay_and_station: 'data=links&low=packets',
  systems: 'data=alarms&low=channels&channels=propellant_kg,mass_estimate_kg',
  instructor: 'data=rehearsal&low=procedures',
};
