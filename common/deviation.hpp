// SPDX-License-Identifier: Apache-2.0
#pragma once

// How far a table of parameters is from the one built in: the rule by which ground and flight let one fly together.
namespace aeolis {

/// How far a value is from the one built in, as a part of its range on that side: 0 … 1.
///
/// Each parameter alone lands at 1, either end of its range. Of several the sum counts: what moves half of its range
/// leaves half to the others. `value` is within min … max.
constexpr double deviation(double value, double built_in, double min, double max) {
    if (value == built_in) return 0.0;
    return value > built_in ? (value - built_in) / (max - built_in) : (built_in - value) / (built_in - min);
}

/// A table whose deviations add up to more flies nowhere.
inline constexpr double table_deviation_max = 1.0;

}  // namespace aeolis
