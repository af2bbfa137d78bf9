// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/leap_seconds.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// Converts SCLK to time and back by an SCLK kernel of type 1: linear segments through measured points.
///
/// Clock    counts of its first field (mostly seconds) with their fraction, as a packet's time field reads
/// Range    within the partitions, from the first point on; the last rate is assumed to continue. None elsewhere.
/// Faults   "FILE:LINE: …" when the kernel is incomplete or wrong, or holds several spacecraft
/// Source   [naif-sclk]
class ClockKernel {
  public:
    static Result<ClockKernel> read(const TextKernel& kernel);

    /// TDB or TT, whichever the kernel uses, in seconds since 2000-01-01T12:00:00 of that scale.
    /// @param partition  from 1; none: the first whose range holds the count
    std::optional<double> parallel_time_of(double count, std::optional<std::size_t> partition = {}) const;
    /// The count and its partition at that parallel time; none in a gap between segments.
    std::optional<std::pair<double, std::size_t>> count_at(double parallel_time_s) const;

    std::optional<UtcInstant> scet_of(double count, const LeapSeconds& leaps,
                                      std::optional<std::size_t> partition = {}) const;

    const std::string& spacecraft() const { return spacecraft_; }  ///< as the kernel names it: "76" for -76
    std::size_t partitions() const { return partitions_.size(); }

  private:
    struct Partition {
        double start_ticks = 0.0, end_ticks = 0.0;
        double before_ticks = 0.0;  ///< ticks of all earlier partitions
    };
    struct Point {
        double ticks = 0.0;  ///< over all partitions
        double time_s = 0.0;
        double rate_s = 0.0;  ///< per count of the first field
    };
    Result<void> read_fields(const TextKernel& kernel);
    Result<void> read_partitions(const TextKernel& kernel);
    Result<void> read_points(const TextKernel& kernel);

    std::string spacecraft_;
    bool terrestrial_ = false;  ///< TT; false: TDB
    double ticks_per_count_ = 1.0, offset_ticks_ = 0.0;
    std::vector<Partition> partitions_;
    std::vector<Point> points_;
};

}  // namespace aeolis::telemetry
