// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/station/predicted_silences.hpp"

namespace aeolis::server {

/// Predicts the silences of a landing from the plan and the delivery, without the landing's errors.
///
/// Blackout  the scenario's nominal entry under the reference's bank, while plasma is within the radio's bounds
/// Earth     when it sets over the target, for a vehicle that descends at a constant rate under its parachute
/// Times     timepoints by the timeline's rule over predicted_anchors.csv
/// Left out  reversals, wind, and the vehicle's motion after backshell separation
/// Cost      some milliseconds
telemetry::PredictedSilences predict_silences(const simulation::Scenario& scenario,
                                              const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
