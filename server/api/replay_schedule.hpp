// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "common/time.hpp"

#include <chrono>
#include <optional>

namespace aeolis::server {

/// Computes when a finished run's items are sent again, at a multiple of their pace to Earth.
///
/// In       items in the order of their numbers, and the present time     Out   when each is due
/// Rule     the first is due at once. An item without a time on Earth takes that of its predecessor; one that reached
///          Earth before its predecessor is due with it
class ReplaySchedule {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr double pace_max = 10'000.0;  ///< chosen: six hours of cruise in two seconds

    explicit ReplaySchedule(double pace) : pace_(pace) {}

    /// When `item` is due. Repeated calls for one item give the same result.
    Clock::time_point due(const v1::Item& item, Clock::time_point now);

  private:
    double pace_;
    std::optional<Clock::time_point> begun_;
    std::optional<Ert> first_, latest_;
};

}  // namespace aeolis::server
