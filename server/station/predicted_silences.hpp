// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"

#include <optional>
#include <vector>

namespace aeolis::server {

/// When ground expects to hear nothing of a landing, before it flies: times in seconds from the entry that was
/// predicted, at the vehicle. By the plan and the delivery, with none of the errors: whoever flies the landing knows
/// the same of it.
///
/// Blackout  the scenario's nominal entry state flies under the reference's bank; plasma is where the radio's own
/// bounds are Earth     sets over the target for a vehicle that descends evenly under its parachute Times     of
/// timepoints by the timeline's rule over predicted_anchors.csv Left out  reversals, wind, what the vehicle does after
/// the backshell
struct PredictedSilences {
    struct Window {
        double from_s = 0.0, to_s = 0.0;
    };
    std::optional<Window> blackout;             ///< of UHF
    std::optional<double> hand_over_s;          ///< to the antenna of the parachute
    std::optional<double> uhf_stop_s;           ///< when the plan switches the transmitter off
    std::optional<double> earth_set_s;          ///< none: not while it lands
    bool carrier_weak = false;                  ///< too weak for a lock however the antenna points
    std::vector<simulation::RelayPass> passes;  ///< none: an orbiter is always in view
    double light_time_s = 0.0;
};

/// Some milliseconds.
PredictedSilences predict_silences(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
