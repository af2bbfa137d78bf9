// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// Silences that ground predicts before the flight. Times are seconds from the predicted entry, at the vehicle. Empty:
/// none.
struct PredictedSilences {
    struct Window {
        double from_s = 0.0, to_s = 0.0;
    };
    struct OrbiterPass {
        std::string orbiter;
        double rise_s = 0.0, set_s = 0.0, delivery_s = 0.0;
        bool stored = false;  ///< it records, and delivers from delivery_s on
    };
    std::optional<Window> blackout;     ///< of UHF
    std::optional<double> hand_over_s;  ///< to the parachute antenna
    std::optional<double> uhf_start_s;  ///< the plan switches the transmitter on; none: before the run
    std::optional<double> uhf_stop_s;   ///< and off
    /// When X-band changes from telemetry to tones; none: it sends tones throughout.
    std::optional<double> x_band_tones_s;
    std::optional<double> earth_set_s;  ///< none: not during the landing
    bool carrier_weak = false;          ///< too weak for a lock in any attitude
    std::vector<OrbiterPass> passes;    ///< none: an orbiter is always in view
    double light_time_s = 0.0;
};

}  // namespace aeolis::telemetry
