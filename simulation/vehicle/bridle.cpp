#include "simulation/vehicle/bridle.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

constexpr double ramp_s = 0.6;
constexpr double steady_mps = Bridle::length_m / (Bridle::pay_out_s - ramp_s);
constexpr double ramp_mps2 = steady_mps / ramp_s;

} // namespace

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

double Bridle::acceleration_mps2(double now_s) const {
    if (!started_) return 0.0;
    const double t = now_s - start_s_;
    if (t >= 0.0 && t < ramp_s) return ramp_mps2;
    if (t > pay_out_s - ramp_s && t < pay_out_s) return -ramp_mps2;
    return 0.0;
}

double Bridle::load(double now_s, double height_m) const {
    const double slack_m = standing_height_m(now_s) - height_m;
    return std::clamp(1.0 - slack_m / slack_to_unload_m, 0.0, 1.0);
}

} // namespace aeolis::simulation
