// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace aeolis {

inline constexpr double seconds_per_tick = 1.0 / 64.0;

/// Spacecraft clock [s], a multiple of 1/64 s: arithmetic with offsets of such multiples is exact. R21
struct Sclk {
    double seconds = 0.0;

    static constexpr Sclk from_ticks(std::int64_t ticks) { return {static_cast<double>(ticks) * seconds_per_tick}; }
    constexpr std::int64_t ticks() const { return static_cast<std::int64_t>(seconds * 64.0); }
    constexpr auto operator<=>(const Sclk&) const = default;
};
constexpr double operator-(Sclk a, Sclk b) {
    return a.seconds - b.seconds;
}
constexpr Sclk operator+(Sclk t, double offset_s) {
    return {t.seconds + offset_s};
}
constexpr Sclk operator-(Sclk t, double offset_s) {
    return {t.seconds - offset_s};
}

/// UTC at the spacecraft: microseconds since 2000-01-01T12:00:00 UTC, without leap seconds as in POSIX.
struct Scet {
    std::int64_t microseconds = 0;
    constexpr auto operator<=>(const Scet&) const = default;
};
/// UTC at the receiving station on Earth, counted in the same way.
struct Ert {
    std::int64_t microseconds = 0;
    constexpr auto operator<=>(const Ert&) const = default;
};

/// Day-of-year text with milliseconds: 2012-219T05:10:47.400.
std::string day_of_year_text(Scet time);
std::string day_of_year_text(Ert time);
/// Reads that form, or the calendar's: 2012-08-06T05:10:47.4. Optional: a fraction of a second, six digits at most, and
/// a Z or an offset, +02:00, at the end. None for any other text, a leap second, or a day that does not exist.
std::optional<Scet> scet_from_text(std::string_view text);
std::optional<Ert> ert_from_text(std::string_view text);
/// Reads seconds from entry: E+4:58, E-1:02:03.5, E+298.5, with a hyphen or a minus sign. None for any other text.
std::optional<double> seconds_from_entry(std::string_view text);

/// Correlation of SCLK and SCET: one instant in both, and the rate of UTC against the onboard clock.
/// From a row of the dictionary's clock_correlation.csv; version 0 for a clock that only its scenario defines.
struct ClockCorrelation {
    Sclk sclk;
    Scet scet;
    double rate = 1.0;              ///< seconds of UTC per second of SCLK; 1 + drift
    std::int32_t leap_seconds = 0;  ///< TAI - UTC [s] at `scet`; 0: unknown
    std::uint32_t version = 0;

    constexpr Scet scet_of(Sclk t) const {
        return {scet.microseconds + static_cast<std::int64_t>((t - sclk) * rate * 1.0e6)};
    }
    /// SCLK at `t`, not rounded to a tick.
    constexpr Sclk sclk_of(Scet t) const {
        return sclk + static_cast<double>(t.microseconds - scet.microseconds) * 1.0e-6 / rate;
    }
};

/// `t` truncated to the ticks of a clock of `hz`, as `clk_1_hz` … `clk_64_hz` return it.
/// `hz` is a power of two up to 64. R21
constexpr Sclk at_resolution(Sclk t, std::int64_t hz) {
    const std::int64_t ticks_per_step = 64 / hz;
    const std::int64_t ticks = t.ticks();
    const std::int64_t remainder = ((ticks % ticks_per_step) + ticks_per_step) % ticks_per_step;
    return Sclk::from_ticks(ticks - remainder);
}

constexpr bool is_multiple_of_tick(double seconds) {
    const double ticks = seconds * 64.0;
    return ticks >= -9.0e15 && ticks <= 9.0e15 && ticks == static_cast<double>(static_cast<std::int64_t>(ticks));
}

/// An offset in seconds, or undefined. R13
using MaybeOffset = std::optional<double>;

/// A time or "undefined", which propagates through arithmetic and makes every comparison false. R13
class MaybeTime {
  public:
    constexpr MaybeTime() = default;
    constexpr MaybeTime(Sclk time) : time_(time) {}

    constexpr bool defined() const { return time_.has_value(); }
    constexpr const std::optional<Sclk>& get() const { return time_; }

    friend constexpr MaybeTime operator+(MaybeTime t, MaybeOffset offset_s) {
        if (!t.time_ || !offset_s) return {};
        return *t.time_ + *offset_s;
    }
    friend constexpr bool operator>=(Sclk now, MaybeTime t) { return t.time_ && now >= *t.time_; }

  private:
    std::optional<Sclk> time_;
};

}  // namespace aeolis
