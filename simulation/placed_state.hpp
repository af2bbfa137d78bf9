// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "flight/devices/device_messages.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::simulation {

/// The state of a vehicle between cruise-stage separation and touchdown, as numbers: all that a landing needs to fly on
/// from there.
///
/// Left out, so that a landing placed elsewhere flies on a little differently: the thruster pulses of the present tick,
/// commands and replies on the buses, thrust on its way to the commanded throttle, gusts, and the jettisoned bodies,
/// which then cannot come back. The errors of the air, the vehicle and its instruments are no state: they are those of
/// the landing that is placed.
struct PlacedState {
    Sclk sclk;                          ///< a whole tick
    std::array<double, 3> p_MoB_M_m{};  ///< of the centre of mass of what flies on, without a rover on the bridle
    std::array<double, 3> v_MB_M_mps{};
    std::array<double, 4> q_MB{1, 0, 0, 0};
    std::array<double, 3> rate_B_rps{};  ///< relative to inertial space
    double propellant_kg = 0.0;

    std::array<bool, flight::pyro_count> fired{};                         ///< by PyroId
    std::array<std::array<bool, 2>, flight::switch_count> switched_on{};  ///< by SwitchId and unit
    bool thrusters_enabled = true;
    std::optional<Sclk> mortar;                               ///< when it was fired
    std::array<double, 3> right_at_mortar_M{};                ///< horizontal, to the right of the flight then
    std::optional<Sclk> valves;                               ///< when those of the engines were opened
    flight::EngineCommand engines;                            ///< that the engine controllers hold
    std::optional<Sclk> bridle;                               ///< when its pay-out began
    std::array<double, 3> p_MoRover_M_m{}, v_MRover_M_mps{};  ///< while it hangs on the bridle

    double peak_deceleration_mps2 = 0.0;  ///< so far
    bool peak_passed = false;
    int bank_reversals = 0;  ///< so far

    std::vector<std::uint8_t> computer;  ///< prime's state frame, as it told it in the cycle before
};

/// How well the state of a vehicle is known from which cases are flown: deviations of the whole vectors.
struct StateKnowledge {
    double position_m = 0.0;
    double velocity_mps = 0.0;
    double attitude_rad = 0.0;         ///< of the rotation about each axis
    std::optional<double> height_m{};  ///< along the local vertical, where it is known better than the place
};

}  // namespace aeolis::simulation
