// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/uhf_link.hpp"

#include "common/time.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

constexpr const char* nominal = "nominal";

}  // namespace

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
    const auto left = transmitter_.cycle();
    if (up_) return left;
    lost_octets_ += left.size();
    return {};
}

}  // namespace aeolis::simulation
