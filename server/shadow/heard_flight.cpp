// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/heard_flight.hpp"

#include "common/check.hpp"
#include "telemetry/text.hpp"

#include <algorithm>

namespace aeolis::server::shadow {
namespace {

const std::vector<std::string> navigated_channels{
    "nav_position_x_m",   "nav_position_y_m", "nav_position_z_m", "nav_velocity_x_mps", "nav_velocity_y_mps",
    "nav_velocity_z_mps", "nav_attitude_w",   "nav_attitude_x",   "nav_attitude_y",     "nav_attitude_z"};
constexpr std::string_view reversal = "BANK_REVERSAL", lock = "RADAR_LOCK";

}  // namespace

HeardFlight::HeardFlight(const dictionary::Dictionary& dictionary)
    : dictionary_(dictionary), decoder_(dictionary),
      navigation_(fields_of(dictionary, "GncNavigation", navigated_channels)),
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
            take(*packet.decoded);
            continue;
        }
        hear(packet.octets);
    }
}

void HeardFlight::hear(std::span<const std::uint8_t> packet) {
    telemetry::DecodedPacket decoded;
    decoder_.decode(packet, decoded);
    take(decoded);
}

void HeardFlight::take(const telemetry::DecodedPacket& decoded) {
    if (!decoded.refusal.empty()) return;
    const auto& content = decoded.content;
    if (decoded.event != nullptr) {
        if (decoded.event->name == reversal) reversals_.push_back({decoded.event->name, content.header.time});
        if (decoded.event->name == lock) locks_.push_back({decoded.event->name, content.header.time});
        return;
    }
    if (firing_ && content.packet == firing_->packet) {
        const auto row = content.value[firing_->at[0]], fired = content.value[firing_->at[1]];
        if (!row || !fired || *row < 0.0 || *row >= static_cast<double>(dictionary_.timeline.size())) return;
        fired_.push_back({dictionary_.timeline[static_cast<std::size_t>(*row)].name, Sclk{*fired}});
        return;
    }
    if (!navigation_ || content.packet != navigation_->packet) return;
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
    // What comes late, by an orbiter's memory or the recording, is no news of where it is.
    if (newest_ && state.sclk <= newest_->sclk) return;
    newest_ = state;
    if (states_.empty() || state.sclk - states_.back().sclk >= states_apart_s) states_.push_back(state);
}

std::vector<NavigatedState> HeardFlight::states() const {
    auto all = states_;
    if (newest_ && all.back().sclk != newest_->sclk) all.push_back(*newest_);
    return all;
}

std::set<std::string> HeardFlight::fired_by(Sclk sclk) const {
    std::set<std::string> names;
    for (const Told& fired : fired_)
        if (fired.sclk <= sclk) names.insert(fired.name);
    return names;
}

int HeardFlight::bank_reversals_by(Sclk sclk) const {
    std::set<double> times;  // live and recorded are one
    for (const Told& told : reversals_)
        if (told.sclk <= sclk) times.insert(told.sclk.seconds);
    return static_cast<int>(times.size());
}

bool HeardFlight::radar_locked_by(Sclk sclk) const {
    return std::ranges::any_of(locks_, [&](const Told& told) { return told.sclk <= sclk; });
}

}  // namespace aeolis::server::shadow
