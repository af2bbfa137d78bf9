// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <algorithm>
#include <cstdint>

namespace aeolis::commands {

/// How fast commands leave that may wait, so that the vehicle's downlink carries the answers of all.
///
/// Rule     `at_once` leave without a pause; after that, as many as have their answers carried by half of the downlink.
///          Hazardous commands neither wait for it nor count
/// Reason   a command is answered by three events. Of events of one priority that find no room on board the oldest are
///          dropped, so a flood of answers would push out those of the command that matters
class ReleasePace {
  public:
    static constexpr double at_once = 8.0;  ///< as many as the vehicle's receiver holds
    /// Chosen: received, accepted and executed, at most 64 octets each with their part of a frame.
    static constexpr double answer_octets = 3.0 * 64.0;
    static constexpr double downlink_share = 0.5;  ///< chosen: the other half is for all else that is told

    explicit ReleasePace(double downlink_bps) : each_second_(downlink_bps / 8.0 * downlink_share / answer_octets) {}

    /// Whether a command that may wait can leave now.
    bool has_room(Ert now) {
        left_ = std::min(at_once,
                         left_ + static_cast<double>(std::max<std::int64_t>(0, now.microseconds - at_.microseconds)) /
                                     1.0e6 * each_second_);
        at_ = now;
        return left_ >= 1.0;
    }
    /// Counts a command that leaves; there must be room.
    void count() { left_ -= 1.0; }

  private:
    double each_second_;
    double left_ = at_once;
    Ert at_{};
};

}  // namespace aeolis::commands
