// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace aeolis {

/// Days from 2000-01-01 to a date of the Gregorian calendar, extended to before its introduction.
/// None when there is no such date.
/// @param year 1 … 9999, @param month 1 … 12, @param day 1 …
constexpr std::optional<std::int64_t> days_since_2000(int year, unsigned month, unsigned day) {
    constexpr unsigned lengths[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    if (year < 1 || year > 9999 || month < 1 || month > 12) return std::nullopt;
    const bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    if (day < 1 || day > lengths[month - 1] + (leap && month == 2 ? 1U : 0U)) return std::nullopt;
    std::int64_t days = 0;
    for (unsigned i = 1; i < month; ++i) days += lengths[i - 1] + (leap && i == 2 ? 1U : 0U);
    const std::int64_t before = year - 1;
    constexpr std::int64_t to_2000 = 1999 * 365 + 1999 / 4 - 1999 / 100 + 1999 / 400;
    return before * 365 + before / 4 - before / 100 + before / 400 - to_2000 + days + day - 1;
}

}  // namespace aeolis
