// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/sky_crane/rate_control.hpp"

#include "common/check.hpp"

#include <algorithm>

namespace aeolis::flight::gnc::sky_crane {

Vector3 RateControl::command_M(const Parameters& parameters, const Vector3& v_MB_M, const Vector3& up_M,
                               double wanted_descent_rate_mps, double dt_s) {
    AEOLIS_CHECK(dt_s > 0.0);
    const double integral_max_mps2 = parameters.sky_crane_integral_max_mps2;
    const double command_max_mps2 = parameters.sky_crane_command_max_mps2;
    const double climb_mps = v_MB_M.dot(up_M);
    const double error_mps = -climb_mps - wanted_descent_rate_mps;
    integral_mps2_ = std::clamp(integral_mps2_ + parameters.sky_crane_integral_per_s2 * error_mps * dt_s,
                                -integral_max_mps2, integral_max_mps2);
    const double up_mps2 = std::clamp(parameters.sky_crane_proportional_per_s * error_mps + integral_mps2_,
                                      -command_max_mps2, command_max_mps2);
    return up_mps2 * up_M - parameters.sky_crane_level_per_s * (v_MB_M - climb_mps * up_M);
}

}  // namespace aeolis::flight::gnc::sky_crane
