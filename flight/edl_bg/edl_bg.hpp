// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/navigation/radar_batch.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

#include <optional>

namespace aeolis::flight {

/// EdlBg: batches radar data into averages over 5 s for the navigation filter, and takes the parameter updates for all
/// of EDL. Outside the rate group: what it sends arrives at the start of the next cycle. R25, R47
///
/// In      RadarReturns (64 Hz while the radar is on), NavigatedAttitude, SetParametersCommand, ClockTick
/// Out     RadarSolution to Edl at 1 Hz, GncRadar; ParametersUpdate to Edl, or the outcome "refused"
/// Faults  five solutions in a row that do not come, while Edl wants them, are reported once (RADAR_LOST): the averages
///         outlive the last beam by 5 s, and navigation goes on without
class EdlBg {
  public:
    explicit EdlBg(const Load&) {}

    void on(const RadarReturns& returns, Outbox& out);
    void on(const NavigatedAttitude& attitude, Outbox& out);
    void on(const SetParametersCommand& command, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);

  private:
    void watch_radar(Sclk now, Outbox& out);

    gnc::RadarBatch batch_;
    RadarReturns latest_;  ///< of this cycle; the attitude that belongs to them comes after them
    bool navigated_ = false;
    bool radar_locked_ = false;
    bool radar_lost_ = false;
    Sclk attitude_at_;  ///< Edl sends the attitude as long as it wants the radar
    Sclk solved_at_;    ///< the last solution; before the first one, when Edl began to want it
    std::uint16_t solutions_ = 0;
};

}  // namespace aeolis::flight
