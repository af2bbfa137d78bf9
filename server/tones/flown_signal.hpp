// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/links/tone_waveform.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace aeolis::server {

/// What a landing sends on X-band, and how it moves while it does. Times are seconds from entry interface.
struct FlownSignal {
    std::vector<simulation::SentTone> tones;
    TimeTable doppler_hz;      ///< one way at the carrier, 16 rows a second
    TimeTable gain_db;         ///< of the antenna towards Earth, with the attitude; likewise
    double earth_set_s = 0.0;  ///< nothing is heard after that
    /// The scenario's, of events that came: tones that are sent then may be lost.
    struct Outage {
        std::string name;
        double from_s = 0.0, to_s = 0.0;
    };
    std::vector<Outage> outages;
};

/// Flies the scenario's case by the whole flight software, to its end. Doppler is kept from `from_before_entry_s` on.
FlownSignal fly_signal(simulation::Scenario scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary, double from_before_entry_s = 900.0);

}  // namespace aeolis::server
