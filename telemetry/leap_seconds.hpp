// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/text_kernel.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// An instant of UTC, to the microsecond.
struct UtcInstant {
    std::int64_t microseconds =
        0;  ///< since 2000-01-01T12:00:00 UTC, without leap seconds; during one: as the second before
    bool leap_second = false;  ///< within second 60
    constexpr bool operator==(const UtcInstant&) const = default;

    /// Day-of-year form with milliseconds: 2012-219T05:17:57.123, 2016-366T23:59:60.500.
    std::string text() const;
};

/// Leap seconds and the difference of TDB and TT, from a leap-second kernel (DELTET/…).
///
/// Scales   TT and TDB in seconds since 2000-01-01T12:00:00 of that scale; TAI = TT - 32.184 s by the kernel
/// Range    from the kernel's first leap second (1972) on; none before. No leap second is assumed after the last.
/// Accuracy 30 us in TDB - TT: one periodic term, as in NAIF's own library
/// Source   [naif-time]
class LeapSeconds {
  public:
    static Result<LeapSeconds> read(const TextKernel& kernel);

    double tdb_minus_tt(double tdb_s) const;
    std::optional<UtcInstant> utc_of_tai(double tai_s) const;
    std::optional<UtcInstant> utc_of_tt(double tt_s) const { return utc_of_tai(tt_s - tt_minus_tai_s_); }
    std::optional<UtcInstant> utc_of_tdb(double tdb_s) const { return utc_of_tt(tdb_s - tdb_minus_tt(tdb_s)); }
    /// The TAI of an instant, also within a leap second; none before the range.
    std::optional<double> tai_of_utc(const UtcInstant& utc) const;
    /// The TDB of an instant, also within a leap second; none before the range.
    std::optional<double> tdb_of_utc(const UtcInstant& utc) const;

  private:
    struct Step {
        double utc_s = 0.0;  ///< valid from this UTC on, by the calendar
        double tai_minus_utc_s = 0.0;
    };
    double tt_minus_tai_s_ = 0.0, amplitude_s_ = 0.0, eccentricity_ = 0.0;
    double anomaly_ = 0.0, anomaly_rate_ = 0.0;  ///< [rad], [rad/s]
    std::vector<Step> steps_;
};

}  // namespace aeolis::telemetry
