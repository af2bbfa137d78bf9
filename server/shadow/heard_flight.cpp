// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/heard_flight.hpp"

#include "common/check.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <iterator>

namespace aeolis::server::shadow {
namespace {

const std::vector<std::string> navigated_channels{
    "nav_position_x_m",   "nav_position_y_m", "nav_position_z_m", "nav_velocity_x_mps", "nav_velocity_y_mps",
    "nav_velocity_z_mps", "nav_attitude_w",   "nav_attitude_x",   "nav_attitude_y",     "nav_attitude_z"};
constexpr std::string_view lock = "RADAR_LOCK";

}  // namespace

HeardFlight::HeardFlight(const dictionary::Dictionary& dictionary)
    : decoder_(dictionary), navigation_(fields_of(dictionary, "GncNavigation", navigated_channels)),
      timeline_(fields_of(dictionary, "TimelineStatus", {"timepoint_index"})),
      firing_(fields_of(dictionary, "TimepointFired", {"timepoint", "fired_sclk"})) {}

std::optional<HeardFlight::Fields> HeardFlight::fields_of(const dictionary::Dictionary& dictionary,
                                                          const std::string& packet,
                                                          const std::vector<std::string>& names) {
    const auto* found = dictionary.packet(packet);
    if (found == nullptr) return std::nullopt;
    Fields fields{static_cast<std::size_t>(found - dictionary.packets.data()), {}};
    for (const std::string& name : names) {
        const auto index = telemetry::field_index(*found, name);
        if (!index) return std::nullopt;
        fields.at.push_back(*index);
    }
    return fields;
}

void HeardFlight::hear(const telemetry::Received& received) {
    for (const auto& packet : received.packets) {
        if (packet.link == telemetry::station_link) continue;  // what the ground itself says of it
        if (packet.decoded) {
            hear(*packet.decoded);
            continue;
        }
        hear(packet.octets);
    }
}

void HeardFlight::hear(std::span<const std::uint8_t> packet) {
    telemetry::DecodedPacket decoded;
    decoder_.decode(packet, decoded);
    hear(decoded);
}

void HeardFlight::hear(const telemetry::DecodedPacket& decoded) {
    if (!decoded.refusal.empty()) return;
    const auto& content = decoded.content;
    const Sclk sclk = content.header.time;
    if (decoded.event != nullptr) {
        if (decoded.event->level <= dictionary::EventLevel::warning_lo)
            warnings_.push_back({decoded.event->name, sclk});
        if (decoded.event->name == lock && (!locked_ || sclk < *locked_)) locked_ = sclk;
        return;
    }
    if (firing_ && content.packet == firing_->packet) {
        const auto row = content.value[firing_->at[0]], at = content.value[firing_->at[1]];
        if (row && at) fired_.push_back({static_cast<std::size_t>(*row), Sclk{*at}});
    }
    // What comes late, by an orbiter's memory or the recording, is no news of where it is.
    if (timeline_ && content.packet == timeline_->packet) {
        const auto row = content.value[timeline_->at[0]];
        if (row && (stands_.empty() || sclk > stands_.back().sclk))
            stands_.push_back({sclk, static_cast<std::uint16_t>(*row)});
    }
    if (navigation_ && content.packet == navigation_->packet && (!newest_ || sclk > newest_->sclk)) take_state(content);
}

void HeardFlight::take_state(const telemetry::Decoded& content) {
    std::array<double, 10> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = content.value[navigation_->at[i]];
        if (!value) return;  // it does not navigate
        values[i] = *value;
    }
    NavigatedState state;
    state.sclk = content.header.time;
    std::copy_n(values.begin(), 3, state.p_MoB_M_m.begin());
    std::copy_n(values.begin() + 3, 3, state.v_MB_M_mps.begin());
    std::copy_n(values.begin() + 6, 4, state.q_MB.begin());
    newest_ = state;
    if (states_.empty() || state.sclk - states_.back().sclk >= states_apart_s) states_.push_back(state);
}

std::vector<NavigatedState> HeardFlight::states() const {
    auto all = states_;
    if (newest_ && all.back().sclk != newest_->sclk) all.push_back(*newest_);
    return all;
}

std::optional<TimelineStand> HeardFlight::stand_by(Sclk sclk) const {
    const auto later = std::ranges::upper_bound(stands_, sclk, {}, &TimelineStand::sclk);
    return later != stands_.begin() ? std::optional{*std::prev(later)} : std::nullopt;
}

bool HeardFlight::radar_locked_by(Sclk sclk) const {
    return locked_ && *locked_ <= sclk;
}

}  // namespace aeolis::server::shadow
