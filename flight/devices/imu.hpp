// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// The inertial measurement unit, on a link of its own at 200 Hz: what came since the last tick is in GNC's hands in
/// the same cycle. In the rate group: it confirms every tick, samples or not. R2, R5, R10, R22
///
/// In      ImuReadings (interrupt; 3 or 4 samples a cycle), Tick, UnitsSelected
/// Out     ImuReadings to Edl before its turn; Confirm
/// Faults  in each whole second fewer samples than 200 are reported with their number (IMU_SAMPLES_MISSING): once a
///         second at most, and not in the second in which the unit was changed
class ImuManager {
  public:
    explicit ImuManager(const Load&) {}

    void on(const ImuReadings& readings, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    void watch_rate(Sclk now, Outbox& out);

    ImuReadings latest_;
    Unit unit_ = Unit::a;
    bool whole_second_ = false;  // the second under way was counted from its start
    std::uint16_t samples_in_second_ = 0;
};

}  // namespace aeolis::flight
