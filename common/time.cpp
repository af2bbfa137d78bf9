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

/// Takes exactly `digits` decimal digits from the front.
bool take_number(std::string_view& rest, std::size_t digits, int& value) {
    if (rest.size() < digits) return false;
    value = 0;
    for (const char c : rest.substr(0, digits)) {
        if (c < '0' || c > '9') return false;
        value = value * 10 + (c - '0');
    }
    rest.remove_prefix(digits);
    return true;
}

bool take(std::string_view& rest, std::string_view expected) {
    if (!rest.starts_with(expected)) return false;
    rest.remove_prefix(expected.size());
    return true;
}

/// A day of the year, or a month and a day, up to the T.
std::optional<std::chrono::sys_days> take_date(std::string_view& rest) {
    using namespace std::chrono;
    int year_number = 0, day_number = 0, month_number = 0;
    if (!take_number(rest, 4, year_number) || !take(rest, "-")) return std::nullopt;
    const year in{year_number};
    if (rest.find('T') == 3) {
        if (!take_number(rest, 3, day_number)) return std::nullopt;
        if (day_number < 1 || day_number > (in.is_leap() ? 366 : 365)) return std::nullopt;
        return sys_days{in / January / 1} + days{day_number - 1};
    }
    if (!take_number(rest, 2, month_number) || !take(rest, "-") || !take_number(rest, 2, day_number))
        return std::nullopt;
    const year_month_day date{in, month{static_cast<unsigned>(month_number)}, day{static_cast<unsigned>(day_number)}};
    return date.ok() ? std::optional{sys_days{date}} : std::nullopt;
}

/// ".4": microseconds; 0 when there is no fraction.
std::optional<std::int64_t> take_fraction(std::string_view& rest) {
    if (!take(rest, ".")) return 0;
    std::int64_t microseconds = 0, unit = 100'000;
    std::size_t digits = 0;
    for (; digits < rest.size() && rest[digits] >= '0' && rest[digits] <= '9'; ++digits) {
        microseconds += (rest[digits] - '0') * unit;
        unit /= 10;
    }
    constexpr std::size_t digits_max = 6;
    if (digits == 0 || digits > digits_max) return std::nullopt;
    rest.remove_prefix(digits);
    return microseconds;
}

/// "Z", "+02:00" or nothing: the seconds by which the text is ahead of UTC.
std::optional<int> take_offset(std::string_view& rest) {
    if (rest.empty() || take(rest, "Z")) return 0;
    const bool behind = take(rest, "-");
    int hours = 0, minutes = 0;
    if ((!behind && !take(rest, "+")) || !take_number(rest, 2, hours) || !take(rest, ":") ||
        !take_number(rest, 2, minutes) || hours > 23 || minutes > 59)
        return std::nullopt;
    const int seconds = (hours * 60 + minutes) * 60;
    return behind ? -seconds : seconds;
}

}  // namespace

std::optional<Scet> scet_from_text(std::string_view text) {
    using namespace std::chrono;
    const auto date = take_date(text);
    int hour = 0, minute = 0, second = 0;
    if (!date || !take(text, "T") || !take_number(text, 2, hour) || !take(text, ":") || !take_number(text, 2, minute) ||
        !take(text, ":") || !take_number(text, 2, second) || hour > 23 || minute > 59 || second > 59)
        return std::nullopt;
    const auto fraction = take_fraction(text);
    if (!fraction) return std::nullopt;
    const auto ahead_s = take_offset(text);
    if (!ahead_s || !text.empty()) return std::nullopt;
    const auto since = *date - (sys_days{year{2000} / January / 1} + hours{12});
    return Scet{microseconds{since}.count() + ((hour * 60LL + minute) * 60 + second - *ahead_s) * 1'000'000 +
                *fraction};
}

std::optional<Ert> ert_from_text(std::string_view text) {
    const auto time = scet_from_text(text);
    return time ? std::optional{Ert{time->microseconds}} : std::nullopt;
}

std::optional<double> seconds_from_entry(std::string_view text) {
    if (!take(text, "E")) return std::nullopt;
    const bool before = take(text, "-") || take(text, "\u2212");
    if (!before && !take(text, "+")) return std::nullopt;
    double whole_s = 0.0;
    for (int parts = 1;; ++parts) {
        std::size_t digits = 0;
        while (digits < text.size() && text[digits] >= '0' && text[digits] <= '9') ++digits;
        constexpr std::size_t digits_max = 7;  // of seconds: longer than any flight
        int value = 0;
        // After a colon there are minutes or seconds, of two digits.
        if (digits == 0 || digits > digits_max || (parts > 1 && (digits != 2 || text[0] > '5'))) return std::nullopt;
        take_number(text, digits, value);
        whole_s = whole_s * 60.0 + value;
        if (parts == 3 || !take(text, ":")) break;
    }
    const auto fraction = take_fraction(text);
    if (!fraction || !text.empty()) return std::nullopt;
    const double seconds = whole_s + static_cast<double>(*fraction) * 1.0e-6;
    return before ? -seconds : seconds;
}

std::string day_of_year_text(Scet time) {
    return text(time.microseconds);
}

std::string day_of_year_text(Ert time) {
    return text(time.microseconds);
}

}  // namespace aeolis
