#include "common/time.hpp"

#include <chrono>
#include <cstdio>

namespace aeolis {
namespace {

std::string text(std::int64_t microseconds_since_2000) {
    using namespace std::chrono;
    constexpr sys_seconds epoch = sys_days{year{2000} / January / 1} + hours{12};
    const auto instant = epoch + microseconds{microseconds_since_2000};
    const auto day = floor<days>(instant);
    const year_month_day date{day};
    const auto first = sys_days{date.year() / January / 1};
    const hh_mm_ss<microseconds> clock{instant - day};
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%04d-%03dT%02d:%02d:%02d.%03d", static_cast<int>(date.year()),
                  static_cast<int>((day - first).count()) + 1, static_cast<int>(clock.hours().count()),
                  static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()),
                  static_cast<int>(clock.subseconds().count() / 1000));
    return buffer;
}

}  // namespace

std::string day_of_year_text(Scet time) {
    return text(time.microseconds);
}

std::string day_of_year_text(Ert time) {
    return text(time.microseconds);
}

}  // namespace aeolis
