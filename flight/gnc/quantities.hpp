#pragma once

#include "common/fixed_vector.hpp"

#include <cstdint>

// What a decision of GNC looked at, so that it can explain itself. R38
namespace aeolis::flight::gnc {

/// Names the quantity of a condition. The numbers are those of the enumeration in dictionaries/msl/msl.xml.
enum class Quantity : std::uint16_t {
    none,
    speed_mps,
    altitude_m,
    drag_mps2,
    descent_rate_mps,
    time_since_parachute_s,
    range_to_go_m,
    crossrange_m,
    thrust_N,
    time_to_parachute_s,
    time_to_backshell_s,
    cycles_held,
    radar_beams,
    time_in_mode_s,
    radar_locked = 39,
};

/// One condition behind a decision, for its explanation. R38
struct Condition {
    std::uint16_t quantity = 0; ///< a Quantity
    double value = 0.0;
    double bound = 0.0;
    enum class Comparison : std::uint8_t { lt, le, eq, ge, gt };
    Comparison comparison{};
    bool holds = false;
};

constexpr Condition at_most(Quantity quantity, double value, double bound) {
    return {static_cast<std::uint16_t>(quantity), value, bound, Condition::Comparison::le, value <= bound};
}
constexpr Condition at_least(Quantity quantity, double value, double bound) {
    return {static_cast<std::uint16_t>(quantity), value, bound, Condition::Comparison::ge, value >= bound};
}
constexpr Condition below(Quantity quantity, double value, double bound) {
    return {static_cast<std::uint16_t>(quantity), value, bound, Condition::Comparison::lt, value < bound};
}

using Conditions = FixedVector<Condition, 4>;

/// A decision is for "now" when every one of its conditions holds; with none it is never.
inline bool all_hold(const Conditions& conditions) {
    for (const Condition& condition : conditions)
        if (!condition.holds) return false;
    return !conditions.empty();
}

} // namespace aeolis::flight::gnc
