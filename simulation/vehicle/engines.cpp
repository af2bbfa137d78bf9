// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/engines.hpp"

#include "flight/devices/effectors.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double priming_s = 5.0;
constexpr double ignition_delay_s = 0.15;
constexpr double throttle_lag_s = 0.06;
constexpr double shutdown_lag_s = 0.03;
constexpr auto engine_mounts = flight::descent_engines();

}  // namespace

void Engines::open_valves(double now_s) {
    if (valves_open_) return;
    valves_open_ = true;
    valves_open_since_s_ = now_s;
}

void Engines::command(const flight::EngineCommand& command, double now_s) {
    if (command.ignited && !ignited_) ignition_s_ = now_s;
    ignited_ = command.ignited;
    for (std::size_t i = 0; i < throttle_.size(); ++i)
        throttle_[i] = std::isfinite(command.throttle[i]) ? std::clamp(command.throttle[i], 0.0, 1.0) : 0.0;
}

double Engines::asked_N(std::size_t engine) const {
    return running_ ? std::max(design_.least_thrust_N, throttle_[engine] * design_.largest_thrust_N) : 0.0;
}

double Engines::advance(double now_s, double step_s, double propellant_left_kg) {
    running_ = ignited_ && valves_open_ && propellant_left_kg > 0.0 && now_s - valves_open_since_s_ >= priming_s &&
               now_s - ignition_s_ >= ignition_delay_s;
    if (!running_ && thrust_sum_N_ == 0.0) return 0.0;
    const double kept = std::exp(-step_s / (running_ ? throttle_lag_s : shutdown_lag_s));
    double burnt_kg = 0.0;
    for (std::size_t i = 0; i < thrust_N_.size(); ++i) {
        const double wanted_N = asked_N(i);
        const double before_N = thrust_N_[i];
        thrust_N_[i] = wanted_N + (before_N - wanted_N) * kept;
        if (!running_ && thrust_N_[i] < 0.1) thrust_N_[i] = 0.0;
        const double impulse_s = design_.least_impulse_s + (design_.most_impulse_s - design_.least_impulse_s) *
                                                               thrust_N_[i] / design_.largest_thrust_N;
        burnt_kg += 0.5 * (before_N + thrust_N_[i]) * step_s / (impulse_s * standard_gravity_mps2);
    }
    sum_up();
    return burnt_kg;
}

void Engines::sum_up() {
    thrust_sum_N_ = 0.0;
    force_B_N_.setZero();
    torque_B_Nm_.setZero();
    for (std::size_t i = 0; i < thrust_N_.size(); ++i) {
        thrust_sum_N_ += thrust_N_[i];
        const Vector3 force_B_N = thrust_N_[i] * vector3(engine_mounts[i].direction_B);
        force_B_N_ += force_B_N;
        torque_B_Nm_ += vector3(engine_mounts[i].position_B_m).cross(force_B_N);
    }
}

void Engines::place(const flight::EngineCommand& placed, std::optional<double> valves_s) {
    *this = Engines{design_};
    if (valves_s) open_valves(*valves_s);
    command(placed, 0.0);  // engines that are ignited have run for long
    running_ = ignited_ && valves_open_;
    for (std::size_t i = 0; i < thrust_N_.size(); ++i) thrust_N_[i] = asked_N(i);
    sum_up();
}

}  // namespace aeolis::simulation
