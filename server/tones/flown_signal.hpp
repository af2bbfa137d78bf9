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

/// The X-band signal that a landing sends, with its Doppler and gain. Times are seconds from entry interface.
struct FlownSignal {
    std::vector<simulation::SentTone> tones;
    TimeTable doppler_hz;      ///< one way at the carrier; 16 rows a second
    TimeTable gain_db;         ///< of the antenna toward Earth, with the attitude; 16 rows a second
    double earth_set_s = 0.0;  ///< nothing is received after it
    /// An outage of the scenario whose event happened: tones sent during it may be lost.
    struct Outage {
        std::string name;
        double from_s = 0.0, to_s = 0.0;
    };
    std::vector<Outage> outages;
};

/// Flies the scenario's case with the whole flight software to its end. Doppler starts at `from_before_entry_s`, and
/// not before X-band sends tones.
FlownSignal fly_signal(simulation::Scenario scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary, double from_before_entry_s = 900.0);

}  // namespace aeolis::server
