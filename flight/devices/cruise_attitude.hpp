// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Cruise attitude control, reduced to the star scanner's attitude, from which navigation starts.
/// It ends with the cruise stage, and Second Chance's load does not contain it. R10, R33
///
/// In      CruiseAttitude (interrupt), once a second until the cruise stage goes
/// Out     CruiseAttitude to Edl
/// Faults  an invalid quaternion is dropped and reported (CRUISE_ATTITUDE_UNUSABLE): the previous one stays in use
class CruiseAttitudeControl {
  public:
    explicit CruiseAttitudeControl(const Load&) {}

    void on(const CruiseAttitude& attitude, Outbox& out);
};

}  // namespace aeolis::flight
