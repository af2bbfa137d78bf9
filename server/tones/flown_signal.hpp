#pragma once

#include "common/time_table.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/links/tone_waveform.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <vector>

namespace aeolis::server {

/// What a landing sends on X-band, and how it moves while it does. Times are seconds from entry interface.
struct FlownSignal {
    std::vector<simulation::SentTone> tones;
    TimeTable doppler_hz;         ///< one way at the carrier, 16 rows a second
    double earth_set_s = 0.0;     ///< nothing is heard after that
    double parachute_s = 0.0;     ///< line stretch; 0: none
};

/// Flies the scenario's case by the whole flight software, to its end.
FlownSignal fly_signal(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary);

} // namespace aeolis::server
