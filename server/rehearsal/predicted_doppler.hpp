// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mfsk_waveform.hpp"
#include "common/time_table.hpp"
#include "simulation/scenario.hpp"

#include <vector>

namespace aeolis::server {

/// Ground's prediction of a landing: its Doppler, and when lift changes sides in reversals of the bank, in seconds from
/// the scenario's entry.
struct PredictedFlight {
    TimeTable doppler_hz;
    std::vector<double> reversals_s;
};

/// Ground's predict of a landing's Doppler, against seconds from the scenario's entry: one way at the carrier [Hz],
/// from the scenario's start until Earth sets. Ground knows the delivery and the plan but none of the errors, and
/// assumes that the vehicle was commanded: a point mass coasts until E−620 s, then GNC flies alone (a test venue)
/// without dispersions. Takes a quarter of a second of processor time.
PredictedFlight predicted_flight(const simulation::Scenario& scenario, const MfskWaveform& waveform);
TimeTable predicted_doppler_hz(const simulation::Scenario& scenario, const MfskWaveform& waveform);

}  // namespace aeolis::server
