// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/bridle.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double ramp_s = 0.6;
constexpr double steady_mps = Bridle::length_m / (Bridle::pay_out_s - ramp_s);
constexpr double ramp_mps2 = steady_mps / ramp_s;
constexpr double stowed_m = 0.2;             // from the confluence to the rover, under the rover's weight
constexpr double bridle_weight_mps2 = 3.71;  // [facts]
constexpr double stretch_by_weight_m = 0.015;
constexpr double damping_ratio = 0.3;

}  // namespace

void Bridle::start(double now_s) {
    if (started_) return;
    started_ = true;
    start_s_ = now_s;
}

double Bridle::payed_out_m(double now_s) const {
    if (!started_) return 0.0;
    const double t = std::clamp(now_s - start_s_, 0.0, pay_out_s);
    if (t < ramp_s) return 0.5 * ramp_mps2 * t * t;
    if (t <= pay_out_s - ramp_s) return steady_mps * (t - 0.5 * ramp_s);
    const double left_s = pay_out_s - t;
    return length_m - 0.5 * ramp_mps2 * left_s * left_s;
}

double Bridle::speed_mps(double now_s) const {
    if (!started_) return 0.0;
    const double t = now_s - start_s_;
    if (t < 0.0 || t >= pay_out_s) return 0.0;
    return std::min({steady_mps, ramp_mps2 * t, ramp_mps2 * (pay_out_s - t)});
}

Vector3 Bridle::pull_N(double now_s, double rover_kg, const Vector3& offset, const Vector3& rate) const {
    const double distance_m = offset.norm();
    const double stretch_m = distance_m - (stowed_m - stretch_by_weight_m + payed_out_m(now_s));
    if (stretch_m <= 0.0) return Vector3::Zero();
    const Vector3 along = offset / distance_m;
    const double stiffness_Npm = rover_kg * bridle_weight_mps2 / stretch_by_weight_m;
    const double damping_Nspm = 2.0 * damping_ratio * std::sqrt(rover_kg * stiffness_Npm);
    const double pull_N = stiffness_Npm * stretch_m + damping_Nspm * (rate.dot(along) - speed_mps(now_s));
    return -std::max(0.0, pull_N) * along;
}

}  // namespace aeolis::simulation
