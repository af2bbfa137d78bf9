// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/station/predicted_silences.hpp"

namespace aeolis::server {

/// Predicts when ground hears nothing of a landing, from the plan and the delivery, without the landing's errors.
///
/// Blackout  the scenario's nominal entry flies under the reference's bank; plasma is within the radio's own bounds
/// Earth     sets over the target, for a vehicle that descends evenly under its parachute
/// Times     of timepoints by the timeline's rule over predicted_anchors.csv
/// Left out  reversals, wind, and what the vehicle does after the backshell
/// Cost      some milliseconds
telemetry::PredictedSilences predict_silences(const simulation::Scenario& scenario,
                                              const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
