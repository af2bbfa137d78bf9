// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace aeolis::flight::gnc {

/// Attitude that guidance commands; attitude control realises it with thrusters and engines.
struct AttitudeCommand {
    enum class Mode : std::uint8_t {
        idle,        ///< no control: before GNC starts the vehicle is spin-stabilised
        detumble,    ///< no rotation relative to inertial space
        entry_bank,  ///< trim attitude in the wind with the lift vector at `bank_rad`
        suspended,   ///< under the parachute: only swinging is damped
        thrust,      ///< z of B opposes `thrust_direction_M`
    };
    Mode mode = Mode::idle;
    double bank_rad = 0.0;                       ///< positive: lift to the right of the velocity
    std::array<double, 3> thrust_direction_M{};  ///< unit, direction in which the engines push the vehicle
};

}  // namespace aeolis::flight::gnc
