// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mfsk_waveform.hpp"
#include "common/time_table.hpp"
#include "simulation/scenario.hpp"

namespace aeolis::server {

/// The Doppler that ground expects of a landing, by seconds from the scenario's entry: one way at the carrier [Hz],
/// from the scenario's start until Earth sets. Ground knows the delivery and the plan, none of the errors, and takes it
/// that the vehicle was commanded: before E−700 s a point mass coasts, then GNC flies alone (a test venue) without any
/// dispersion. A quarter of a second of processor.
TimeTable predicted_doppler_hz(const simulation::Scenario& scenario, const MfskWaveform& waveform);

}  // namespace aeolis::server
