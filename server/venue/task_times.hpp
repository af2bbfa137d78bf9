// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/venue/flight_names.hpp"

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

namespace aeolis::server {

/// Statistics of a duration: exact minimum, mean and maximum; the 99.9 % percentile to within a tenth of its value.
class Durations {
  public:
    void add(std::uint64_t ns);

    std::uint64_t count() const { return count_; }
    double least_us() const { return count_ == 0 ? 0.0 : static_cast<double>(least_ns_) * 1.0e-3; }
    double mean_us() const;
    double worst_us() const { return static_cast<double>(worst_ns_) * 1.0e-3; }
    /// The duration not exceeded in 999 of 1000 cases.
    double p999_us() const;

  private:
    // Eight bins per doubling, from 2^6 ns on: a bin's width is 9 % of its value.
    static constexpr std::size_t bins = 8 * 30;
    static std::size_t bin_of(std::uint64_t ns);

    std::array<std::uint32_t, bins> counts_{};
    std::uint64_t count_ = 0, sum_ns_ = 0, least_ns_ = UINT64_MAX, worst_ns_ = 0;
};

/// Processor time of one task: per cycle in which it ran, however often it was woken in it; and per message, by type.
/// R8
struct TaskTimes {
    flight::ModuleId module{};
    Durations cycle;
    std::array<Durations, message_type_count> by_message;
    std::size_t stack_used_octets = 0;  ///< deepest use, from a painted stack
};

/// The measurements of a threaded executive.
struct MeasuredTimes {
    std::vector<TaskTimes> tasks;  ///< in order of priority
    Durations all_tasks;           ///< all tasks together, per cycle
};

/// The largest mean over message types divided by their mean. R8: messages of one task should cost about the same.
double unevenness(const TaskTimes& times);

}  // namespace aeolis::server
