// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/heading_alignment.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

double heading_alignment_bank_rad(const Parameters& parameters, const TargetGeometry& geometry) {
    const double limit_rad = parameters.heading_alignment_bank_max_deg * degree;
    return std::clamp(parameters.heading_alignment_gain * std::atan2(geometry.crossrange_m, geometry.downrange_m),
                      -limit_rad, limit_rad);
}

}  // namespace aeolis::flight::gnc
