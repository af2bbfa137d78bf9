// SPDX-License-Identifier: Apache-2.0
#include "common/time.hpp"

#include <chrono>
#include <cstdio>
#include <string>

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

/// Number of a text of digits only; none when it holds another character.
std::optional<std::int64_t> digits(std::string_view text) {
    std::int64_t number = 0;
    for (const char c : text) {
        if (c < '0' || c > '9') return std::nullopt;
        number = number * 10 + (c - '0');
    }
    return number;
}

}  // namespace

std::optional<Ert> ert_from_day_of_year(std::string_view text) {
    using namespace std::chrono;
    constexpr std::string_view form = "YYYY-DDDTHH:MM:SS";
    constexpr std::size_t fraction_digits_max = 6;
    if (text.size() < form.size() || text.size() > form.size() + 1 + fraction_digits_max || text[4] != '-' ||
        text[8] != 'T' || text[11] != ':' || text[14] != ':')
        return std::nullopt;
    const auto year_number = digits(text.substr(0, 4)), day_of_year = digits(text.substr(5, 3)),
               hour = digits(text.substr(9, 2)), minute = digits(text.substr(12, 2)),
               second = digits(text.substr(15, 2));
    if (!year_number || !day_of_year || !hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 59)
        return std::nullopt;
    const year in{static_cast<int>(*year_number)};
    if (*day_of_year < 1 || *day_of_year > (in.is_leap() ? 366 : 365)) return std::nullopt;
    std::int64_t microsecond = 0;
    if (text.size() > form.size()) {
        std::string fraction{text.substr(form.size() + 1)};
        if (text[form.size()] != '.' || fraction.empty()) return std::nullopt;
        fraction.resize(fraction_digits_max, '0');
        const auto read = digits(fraction);
        if (!read) return std::nullopt;
        microsecond = *read;
    }
    const auto since =
        sys_days{in / January / 1} + days{*day_of_year - 1} - (sys_days{year{2000} / January / 1} + hours{12});
    return Ert{microseconds{since}.count() + ((*hour * 60 + *minute) * 60 + *second) * 1'000'000 + microsecond};
}

std::optional<Scet> scet_from_day_of_year(std::string_view text) {
    const auto time = ert_from_day_of_year(text);
    return time ? std::optional{Scet{time->microseconds}} : std::nullopt;
}

std::string day_of_year_text(Scet time) {
    return text(time.microseconds);
}

std::string day_of_year_text(Ert time) {
    return text(time.microseconds);
}

}  // namespace aeolis
