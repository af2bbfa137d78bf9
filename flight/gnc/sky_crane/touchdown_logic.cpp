// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/sky_crane/touchdown_logic.hpp"

#include "flight/gnc/mars.hpp"

#include <cmath>

namespace aeolis::flight::gnc::sky_crane {

Conditions TouchdownLogic::on(const Parameters& parameters, double thrust_command_N, double mass_kg, double rover_kg) {
    const double tolerance = parameters.touchdown_thrust_tolerance;
    const double weight_N = (mass_kg - rover_kg) * mars_weight_mps2;
    const Condition above = at_least(Quantity::thrust_N, thrust_command_N, (1.0 - tolerance) * weight_N);
    const Condition not_above = at_most(Quantity::thrust_N, thrust_command_N, (1.0 + tolerance) * weight_N);
    settled_cycles_ = above.holds && not_above.holds ? settled_cycles_ + 1 : 0;
    Conditions conditions;
    conditions.push_back(above);
    conditions.push_back(not_above);
    conditions.push_back(
        at_least(Quantity::cycles_true, settled_cycles_, std::floor(parameters.touchdown_settle_s / seconds_per_tick)));
    return conditions;
}

}  // namespace aeolis::flight::gnc::sky_crane
