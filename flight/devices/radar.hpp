// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the landing radar, on the 64 Hz bus.
/// In the rate group: it confirms every tick, idle or not. R5, R10, R22
///
/// In      RadarReturns (interrupt), Tick, UnitsSelected
/// Out     RadarReturns to EdlBg and EdlComm, once a cycle when there are any; Confirm
/// Faults  missing returns are detected by EdlBg, which needs them (RADAR_LOST)
class RadarManager {
  public:
    explicit RadarManager(const Load&) {}

    void on(const RadarReturns& returns, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    RadarReturns latest_;
    Unit unit_ = Unit::a;
};

}  // namespace aeolis::flight
