// SPDX-License-Identifier: Apache-2.0
#include "common/entry_time.hpp"

#include "common/time.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>

namespace aeolis {

std::string from_entry_text(double e_s) {
    constexpr double half_a_tick_s = seconds_per_tick / 2.0;  // an instant just before a second is that second
    const auto whole = static_cast<std::int64_t>(std::floor(e_s + half_a_tick_s));
    const std::int64_t all = whole < 0 ? -whole : whole;
    const int hours = static_cast<int>(all / 3600), minutes = static_cast<int>(all / 60 % 60),
              seconds = static_cast<int>(all % 60);
    char buffer[40];
    if (hours > 0)
        std::snprintf(buffer, sizeof buffer, "E%s%d:%02d:%02d", whole < 0 ? "−" : "+", hours, minutes, seconds);
    else
        std::snprintf(buffer, sizeof buffer, "E%s%d:%02d", whole < 0 ? "−" : "+", minutes, seconds);
    return buffer;
}

}  // namespace aeolis
