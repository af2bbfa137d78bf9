// SPDX-License-Identifier: Apache-2.0
#include "telemetry/staleness.hpp"

#include "telemetry/port.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::telemetry {
namespace {

double seconds_between(Ert from, Ert to) {
    return static_cast<double>(to.microseconds - from.microseconds) * 1e-6;
}

bool brings_packets(std::string_view link) {
    return link.starts_with("uhf") || is_live_telemetry(link);
}

}  // namespace

StalenessMonitor::StalenessMonitor(const dictionary::Dictionary& dictionary) {
    for (std::size_t i = 0; i < dictionary.packets.size(); ++i) {
        const auto& packet = dictionary.packets[i];
        if (!packet.expected_rate_hz || *packet.expected_rate_hz <= 0.0) continue;
        Expected expected{i, {1.0 / *packet.expected_rate_hz}};
        const auto named = [&](const dictionary::TelemetryPlanRow& row) { return row.packet == packet.name; };
        const auto row = std::ranges::find_if(dictionary.telemetry_plan, named);
        if (row == dictionary.telemetry_plan.end() && !dictionary.telemetry_plan.empty()) continue;
        if (row != dictionary.telemetry_plan.end()) {
            if (row->plan != "all") continue;  // ground does not know which plan is flown
            expected.interval_s.clear();
            for (const std::uint32_t every : row->every)
                expected.interval_s.push_back(every / *packet.expected_rate_hz);
        }
        expected_.push_back(std::move(expected));
    }
}

double StalenessMonitor::interval_s(const Expected& expected) const {
    if (expected.interval_s.size() == 1) return expected.interval_s.front();
    return state_ ? expected.interval_s[*state_] : 0.0;
}

double StalenessMonitor::reckon(const Expected& expected, Ert ert) {
    const double interval = interval_s(expected);
    if (expected.last && !expected.stale && interval > 0.0) {
        const double remembered = std::exp(-seconds_between(reckoned_, ert) / stale_memory_s);
        reckoned_ = ert;
        due_ = due_ * remembered + seconds_between(expected.since, ert) / interval;
        came_ = came_ * remembered + 1.0;
    }
    if (came_ >= due_) return stale_intervals;
    const double lost = std::min(1.0 - came_ / due_, 0.99);
    return std::clamp(std::log(stale_chance) / std::log(lost), stale_intervals, stale_intervals_max);
}

void StalenessMonitor::clear(Expected& expected, const std::string& reason, Ert now,
                             std::vector<StalenessChange>& out) const {
    if (!std::exchange(expected.stale, false)) return;
    out.push_back({expected.packet, false, seconds_between(*expected.last, now), 0.0, reason});
}

std::string StalenessMonitor::lost_for() const {
    if (best_ != LinkIs::lost) return {};
    const auto lost = std::ranges::find_if(links_, [](const auto& each) { return each.second.is == LinkIs::lost; });
    return "the link is lost: " + lost->second.reason;
}

void StalenessMonitor::heard(std::size_t packet, Ert ert, std::vector<StalenessChange>& out) {
    const auto found = std::ranges::find(expected_, packet, &Expected::packet);
    if (found == expected_.end()) return;
    found->intervals = reckon(*found, ert);
    clear(*found, "heard again", ert, out);
    found->last = found->since = ert;
}

void StalenessMonitor::link(std::string_view name, LinkIs is, std::string_view reason, Ert ert,
                            std::vector<StalenessChange>& out) {
    if (!brings_packets(name)) return;
    links_.insert_or_assign(std::string(name), Link{is, std::string(reason)});
    LinkIs best = LinkIs::down;
    for (const auto& each : links_) best = std::max(best, each.second.is);
    const LinkIs before = std::exchange(best_, best);
    if (best == before) return;
    if (before == LinkIs::up && best == LinkIs::lost) return;  // absence keeps counting from the last reception
    for (Expected& expected : expected_) {
        if (best == LinkIs::down) clear(expected, "the link is down: " + std::string(reason), ert, out);
        expected.since = ert;
    }
}

void StalenessMonitor::phase(std::string_view label, Ert ert, std::vector<StalenessChange>& out) {
    if (label == phase_) return;
    phase_ = label;
    const auto found =
        std::ranges::find(dictionary::telemetry_state_of_phase, label, [](const auto& each) { return each.first; });
    const auto state =
        found == dictionary::telemetry_state_of_phase.end() ? std::nullopt : std::optional(found->second);
    if (state == std::exchange(state_, state)) return;
    for (Expected& expected : expected_) {
        if (interval_s(expected) == 0.0) clear(expected, "not expected in " + phase_, ert, out);
        expected.since = ert;
    }
}

void StalenessMonitor::pass(Ert now, std::vector<StalenessChange>& out) {
    if (best_ == LinkIs::down) return;
    for (Expected& expected : expected_) {
        const double interval = interval_s(expected);
        if (expected.stale || !expected.last || interval == 0.0) continue;
        if (seconds_between(expected.since, now) <= std::max(expected.intervals * interval, stale_least_s)) continue;
        expected.stale = true;
        out.push_back({expected.packet, true, seconds_between(*expected.last, now), interval, lost_for()});
    }
}

}  // namespace aeolis::telemetry
