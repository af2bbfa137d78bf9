// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/heading_alignment.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc {

double heading_alignment_bank_rad(const TargetGeometry& geometry) {
    constexpr double gain = parameters.heading_alignment_gain;
    return std::clamp(gain * std::atan2(geometry.crossrange_m, geometry.downrange_m), -heading_alignment_limit_rad,
                      heading_alignment_limit_rad);
}

}  // namespace aeolis::flight::gnc
