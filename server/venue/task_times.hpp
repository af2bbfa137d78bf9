// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/venue/flight_names.hpp"

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

namespace aeolis::server {

/// How long something took, over many times: exact least, mean and worst; the 99.9 % within a tenth of itself.
class Durations {
  public:
    void add(std::uint64_t ns);

    std::uint64_t count() const { return count_; }
    double least_us() const { return count_ == 0 ? 0.0 : static_cast<double>(least_ns_) * 1.0e-3; }
    double mean_us() const;
    double worst_us() const { return static_cast<double>(worst_ns_) * 1.0e-3; }
    /// At most so long in 999 of 1000 cases.
    double p999_us() const;

  private:
    // Eight bins to each doubling, from 2^6 ns on: the width of a bin is 9 % of its value.
    static constexpr std::size_t bins = 8 * 30;
    static std::size_t bin_of(std::uint64_t ns);

    std::array<std::uint32_t, bins> counts_{};
    std::uint64_t count_ = 0, sum_ns_ = 0, least_ns_ = UINT64_MAX, worst_ns_ = 0;
};

/// Processor time of one task: of all that it did in a cycle, over the cycles in which it ran, however often it was
/// woken in one; and of each message by its type. R8
struct TaskTimes {
    flight::ModuleId module{};
    Durations cycle;
    std::array<Durations, message_type_count> by_message;
    std::size_t stack_used_octets = 0;  ///< deepest, from a painted stack
};

/// What a threaded executive has measured.
struct MeasuredTimes {
    std::vector<TaskTimes> tasks;  ///< in order of priority
    Durations all_tasks;           ///< of all of them together, in each cycle
};

/// R8: messages of one task should cost about the same. The largest mean over message types against their mean.
double unevenness(const TaskTimes& times);

}  // namespace aeolis::server
