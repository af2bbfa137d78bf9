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

/// Flies the scenario's case by the whole flight software, to its end. Doppler is kept from `from_before_entry_s` on.
FlownSignal fly_signal(simulation::Scenario scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary, double from_before_entry_s = 900.0);

} // namespace aeolis::server
