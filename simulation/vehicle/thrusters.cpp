// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/thrusters.hpp"

#include "common/time.hpp"
#include "flight/devices/effectors.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double valve_delay_s = 0.004;
constexpr double specific_impulse_s = 220.0;
constexpr auto thruster_mounts = flight::entry_thrusters();

}  // namespace

void Thrusters::command(const flight::ThrusterCommand& command, bool enabled, double now_s) {
    for (std::size_t i = 0; i < pulses_.size(); ++i) {
        pulses_[i][0] = pulses_[i][1];
        pulses_[i][1] = {};
        const double on_s = command.on_s[i];
        if (!enabled || !std::isfinite(on_s) || on_s <= 0.0) continue;
        const double from_s = now_s + valve_delay_s;
        pulses_[i][1] = {from_s, from_s + std::clamp(on_s, flight::thruster_least_on_s, seconds_per_tick)};
        last_until_s_ = std::max(last_until_s_, pulses_[i][1].until_s);
    }
}

Thrusters::Push Thrusters::mean(double now_s, double step_s) const {
    Push push;
    if (now_s >= last_until_s_) return push;
    for (std::size_t i = 0; i < pulses_.size(); ++i) {
        double open_s = 0.0;
        for (const Pulse& pulse : pulses_[i])
            open_s += std::max(0.0, std::min(pulse.until_s, now_s + step_s) - std::max(pulse.from_s, now_s));
        if (open_s == 0.0) continue;
        const Vector3 force_B =
            flight::thruster_force_N * std::min(open_s / step_s, 1.0) * vector3(thruster_mounts[i].direction_B);
        push.propellant_kg += flight::thruster_force_N * open_s / (specific_impulse_s * standard_gravity_mps2);
        push.force_B += force_B;
        push.torque_B += vector3(thruster_mounts[i].position_B_m).cross(force_B);
    }
    return push;
}

}  // namespace aeolis::simulation
