// SPDX-License-Identifier: Apache-2.0
#include "common/entry_time.hpp"

#include "common/time.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>

namespace aeolis {

namespace {

/// "E+4:58" of whole seconds from entry.
std::string clock_text(bool before, std::int64_t all) {
    const int hours = static_cast<int>(all / 3600), minutes = static_cast<int>(all / 60 % 60),
              seconds = static_cast<int>(all % 60);
    char buffer[40];
    if (hours > 0)
        std::snprintf(buffer, sizeof buffer, "E%s%d:%02d:%02d", before ? "−" : "+", hours, minutes, seconds);
    else
        std::snprintf(buffer, sizeof buffer, "E%s%d:%02d", before ? "−" : "+", minutes, seconds);
    return buffer;
}

}  // namespace

std::string from_entry_text(double e_s) {
    constexpr double half_a_tick_s = seconds_per_tick / 2.0;  // an instant just before a second is that second
    const auto whole = static_cast<std::int64_t>(std::floor(e_s + half_a_tick_s));
    return clock_text(whole < 0, whole < 0 ? -whole : whole);
}

std::string from_entry_tenths_text(double e_s) {
    const auto tenths = static_cast<std::int64_t>(std::floor(e_s * 10.0 + 0.5));
    const std::int64_t all = tenths < 0 ? -tenths : tenths;
    return clock_text(tenths < 0, all / 10) + "." + std::to_string(all % 10);
}

}  // namespace aeolis
