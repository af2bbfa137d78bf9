// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/triggers/triggers.hpp"

#include "flight/gnc/powered_descent/vertical_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aeolis::flight::gnc::triggers {

namespace {

Conditions list(const Condition& a) {
    Conditions conditions;
    conditions.push_back(a);
    return conditions;
}
Conditions list(const Condition& a, const Condition& b) {
    Conditions conditions = list(a);
    conditions.push_back(b);
    return conditions;
}
Conditions list(const Condition& a, const Condition& b, const Condition& c) {
    Conditions conditions = list(a, b);
    conditions.push_back(c);
    return conditions;
}

}  // namespace

bool near(const Parameters& parameters, const Conditions& conditions) {
    if (conditions.empty()) return false;
    if (conditions[0].quantity == Quantity::time_in_mode_s) return false;  // a timer alone is not a decision
    return conditions[0].holds || std::ranges::any_of(conditions, [&](const Condition& condition) {
               const double margin = parameters.held_near_fraction * std::abs(condition.bound);
               return !condition.holds && std::abs(condition.value - condition.bound) <= margin;
           });
}

Conditions worth_telling(const Conditions& conditions) {
    Conditions told;
    for (const Condition& condition : conditions)
        if (condition.quantity != Quantity::cycles_true || condition.value > 0.0) told.push_back(condition);
    return told;
}

Conditions guidance_start(const Parameters& parameters, double filtered_drag_mps2) {
    return list(at_least(Quantity::drag_mps2, filtered_drag_mps2, parameters.guidance_start_drag_mps2));
}

Conditions heading_alignment(const Parameters& parameters, double speed_mps) {
    return list(at_most(Quantity::speed_mps, speed_mps, parameters.heading_alignment_speed_mps));
}

Conditions sufr_start(const Parameters& parameters, const InAir& at, double deceleration_mps2,
                      const ParachuteBounds& bounds) {
    const Conditions last = list(at_most(Quantity::altitude_m, at.altitude_m, parameters.sufr_altitude_last_m));
    if (all_hold(last)) return last;
    const double to_lowest_s = (at.altitude_m - bounds.altitude_min_m) / std::max(at.descent_rate_mps, 1.0);
    const Conditions low = list(at_most(Quantity::time_to_parachute_s, to_lowest_s, parameters.sufr_lead_s),
                                at_least(Quantity::descent_rate_mps, at.descent_rate_mps, 1.0),
                                at_most(Quantity::speed_mps, at.speed_mps, parameters.sufr_low_speed_mps));
    if (all_hold(low)) return low;
    if (parameters.parachute_range_m > 0.0) {
        const double level_mps =
            std::sqrt(std::max(at.speed_mps * at.speed_mps - at.descent_rate_mps * at.descent_rate_mps, 1.0));
        const double to_range_s = (at.range_to_go_m - parameters.parachute_range_m) / level_mps;
        const Conditions near = list(at_most(Quantity::time_to_parachute_s, to_range_s, parameters.sufr_lead_s),
                                     at_most(Quantity::speed_mps, at.speed_mps, parameters.sufr_low_speed_mps));
        if (all_hold(near)) return near;
    }
    const double to_parachute_s = (at.speed_mps - bounds.speed_mps) / std::max(deceleration_mps2, 1.0e-3);
    Conditions slow = list(at_most(Quantity::time_to_parachute_s, to_parachute_s, parameters.sufr_lead_s),
                           at_most(Quantity::speed_mps, at.speed_mps, bounds.speed_mps + parameters.sufr_near_mps));
    if (!all_hold(slow)) slow.push_back(last[0]);
    return slow;
}

Conditions parachute(const Parameters& parameters, const InAir& at, const ParachuteBounds& bounds,
                     std::uint32_t cycles_true) {
    const Condition held = at_least(Quantity::cycles_true, cycles_true, std::floor(parameters.parachute_cycles));
    const Condition last = at_most(Quantity::altitude_m, at.altitude_m, parameters.parachute_altitude_last_m);
    if (last.holds) return list(last, held);
    const Condition slow = at_most(Quantity::speed_mps, at.speed_mps, bounds.speed_mps);
    const Condition low = at_most(Quantity::altitude_m, at.altitude_m, bounds.altitude_min_m);
    const Condition pressure =
        at_most(Quantity::dynamic_pressure_Pa, at.dynamic_pressure_Pa, parameters.parachute_pressure_max_Pa);
    const Condition mach = at_most(Quantity::mach, at.mach, parameters.parachute_mach_max);
    const bool by_range = parameters.parachute_range_m > 0.0;
    const Condition near = at_most(Quantity::range_to_go_m, at.range_to_go_m, parameters.parachute_range_m);
    const bool enough = slow.holds || low.holds || (by_range && near.holds);
    const Condition& reached = by_range && near.holds ? near : low.holds && !slow.holds ? low : slow;
    const Condition& awaited = by_range ? near : slow;
    Conditions conditions = list(enough ? reached : awaited, pressure, mach);
    conditions.push_back(enough ? held : low);
    return conditions;
}

bool parachute_due(const Parameters& parameters, const InAir& at, const ParachuteBounds& bounds) {
    return all_hold(parachute(parameters, at, bounds, std::numeric_limits<std::uint32_t>::max()));
}

Conditions heatshield(const Parameters& parameters, const InAir& at, double heatshield_speed_mps,
                      double since_parachute_s) {
    const Condition low = at_most(Quantity::altitude_m, at.altitude_m, parameters.heatshield_altitude_min_m);
    const Condition late =
        at_least(Quantity::time_since_parachute_s, since_parachute_s, parameters.heatshield_patience_s);
    const Condition delay =
        at_least(Quantity::time_since_parachute_s, since_parachute_s, parameters.heatshield_delay_min_s);
    const Condition slow = at_most(Quantity::speed_mps, at.speed_mps, heatshield_speed_mps);
    if (slow.holds) return list(slow, delay);
    if (late.holds) return list(late);
    if (low.holds) return list(low, delay);
    return list(slow, low, late);
}

double backshell_altitude_needed_m(const Parameters& parameters, const BackshellBounds& bounds,
                                   double descent_rate_mps) {
    return bounds.altitude_m + powered_descent::altitude_used_until_constant_velocity_m(parameters, descent_rate_mps) -
           powered_descent::altitude_used_until_constant_velocity_m(parameters, bounds.descent_rate_mps);
}

Conditions engine_priming(const Parameters& parameters, double altitude_m, double descent_rate_mps,
                          double backshell_altitude_m) {
    const double to_backshell_s = (altitude_m - backshell_altitude_m) / std::max(descent_rate_mps, 1.0);
    return list(at_most(Quantity::time_to_backshell_s, to_backshell_s, parameters.priming_lead_s),
                at_least(Quantity::descent_rate_mps, descent_rate_mps, 1.0));
}

Conditions constant_velocity(const Parameters& parameters, double altitude_m, double descent_rate_mps) {
    const Condition slow = at_most(Quantity::descent_rate_mps, descent_rate_mps, parameters.constant_velocity_mps);
    const Condition low =
        at_most(Quantity::altitude_m, altitude_m, powered_descent::approach_end_altitude_m(parameters));
    if (slow.holds) return list(slow);
    return low.holds ? list(low) : list(slow, low);
}

Conditions backshell(const Parameters& parameters, double altitude_m, double descent_rate_mps,
                     const BackshellBounds& bounds, std::uint32_t cycles_true) {
    return list(
        at_most(Quantity::altitude_m, altitude_m, backshell_altitude_needed_m(parameters, bounds, descent_rate_mps)),
        at_least(Quantity::descent_rate_mps, descent_rate_mps, 1.0),
        at_least(Quantity::cycles_true, cycles_true, std::floor(parameters.backshell_cycles)));
}

}  // namespace aeolis::flight::gnc::triggers
