// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace aeolis::telemetry {

/// The cause that a link's silence is attributed to.
enum class SilenceClass : std::uint8_t {
    light_time,    ///< nothing can have arrived yet
    not_begun,     ///< the plan has yet to switch the transmitter to it
    switched_off,  ///< the plan has switched the transmitter off
    blackout,
    hand_over,        ///< between antennas of the vehicle
    no_orbiter,       ///< no bent pipe is in view
    orbiter_records,  ///< an orbiter in view delivers later
    earth_set,
    weak_carrier,
    delivered,  ///< an orbiter has delivered everything it recorded
    recording_complete,
    ground_fault,  ///< the station, or the line to it
    unexplained,   ///< not predicted: a controller should look
};
inline constexpr std::size_t silence_classes = 13;

/// Its name in the API and in the archive: "blackout", "earth_set", …
const char* name_of(SilenceClass silence);
/// As people read it: "plasma blackout", "Earth set", …
const char* title_of(SilenceClass silence);
/// Whether nothing more is expected from a link with this silence.
bool is_over(SilenceClass silence);
/// Whether a link with this silence should be up.
bool is_lost(SilenceClass silence);
/// The reason of a link's state as people read it: "plasma blackout: predicted from E+0:45 to E+1:38". Without words
/// the title alone, without a class the words alone.
std::string reason_text(std::optional<SilenceClass> silence, const std::string& words);

}  // namespace aeolis::telemetry
