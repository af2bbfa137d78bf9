// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/station/predicted_silences.hpp"

namespace aeolis::server {

/// When ground expects to hear nothing of a landing, by the plan and the delivery, with none of the errors: whoever
/// flies the landing knows the same of it. Some milliseconds.
///
/// Blackout  the scenario's nominal entry state flies under the reference's bank; plasma is where the radio's own
/// bounds are Earth     sets over the target for a vehicle that descends evenly under its parachute Times     of
/// timepoints by the timeline's rule over predicted_anchors.csv Left out  reversals, wind, what the vehicle does after
/// the backshell
telemetry::PredictedSilences predict_silences(const simulation::Scenario& scenario,
                                              const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
