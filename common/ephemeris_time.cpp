// SPDX-License-Identifier: Apache-2.0
#include "common/ephemeris_time.hpp"

#include "common/calendar.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace aeolis {
namespace {

constexpr double us_per_s = 1.0e6;
constexpr std::int64_t day_us = 86'400'000'000;
constexpr double tt_less_tai_s = 32.184;
constexpr double tai_less_gps_s = 19.0;

/// The day from whose beginning TAI − UTC has this value. Ten seconds at first, one more with each.
struct LeapDay {
    int year;
    unsigned month;
};
constexpr std::array leap_days{LeapDay{1972, 1}, LeapDay{1972, 7}, LeapDay{1973, 1}, LeapDay{1974, 1}, LeapDay{1975, 1},
                               LeapDay{1976, 1}, LeapDay{1977, 1}, LeapDay{1978, 1}, LeapDay{1979, 1}, LeapDay{1980, 1},
                               LeapDay{1981, 7}, LeapDay{1982, 7}, LeapDay{1983, 7}, LeapDay{1985, 7}, LeapDay{1988, 1},
                               LeapDay{1990, 1}, LeapDay{1991, 1}, LeapDay{1992, 7}, LeapDay{1993, 7}, LeapDay{1994, 7},
                               LeapDay{1996, 1}, LeapDay{1997, 7}, LeapDay{1999, 1}, LeapDay{2006, 1}, LeapDay{2009, 1},
                               LeapDay{2012, 7}, LeapDay{2015, 7}, LeapDay{2017, 1}};
constexpr int first_leap_seconds = 10;

constexpr std::int64_t start_us(LeapDay day) {
    return *days_since_2000(day.year, day.month, 1) * day_us - day_us / 2;  // counted from noon
}

/// TDB − TT [s], by seconds of either since J2000.
double tdb_less_tt_s(double seconds) {
    constexpr double amplitude_s = 1.657e-3, eccentricity = 1.671e-2;  // of Earth's orbit
    constexpr double anomaly_rad = 6.239996, anomaly_rate_radps = 1.99096871e-7;
    const double mean = anomaly_rad + anomaly_rate_radps * seconds;
    return amplitude_s * std::sin(mean + eccentricity * std::sin(mean));
}

double tt_of(EphemerisTime time) {
    return time.seconds - tdb_less_tt_s(time.seconds);
}
EphemerisTime from_tt(double tt_s) {
    return {tt_s + tdb_less_tt_s(tt_s)};
}
int leap_seconds_or_first(Scet utc) {
    return leap_seconds_at(utc).value_or(first_leap_seconds);
}

}  // namespace

std::optional<int> leap_seconds_at(Scet utc) {
    int seconds = first_leap_seconds - 1;
    for (const LeapDay& day : leap_days) seconds += utc.microseconds >= start_us(day) ? 1 : 0;
    if (seconds < first_leap_seconds) return std::nullopt;
    return seconds;
}

EphemerisTime ephemeris_time_of(Scet utc) {
    return from_tt(static_cast<double>(utc.microseconds) / us_per_s + leap_seconds_or_first(utc) + tt_less_tai_s);
}

Scet utc_of(EphemerisTime time) {
    const double tai_s = tt_of(time) - tt_less_tai_s;
    const auto less = [&](int leap_s) { return Scet{std::llround((tai_s - leap_s) * us_per_s)}; };
    // Leap seconds at an instant that is late by as many seconds may be one too many: then the one before holds.
    const int late = leap_seconds_or_first(less(0));
    const Scet utc = less(late);
    return leap_seconds_or_first(utc) == late ? utc : less(leap_seconds_or_first(utc));
}

std::optional<TimeSystem> time_system_named(std::string_view name) {
    for (const auto system : {TimeSystem::utc, TimeSystem::tai, TimeSystem::tt, TimeSystem::tdb, TimeSystem::gps})
        if (name == name_of(system)) return system;
    return std::nullopt;
}

std::string_view name_of(TimeSystem system) {
    switch (system) {
    case TimeSystem::utc: return "UTC";
    case TimeSystem::tai: return "TAI";
    case TimeSystem::tt: return "TT";
    case TimeSystem::tdb: return "TDB";
    case TimeSystem::gps: return "GPS";
    }
    return "";
}

std::optional<EphemerisTime> ephemeris_time_from_text(std::string_view text, TimeSystem system) {
    const auto read = scet_from_text(text);
    if (!read) return std::nullopt;
    const double seconds = static_cast<double>(read->microseconds) / us_per_s;
    switch (system) {
    case TimeSystem::utc: return ephemeris_time_of(*read);
    case TimeSystem::tai: return from_tt(seconds + tt_less_tai_s);
    case TimeSystem::tt: return from_tt(seconds);
    case TimeSystem::tdb: return EphemerisTime{seconds};
    case TimeSystem::gps: return from_tt(seconds + tai_less_gps_s + tt_less_tai_s);
    }
    return std::nullopt;
}

std::string calendar_text(EphemerisTime time, TimeSystem system) {
    Scet shown;
    const auto rounded = [](double seconds) { return Scet{std::llround(seconds * us_per_s)}; };
    switch (system) {
    case TimeSystem::utc: shown = utc_of(time); break;
    case TimeSystem::tai: shown = rounded(tt_of(time) - tt_less_tai_s); break;
    case TimeSystem::tt: shown = rounded(tt_of(time)); break;
    case TimeSystem::tdb: shown = rounded(time.seconds); break;
    case TimeSystem::gps: shown = rounded(tt_of(time) - tt_less_tai_s - tai_less_gps_s); break;
    }
    const std::int64_t from_midnight_us = shown.microseconds + day_us / 2;
    std::int64_t day = from_midnight_us / day_us, within_us = from_midnight_us % day_us;
    if (within_us < 0) within_us += day_us, --day;
    // The calendar backwards, from a first guess of the year.
    int year = 2000 + static_cast<int>(std::floor(static_cast<double>(day) / 365.2425));
    while (*days_since_2000(year, 1, 1) > day) --year;
    while (*days_since_2000(year + 1, 1, 1) <= day) ++year;
    unsigned month = 12;
    while (*days_since_2000(year, month, 1) > day) --month;
    const auto of_month = static_cast<int>(day - *days_since_2000(year, month, 1)) + 1;
    constexpr std::int64_t minute_us = 60'000'000, hour_us = 60 * minute_us;
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%04d-%02u-%02dT%02d:%02d:%02d.%06d", year, month, of_month,
                  static_cast<int>(within_us / hour_us), static_cast<int>(within_us % hour_us / minute_us),
                  static_cast<int>(within_us % minute_us / 1'000'000), static_cast<int>(within_us % 1'000'000));
    return text.data();
}

}  // namespace aeolis
