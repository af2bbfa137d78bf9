// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace aeolis {

/// A quantity over time, interpolated smoothly between rows.
///
/// The interpolation is cubic Hermite, with slopes from the chords of neighbouring rows, so that value and rate are
/// continuous. The slopes are limited so that no value lies beyond the two rows around it. Before the first and after
/// the last row the value is held. An empty table is zero everywhere. Source: [fritsch-carlson-1980] for the limit.
class TimeTable {
  public:
    TimeTable() = default;
    /// Fails when times do not increase, a number is not finite, or the lengths differ.
    static Result<TimeTable> make(std::vector<double> time_s, std::vector<double> value);

    double at(double time_s) const;
    double rate_at(double time_s) const;  ///< per second

    bool empty() const { return time_s_.empty(); }
    double first_s() const { return time_s_.empty() ? 0.0 : time_s_.front(); }
    double last_s() const { return time_s_.empty() ? 0.0 : time_s_.back(); }

  private:
    struct Piece {
        double start_s, length_s, from, to, slope_from, slope_to;
    };
    Piece piece_at(double time_s) const;
    double slope(std::size_t row) const;

    std::vector<double> time_s_, value_;
};

}  // namespace aeolis
