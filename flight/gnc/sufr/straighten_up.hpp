// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

// Straighten up and fly right (SUFR): bank turns to lift up while the angle of attack goes to zero.
// The balance masses are jettisoned, and the angle of attack goes with them.
//
//   bank(t) = bank at start, reduced to zero at 10°/s;  done after 14.00 s
//
// In       time since its start [s], bank when it started [rad]         Out   bank to command [rad]
// Source   [facts] Timeline: lasts 14.00 s; the rate is our assumption: half of the thrusters' capability [facts]
//          Vehicle
namespace aeolis::flight::gnc::sufr {

double bank_rad(const Parameters& parameters, double since_start_s, double bank_at_start_rad);

}  // namespace aeolis::flight::gnc::sufr
