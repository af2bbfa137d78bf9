// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace aeolis {

/// Ephemeris time [s]: TDB since 2000-01-01T12:00:00 TDB, by which SPICE and trajectories of the field count.
/// A double keeps it to 0.1 µs in this century.
struct EphemerisTime {
    double seconds = 0.0;
    constexpr auto operator<=>(const EphemerisTime&) const = default;
};
constexpr double operator-(EphemerisTime a, EphemerisTime b) {
    return a.seconds - b.seconds;
}
constexpr EphemerisTime operator+(EphemerisTime t, double seconds) {
    return {t.seconds + seconds};
}

/// TAI − UTC [s] at an instant of UTC; none before 1972. Source: IERS Bulletin C 64, leap seconds to 2017-01-01.
std::optional<int> leap_seconds_at(Scet utc);

/// Whole microseconds of UTC to TDB and back. Before 1972 as at its start. TDB − TT by its annual term, to 30 µs
/// [naif-time].
EphemerisTime ephemeris_time_of(Scet utc);
Scet utc_of(EphemerisTime time);

/// Time systems in which files of the field write instants.
enum class TimeSystem : std::uint8_t { utc, tai, tt, tdb, gps };
std::optional<TimeSystem> time_system_named(std::string_view name);  ///< "UTC" … "GPS", in capitals
std::string_view name_of(TimeSystem system);

/// Reads a calendar or day-of-year instant of that system. None for any other text, or a day that does not exist.
std::optional<EphemerisTime> ephemeris_time_from_text(std::string_view text, TimeSystem system);
/// Calendar form with microseconds: 2012-08-06T05:10:47.400000.
std::string calendar_text(EphemerisTime time, TimeSystem system);

}  // namespace aeolis
