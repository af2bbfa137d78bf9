// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/gusts.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double length_by_height = 0.5, least_length_m = 25.0, most_length_m = 500.0;
constexpr double vertical_part = 0.5;

}  // namespace

void Gusts::advance(double altitude_m, double airspeed_mps, double step_s) {
    if (!blow_at(altitude_m)) return;
    if (!begun_) {
        begun_ = true;
        parts_ = random_.normal3();
        return;
    }
    const double length_m = std::clamp(length_by_height * altitude_m, least_length_m, most_length_m);
    const double kept = std::exp(-airspeed_mps * step_s / length_m);
    const double fresh = std::sqrt(1.0 - kept * kept);
    for (double& part : parts_) part = kept * part + fresh * random_.normal();
}

Vector3 Gusts::at(double altitude_m, const Horizon& local) const {
    const double deviation_mps = deviation_mps_ * std::min(1.0, 1.0 - altitude_m / top_m);
    return deviation_mps * (parts_[0] * local.east + parts_[1] * local.north + vertical_part * parts_[2] * local.up);
}

}  // namespace aeolis::simulation
