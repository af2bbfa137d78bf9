// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/entry/lateral_logic.hpp"

namespace aeolis::flight::gnc {

double crossrange_deadband_m(const Parameters& parameters, double velocity_mps, bool saturated) {
    const double deadband_m =
        parameters.crossrange_deadband_m + parameters.crossrange_deadband_s2pm * velocity_mps * velocity_mps;
    return saturated ? parameters.saturated_deadband_fraction * deadband_m : deadband_m;
}

Conditions LateralLogic::on(const Parameters& parameters, Sclk now, double crossrange_m, double velocity_mps,
                            bool saturated, const Condition& settled) {
    const double deadband_m = crossrange_deadband_m(parameters, velocity_mps, saturated);
    Conditions conditions;
    conditions.push_back(sign_ > 0 ? below(Quantity::crossrange_m, crossrange_m, -deadband_m)
                                   : above(Quantity::crossrange_m, crossrange_m, deadband_m));
    conditions.push_back(settled);
    if (reversed_at_)
        conditions.push_back(
            at_least(Quantity::time_since_reversal_s, now - *reversed_at_, parameters.reversal_interval_min_s));
    if (!all_hold(conditions)) return conditions;
    sign_ = -sign_;
    ++reversals_;
    reversed_at_ = now;
    return conditions;
}

}  // namespace aeolis::flight::gnc
