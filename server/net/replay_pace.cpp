// SPDX-License-Identifier: Apache-2.0
#include "server/net/replay_pace.hpp"

#include <algorithm>

namespace aeolis::server {
namespace {

constexpr double wait_max_s =
    1.0e9;  // ours: thirty years; a steady clock's time still holds it, however small the pace

/// When all of it had reached Earth; none: it does not say.
std::optional<Ert> on_earth_at(const v1::Item& item) {
    switch (item.item_case()) {
    case v1::Item::kUnit: return ert_from_day_of_year(item.unit().ert());
    case v1::Item::kEvent: return ert_from_day_of_year(item.event().ert());
    case v1::Item::kTone: return ert_from_day_of_year(item.tone().ert_end());
    case v1::Item::kLink: return ert_from_day_of_year(item.link().ert());
    case v1::Item::kStaleness: return ert_from_day_of_year(item.staleness().ert());
    case v1::Item::kCommandStage: return ert_from_day_of_year(item.command_stage().at());
    case v1::Item::kAlarmAction: return ert_from_day_of_year(item.alarm_action().at());
    case v1::Item::kNote: return ert_from_day_of_year(item.note().at());
    case v1::Item::kSamples:
    case v1::Item::kTimepoint:
    case v1::Item::kExplanation:
    case v1::Item::kAlarm:
    case v1::Item::ITEM_NOT_SET: break;
    }
    return std::nullopt;
}

}  // namespace

ReplayPace::Clock::time_point ReplayPace::due(const v1::Item& item, Clock::time_point now) {
    if (!begun_) begun_ = now;
    if (const auto at = on_earth_at(item)) {
        if (!first_) first_ = *at;
        latest_ = latest_ ? std::max(*latest_, *at) : *at;
    }
    if (!latest_) return *begun_;
    const double since_s = static_cast<double>(latest_->microseconds - first_->microseconds) * 1.0e-6;
    return *begun_ + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>{std::min(since_s / pace_, wait_max_s)});
}

}  // namespace aeolis::server
