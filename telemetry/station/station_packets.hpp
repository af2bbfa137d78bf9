// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/port.hpp"
#include "telemetry/station/received.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

// What a station measures, as packets that ground makes itself and keeps like those of the vehicle: SpaceSystem
// "Station" of the dictionary.
namespace aeolis::telemetry {

/// The packet "StationCarrier". Its values are undefined when the carrier was not heard.
///
/// @param sent   when the middle of the estimate's eighth of a second left the vehicle
/// @param count  of this packet in its run
std::vector<std::uint8_t> station_carrier_packet(const ReceivedCarrier& carrier, Sclk sent, std::uint16_t count,
                                                 std::uint16_t dictionary_id);

/// The packet "StationSpectrum".
///
/// @param sent   when the middle of its second left the vehicle
/// @param count  of this packet in its run
std::vector<std::uint8_t> station_spectrum_packet(const ReceivedSpectrum& spectrum, Sclk sent, std::uint16_t count,
                                                  std::uint16_t dictionary_id);

inline constexpr std::string_view seen_by_doppler_name = "SEEN_BY_DOPPLER";

/// The event report "SEEN_BY_DOPPLER".
///
/// @param id     of that event
/// @param sent   when the feature left the vehicle
/// @param entry  as predicted
/// @param count  of event reports of the station in their run
std::vector<std::uint8_t> seen_by_doppler_packet(const SeenByDoppler& seen, EvrId id, Sclk sent, Sclk entry,
                                                 std::uint16_t count, std::uint16_t dictionary_id);

}  // namespace aeolis::telemetry
