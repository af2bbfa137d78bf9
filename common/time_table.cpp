// SPDX-License-Identifier: Apache-2.0
#include "common/time_table.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis {

Result<TimeTable> TimeTable::make(std::vector<double> time_s, std::vector<double> value) {
    if (time_s.size() != value.size()) return Error{"as many times as values are needed"};
    for (std::size_t i = 0; i < time_s.size(); ++i) {
        if (!std::isfinite(time_s[i]) || !std::isfinite(value[i]))
            return Error{"row " + std::to_string(i + 1) + " has a number that is not finite"};
        if (i > 0 && time_s[i] <= time_s[i - 1])
            return Error{"row " + std::to_string(i + 1) + " is not later than the one before"};
    }
    TimeTable table;
    table.time_s_ = std::move(time_s);
    table.value_ = std::move(value);
    return table;
}

double TimeTable::slope(std::size_t row) const {
    const std::size_t before = row == 0 ? 0 : row - 1;
    const std::size_t after = std::min(row + 1, time_s_.size() - 1);
    if (after == before) return 0.0;
    const auto chord = [&](std::size_t from, std::size_t to) {
        return (value_[to] - value_[from]) / (time_s_[to] - time_s_[from]);
    };
    const double mean = chord(before, after);
    if (before == row || after == row) return mean;
    // Within three times both chords the cubic stays between the rows.
    const double left = chord(before, row), right = chord(row, after);
    if (left * right <= 0.0) return 0.0;
    return std::copysign(std::min({std::abs(mean), 3.0 * std::abs(left), 3.0 * std::abs(right)}), mean);
}

TimeTable::Piece TimeTable::piece_at(double time_s) const {
    const auto after = std::upper_bound(time_s_.begin(), time_s_.end(), time_s);
    const auto i = static_cast<std::size_t>(after - time_s_.begin());
    return {time_s_[i - 1], time_s_[i] - time_s_[i - 1], value_[i - 1], value_[i], slope(i - 1), slope(i)};
}

double TimeTable::at(double time_s) const {
    if (time_s_.empty()) return 0.0;
    if (time_s < time_s_.front()) return value_.front();
    if (time_s >= time_s_.back()) return value_.back();
    const Piece p = piece_at(time_s);
    const double x = (time_s - p.start_s) / p.length_s;
    const double y = 1.0 - x;
    return p.from * (1.0 + 2.0 * x) * y * y + p.to * x * x * (3.0 - 2.0 * x) +
           p.length_s * x * y * (p.slope_from * y - p.slope_to * x);
}

double TimeTable::rate_at(double time_s) const {
    if (time_s_.empty() || time_s < time_s_.front() || time_s >= time_s_.back()) return 0.0;
    const Piece p = piece_at(time_s);
    const double x = (time_s - p.start_s) / p.length_s;
    return 6.0 * x * (1.0 - x) * (p.to - p.from) / p.length_s + p.slope_from * (1.0 - x) * (1.0 - 3.0 * x) +
           p.slope_to * x * (3.0 * x - 2.0);
}

}  // namespace aeolis
