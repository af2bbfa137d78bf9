// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/station/predicted_silences.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// A landing as ground expects it, in the terms of its telemetry. Times are seconds from the predicted entry.
struct NominalFlight {
    struct Event {
        std::string name;  ///< of the timepoint, or of the event report in small letters
        bool timepoint = false;
        double e_s = 0.0;
    };
    struct Sample {
        double e_s = 0.0, value = 0.0;
    };
    struct Window {
        bool pass = false;  ///< an orbiter in view; false: a silence
        std::string link, words;
        double from_s = 0.0;
        std::optional<double> to_s;  ///< none: no end is predicted
    };
    /// The ellipse about the target that the mission wants to hold 99 % of the landings. Full axes, the longer one
    /// along the course.
    struct Ellipse {
        double major_m = 0.0, minor_m = 0.0;
        double azimuth_deg = 0.0;  ///< from north to east, 0 … 180
    };
    std::string outcome;
    std::optional<Ellipse> ellipse;            ///< none: the scenario has none
    std::vector<Event> events;                 ///< by time: timepoints, and event reports that no timepoint represents
    std::vector<Window> windows;               ///< by beginning
    std::vector<std::vector<Sample>> samples;  ///< by channel: the first of each second, if it is defined
};

/// Longest time before entry from which the nominal flight is flown. Chosen: before it no timepoint of GNC fires, and
/// the flight takes some seconds of processor time.
inline constexpr double nominal_flight_before_entry_s = 1200.0;

/// The part of a scenario that ground knows before the landing: without errors, losses, faults of the vehicle, of its
/// links and of the station, and without its name. Scenarios that differ only in these are expected to go alike.
simulation::Scenario expected_scenario(simulation::Scenario scenario);

/// The ellipse that the scenario sets as its goal; none: it sets none.
std::optional<NominalFlight::Ellipse> ellipse_of(const simulation::Scenario& scenario);

/// Flies the landing of an expected scenario, commanded as planned: by the scenario's script or, without "do edl" in
/// it, by ground's parameters and "do edl". The samples are decoded from the recorded packets.
///
/// Cost     some seconds of processor time; `stop` is asked each second of flight
/// Memory   of the result: 16 octets a sample, a sample a second and channel: some megabytes
/// Errors   why nothing is predicted; an internal Error: it was stopped
Result<NominalFlight> fly_nominally(const simulation::Scenario& expected, const dictionary::Dictionary& dictionary,
                                    const std::function<bool()>& stop = {});

/// The windows of predicted silences. @param hand_over_s  time without an antenna
std::vector<NominalFlight::Window> windows_of(const telemetry::PredictedSilences& silences, double from_s,
                                              double hand_over_s);

}  // namespace aeolis::server
