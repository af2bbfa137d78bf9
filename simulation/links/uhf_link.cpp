// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/uhf_link.hpp"

#include "common/time.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

constexpr std::size_t transmitter_octets = 65536;  // our assumption
constexpr const char* nominal = "nominal";

}  // namespace

void UhfLink::offer(std::span<const std::uint8_t> octets) {
    const std::size_t taken = std::min(octets.size(), transmitter_octets - waiting_.size());
    waiting_.insert(waiting_.end(), octets.begin(), octets.begin() + static_cast<std::ptrdiff_t>(taken));
    lost_octets_ += octets.size() - taken;
}

const char* UhfLink::why_down(const Surroundings& at) {
    if (at.parachute_antenna != parachute_antenna_) hand_over_left_s_ = radio_.uhf_hand_over_s;
    parachute_antenna_ = at.parachute_antenna;
    hand_over_left_s_ = std::max(0.0, hand_over_left_s_ - seconds_per_tick);
    if (!at.transmitter_on) return "not switched on";
    const bool entered = at.e_s >= 0.0;
    if (entered && at.speed_mps < radio_.blackout_end_speed_mps) blackout_over_ = true;
    const bool plasma =
        entered && !blackout_over_ &&
        (at.altitude_m < radio_.blackout_start_altitude_m || at.speed_mps < radio_.blackout_start_speed_mps);
    if (plasma) return "plasma blackout";
    return hand_over_left_s_ > 0.0 ? "antenna hand-over" : nullptr;
}

std::span<const std::uint8_t> UhfLink::cycle(const Surroundings& at) {
    const char* down = why_down(at);
    up_ = down == nullptr;
    reason_ = up_ ? nominal : down;
    arrived_.clear();
    credit_octets_ += radio_.uhf_rate_bps / 8.0 * seconds_per_tick;
    const auto leaving = static_cast<std::ptrdiff_t>(std::min(credit_octets_, static_cast<double>(waiting_.size())));
    credit_octets_ =
        static_cast<std::size_t>(leaving) == waiting_.size() ? 0.0 : credit_octets_ - static_cast<double>(leaving);
    if (up_)
        arrived_.assign(waiting_.begin(), waiting_.begin() + leaving);
    else
        lost_octets_ += static_cast<std::uint64_t>(leaving);
    waiting_.erase(waiting_.begin(), waiting_.begin() + leaving);
    return arrived_;
}

}  // namespace aeolis::simulation
