// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/flyaway/flyaway.hpp"

#include "flight/gnc/powered_descent/divert.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::flyaway {

Command command(const Parameters& parameters, double since_start_s, const Vector3& p_MoB_M) {
    const double pitched =
        std::clamp((since_start_s - parameters.flyaway_upright_s) / parameters.flyaway_pitch_time_s, 0.0, 1.0);
    const double pitch = parameters.flyaway_pitch_deg * degree * pitched;
    const Vector3 away = powered_descent::azimuth_direction(p_MoB_M, parameters.flyaway_azimuth_deg * degree);
    return {std::cos(pitch) * p_MoB_M.normalized() + std::sin(pitch) * away,
            since_start_s >= parameters.flyaway_clear_s};
}

}  // namespace aeolis::flight::gnc::flyaway
