// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/scenario_text.hpp"

#include <charconv>
#include <chrono>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

/// Takes exactly `digits` decimal digits from the front.
bool take_number(std::string_view& rest, std::size_t digits, int& value) {
    if (rest.size() < digits) return false;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + digits, value);
    if (error != std::errc{} || end != rest.data() + digits || value < 0) return false;
    rest.remove_prefix(digits);
    return true;
}

bool take(std::string_view& rest, char expected) {
    if (rest.empty() || rest.front() != expected) return false;
    rest.remove_prefix(1);
    return true;
}

/// Parses; the caller words the Error.
bool parse(std::string_view rest, Scet& scet) {
    using namespace std::chrono;
    int year_number = 0;
    if (!take_number(rest, 4, year_number) || !take(rest, '-')) return false;
    sys_days date{};
    if (rest.find('T') == 3) {
        int day_of_year = 0;
        if (!take_number(rest, 3, day_of_year)) return false;
        const bool leap = year{year_number}.is_leap();
        if (day_of_year < 1 || day_of_year > (leap ? 366 : 365)) return false;
        date = sys_days{year{year_number} / January / 1} + days{day_of_year - 1};
    } else {
        int month_number = 0, day_number = 0;
        if (!take_number(rest, 2, month_number) || !take(rest, '-') || !take_number(rest, 2, day_number)) return false;
        const year_month_day whole{year{year_number}, month{static_cast<unsigned>(month_number)},
                                   day{static_cast<unsigned>(day_number)}};
        if (!whole.ok()) return false;
        date = sys_days{whole};
    }
    int hours_number = 0, minutes_number = 0, seconds_number = 0;
    if (!take(rest, 'T') || !take_number(rest, 2, hours_number) || !take(rest, ':') ||
        !take_number(rest, 2, minutes_number) || !take(rest, ':') || !take_number(rest, 2, seconds_number))
        return false;
    if (hours_number > 23 || minutes_number > 59 || seconds_number > 59) return false;
    std::int64_t fraction = 0;
    if (take(rest, '.')) {
        if (rest.empty() || rest.size() > 6) return false;
        std::int64_t unit = 100000;
        for (const char digit : rest) {
            if (digit < '0' || digit > '9') return false;
            fraction += (digit - '0') * unit;
            unit /= 10;
        }
    } else if (!rest.empty()) {
        return false;
    }
    const sys_days epoch_day{year{2000} / January / 1};
    const auto since_epoch =
        date - epoch_day + hours{hours_number - 12} + minutes{minutes_number} + seconds{seconds_number};
    scet.microseconds = duration_cast<microseconds>(since_epoch).count() + fraction;
    return true;
}

}  // namespace

Result<Scet> scet_from_text(std::string_view text) {
    Scet scet;
    if (!parse(text, scet))
        return Error{fmt::format("'{}' is not a UTC time like 2012-08-06T05:10:47.4 or 2012-219T05:10:47.4", text)};
    return scet;
}

}  // namespace aeolis::server
