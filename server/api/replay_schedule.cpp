// SPDX-License-Identifier: Apache-2.0
#include "server/api/replay_schedule.hpp"

#include <algorithm>

namespace aeolis::server {
namespace {

constexpr double wait_max_s = 1.0e9;  // chosen: thirty years; fits a steady clock's time at any pace

}  // namespace

ReplaySchedule::Clock::time_point ReplaySchedule::due(const v1::Item& item, Clock::time_point now) {
    if (!begun_) begun_ = now;
    const Ert at{item.ert_us()};
    if (!first_) first_ = at;
    latest_ = latest_ ? std::max(*latest_, at) : at;
    const double since_s = static_cast<double>(latest_->microseconds - first_->microseconds) * 1.0e-6;
    return *begun_ + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>{std::min(since_s / pace_, wait_max_s)});
}

}  // namespace aeolis::server
