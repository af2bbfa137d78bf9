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

constexpr std::string_view lost_words = "the link is lost: ";

bool brings_packets(std::string_view link) {
    return link.starts_with("uhf") || is_live_telemetry(link);
}

/// `every`: so many packets are made for one that is due.
std::optional<double> stale_after_s(const dictionary::Packet& packet, std::uint32_t every) {
    if (!packet.expected_rate_hz || *packet.expected_rate_hz <= 0.0) return {};
    return std::max(stale_intervals * every / *packet.expected_rate_hz, stale_least_s);
}

}  // namespace

StalenessMonitor::StalenessMonitor(const dictionary::Dictionary& dictionary)
    : by_rhythm_(dictionary.telemetry_plan.empty()) {
    for (std::size_t i = 0; i < dictionary.packets.size(); ++i) {
        Row& row = rows_.emplace_back(Row{.packet = i});
        const auto& packet = dictionary.packets[i];
        row.has_channels =
            std::ranges::any_of(packet.fields, [](const auto& field) { return field.channel.has_value(); });
        if (!packet.expected_rate_hz || *packet.expected_rate_hz <= 0.0) continue;
        if (by_rhythm_) {
            row.interval_s = {1.0 / *packet.expected_rate_hz};
            continue;
        }
        const auto named = [&](const dictionary::TelemetryPlanRow& each) { return each.packet == packet.name; };
        const auto planned = std::ranges::find_if(dictionary.telemetry_plan, named);
        if (planned == dictionary.telemetry_plan.end()) continue;
        if (planned->plan != "all") continue;  // ground does not know which plan is flown
        for (const std::uint32_t every : planned->every) row.interval_s.push_back(every / *packet.expected_rate_hz);
    }
}

double StalenessMonitor::interval_s(const Row& row) const {
    if (row.interval_s.empty() || row.of_ground) return 0.0;
    if (row.interval_s.size() == 1) return row.interval_s.front();
    return state_ ? row.interval_s[*state_] : 0.0;
}

double StalenessMonitor::reckon(const Row& row, Ert ert) {
    const double interval = interval_s(row);
    if (row.last && row.is != Staleness::missing && interval > 0.0) {
        const double remembered = std::exp(-seconds_between(reckoned_, ert) / stale_memory_s);
        reckoned_ = ert;
        due_ = due_ * remembered + seconds_between(row.since, ert) / interval;
        came_ = came_ * remembered + 1.0;
    }
    if (came_ >= due_) return stale_intervals;
    const double lost = std::min(1.0 - came_ / due_, 0.99);
    return std::clamp(std::log(stale_chance) / std::log(lost), stale_intervals, stale_intervals_max);
}

void StalenessMonitor::change(Row& row, Staleness to, std::string reason, Ert now,
                              std::vector<StalenessChange>& out) const {
    if (!row.last || std::exchange(row.is, to) == to) return;
    const double expected_s = to == Staleness::missing ? interval_s(row) : 0.0;
    out.push_back({row.packet, to, seconds_between(*row.last, now), expected_s, std::move(reason)});
}

std::string StalenessMonitor::silent_for() const {
    if (best_ == LinkIs::up) return {};
    if (best_ == LinkIs::down) return "the link is down: " + down_for_;
    const auto lost = std::ranges::find_if(links_, [](const auto& each) { return each.second.is == LinkIs::lost; });
    return std::string(lost_words) + lost->second.reason;
}

void StalenessMonitor::heard(std::size_t packet, Ert ert, std::vector<StalenessChange>& out) {
    Row& row = rows_.at(packet);
    if (!row.has_channels) return;
    row.intervals = reckon(row, ert);
    if (row.last) row.rhythm_s = std::max(seconds_between(*row.last, ert), rhythm_fades * row.rhythm_s);
    change(row, Staleness::current, "heard again", ert, out);
    row.last = row.since = ert;
}

void StalenessMonitor::made_on_ground(std::size_t packet, Ert ert, std::vector<StalenessChange>& out) {
    Row& row = rows_.at(packet);
    if (!row.has_channels) return;
    row.of_ground = true;
    change(row, Staleness::current, "made again", ert, out);
    row.last = row.since = ert;
}

void StalenessMonitor::link(std::string_view name, LinkIs is, std::string_view reason, Ert ert,
                            std::vector<StalenessChange>& out) {
    if (!brings_packets(name)) return;
    links_.insert_or_assign(std::string(name), Link{is, std::string(reason)});
    if (is == LinkIs::down) down_for_ = reason;
    LinkIs best = LinkIs::down;
    for (const auto& each : links_) best = std::max(best, each.second.is);
    const LinkIs before = std::exchange(best_, best);
    if (best == before) return;
    best_since_ = ert;
    if (before == LinkIs::up && best == LinkIs::lost) return;  // absence keeps counting from the last reception
    for (Row& row : rows_) {
        if (best == LinkIs::down && row.is == Staleness::missing)
            change(row, Staleness::explained, silent_for(), ert, out);
        row.since = ert;
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
    for (Row& row : rows_) {
        if (row.is == Staleness::missing && interval_s(row) == 0.0)
            change(row, Staleness::explained, "not expected in " + phase_, ert, out);
        row.since = ert;
    }
}

void StalenessMonitor::pass(Ert now, std::vector<StalenessChange>& out) {
    for (Row& row : rows_)
        if (row.last && row.is != Staleness::missing) judge(row, now, out);
}

bool StalenessMonitor::nothing_comes(double absent_s, Ert now) const {
    return std::min(absent_s, seconds_between(best_since_, now)) >= link_down_s;
}

void StalenessMonitor::judge(Row& row, Ert now, std::vector<StalenessChange>& out) const {
    const double absent_s = seconds_between(*row.last, now);
    if (row.of_ground) {
        if (absent_s > stale_least_s) change(row, Staleness::explained, "the ground makes none", now, out);
    } else if (best_ == LinkIs::down) {
        if (nothing_comes(absent_s, now)) change(row, Staleness::explained, silent_for(), now, out);
    } else if (const double interval = interval_s(row); interval > 0.0) {
        if (seconds_between(row.since, now) > std::max(row.intervals * interval, stale_least_s))
            change(row, Staleness::missing, silent_for(), now, out);
        else if (best_ == LinkIs::lost && nothing_comes(absent_s, now))
            change(row, Staleness::explained, silent_for(), now, out);
    } else if (!row.interval_s.empty() && state_) {
        if (absent_s > stale_least_s) change(row, Staleness::explained, "not expected in " + phase_, now, out);
    } else if (best_ == LinkIs::lost) {
        change(row, Staleness::explained, silent_for(), now, out);
    } else if (by_rhythm_ && row.rhythm_s > 0.0) {
        if (absent_s > std::max(stale_intervals * row.rhythm_s, stale_least_s))
            change(row, Staleness::explained, "it came more often before", now, out);
    }
}

std::optional<double> stale_after_s(const dictionary::Dictionary& dictionary, std::size_t packet) {
    std::uint32_t every = 1;
    for (const auto& row : dictionary.telemetry_plan)
        if (row.packet == dictionary.packets[packet].name) every = std::max(every, std::ranges::max(row.every));
    return stale_after_s(dictionary.packets[packet], every);
}

std::optional<double> stale_in_recording_after_s(const dictionary::Dictionary& dictionary, std::size_t packet) {
    return stale_after_s(dictionary.packets[packet], 1);
}

bool names_lost_link(std::string_view reason, std::string_view link_reason) {
    return reason.starts_with(lost_words) && reason.substr(lost_words.size()) == link_reason;
}

}  // namespace aeolis::telemetry
