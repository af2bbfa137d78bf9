// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "common/time.hpp"

#include <chrono>
#include <optional>

namespace aeolis::server {

/// When the items of a run that is over go out again: so many times as fast as they reached Earth.
///
/// In       items in the order of their numbers, and what time it is     Out   when each is due
/// Rule     the first is due when it is asked for. One that bears no time on Earth has that of the one before it; one
///          that reached Earth before the one before it waits no longer than that
class ReplayPace {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr double pace_max = 10'000.0;  ///< ours: six hours of cruise in two seconds

    explicit ReplayPace(double pace) : pace_(pace) {}

    /// Asked again of the same item it says the same.
    Clock::time_point due(const v1::Item& item, Clock::time_point now);

  private:
    double pace_;
    std::optional<Clock::time_point> begun_;
    std::optional<Ert> first_, latest_;
};

}  // namespace aeolis::server
