// SPDX-License-Identifier: Apache-2.0
#pragma once

// How far a parameter table deviates from the one built in. By this rule ground and flight decide whether it may fly.
namespace aeolis {

/// Deviation of a value from the one built in, as a fraction of its range on that side: 0 … 1.
///
/// The vehicle lands with any one parameter at 1, an end of its range. Deviations of several parameters are added: one
/// that uses half of its range leaves half to the others. `value` is within min … max.
constexpr double deviation(double value, double built_in, double min, double max) {
    if (value == built_in) return 0.0;
    return value > built_in ? (value - built_in) / (max - built_in) : (built_in - value) / (built_in - min);
}

/// Largest sum of deviations with which ground or flight lets a table fly.
inline constexpr double table_deviation_max = 1.0;

}  // namespace aeolis
