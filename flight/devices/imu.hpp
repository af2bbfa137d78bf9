// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the inertial measurement units. GNC flies by that of the descent stage, which has its own link at 200 Hz;
/// the rover's own is read over the 8 Hz bus, for ground alone. R2, R5, R10, R22
/// Samples received since the last tick reach GNC in the same cycle. In the rate group: it confirms every tick, with
/// samples or without.
///
/// In      ImuReadings (interrupt; 3 or 4 samples a cycle), RoverImuReading (interrupt), Tick, UnitsSelected
/// Out     ImuReadings to Edl before Edl's turn, and to EdlComm; Confirm; RoverImu, of the first reading in each second
/// Faults  fewer than 200 samples in a whole second are reported with their number (IMU_SAMPLES_MISSING), except in the
///         second in which the unit changed. A rover's unit that is silent is told by its packet, which does not come
class ImuManager {
  public:
    explicit ImuManager(const Load&) {}

    void on(const ImuReadings& readings, Outbox& out);
    void on(const RoverImuReading& reading, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    void watch_rate(Sclk now, Outbox& out);

    ImuReadings latest_;
    Unit unit_ = Unit::a;
    bool whole_second_ = false;  // the current second was counted from its start
    std::uint16_t samples_in_second_ = 0;
    std::optional<Sclk> rover_told_;  // the second of the last RoverImu
};

}  // namespace aeolis::flight
