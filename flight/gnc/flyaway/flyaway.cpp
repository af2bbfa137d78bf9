// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/flyaway/flyaway.hpp"

#include "flight/gnc/powered_descent/divert.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::flyaway {

Command command(double since_start_s, const Vector3& p_MoB_M) {
    const double pitch = pitch_rad * std::clamp((since_start_s - upright_s) / pitch_time_s, 0.0, 1.0);
    const Vector3 away = powered_descent::azimuth_direction(p_MoB_M, azimuth_rad);
    return {std::cos(pitch) * p_MoB_M.normalized() + std::sin(pitch) * away, since_start_s >= clear_s};
}

}  // namespace aeolis::flight::gnc::flyaway
