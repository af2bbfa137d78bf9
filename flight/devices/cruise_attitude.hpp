// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Cruise attitude control, as much of it as EDL needs: the attitude from the star scanner, with which navigation
/// starts. It ends with the cruise stage, and Second Chance's load has none. R10, R33
///
/// In      CruiseAttitude (interrupt), once a second until the cruise stage goes
/// Out     CruiseAttitude to Edl
/// Faults  a quaternion that is none is dropped and reported (CRUISE_ATTITUDE_UNUSABLE): the one before it stays
class CruiseAttitudeControl {
  public:
    explicit CruiseAttitudeControl(const Load&) {}

    void on(const CruiseAttitude& attitude, Outbox& out);
};

}  // namespace aeolis::flight
