// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/height_guard.hpp"

#include "flight/gnc/mars.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

double altitude_when_slow_m(const Parameters& parameters, const PullUp& now, double speed_mps) {
    const double step_s = parameters.height_guard_step_s;
    double v = std::max(now.speed_mps, 1.0), h = now.altitude_m;
    double path = -std::asin(std::clamp(now.descent_rate_mps / v, -1.0, 1.0));
    const int steps = static_cast<int>(std::ceil(parameters.height_guard_foresight_s / step_s));
    for (int i = 0; i < steps && v > speed_mps && h > 0.0; ++i) {
        const double faster = v / now.speed_mps;
        const double drag =
            now.drag_mps2 * faster * faster * std::exp((now.altitude_m - h) / parameters.reckoned_scale_height_m);
        const double weight = mars_weight_mps2 - v * v / (mars_equator_radius_m + h);
        const double climb = std::sin(path);
        path += (now.lift_to_drag * drag - weight * std::cos(path)) / v * step_s;
        v -= (drag + mars_weight_mps2 * climb) * step_s;
        h += v * std::sin(path) * step_s;
    }
    return h;
}

double bank_allowed_rad(const Parameters& parameters, double altitude_foreseen_m) {
    const double spare = (altitude_foreseen_m - parameters.height_guard_m) / parameters.height_guard_band_m;
    return std::acos(std::clamp(1.0 - 2.0 * spare, -1.0, 1.0));
}

}  // namespace aeolis::flight::gnc
