// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/sufr/straighten_up.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::sufr {

double bank_rad(const Parameters& parameters, double since_start_s, double bank_at_start_rad) {
    const double roll_rate_rps = parameters.sufr_roll_rate_dps * degree;
    const double left = std::max(std::abs(bank_at_start_rad) - roll_rate_rps * std::max(since_start_s, 0.0), 0.0);
    return std::copysign(left, bank_at_start_rad);
}

}  // namespace aeolis::flight::gnc::sufr
