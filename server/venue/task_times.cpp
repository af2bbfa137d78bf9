// SPDX-License-Identifier: Apache-2.0
#include "server/venue/task_times.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace aeolis::server {
namespace {

constexpr int first_doubling = 6;

}  // namespace

std::size_t Durations::bin_of(std::uint64_t ns) {
    if (ns < (1U << first_doubling)) return 0;
    const int doubling = std::bit_width(ns) - 1;
    const std::uint64_t eighth = (ns >> (doubling - 3)) & 7U;
    return std::min<std::size_t>(static_cast<std::size_t>(doubling - first_doubling) * 8 + eighth, bins - 1);
}

void Durations::add(std::uint64_t ns) {
    ++counts_[bin_of(ns)];
    ++count_;
    sum_ns_ += ns;
    least_ns_ = std::min(least_ns_, ns);
    worst_ns_ = std::max(worst_ns_, ns);
}

double Durations::mean_us() const {
    return count_ == 0 ? 0.0 : static_cast<double>(sum_ns_) / static_cast<double>(count_) * 1.0e-3;
}

double Durations::p999_us() const {
    const auto beyond = count_ / 1000;
    std::uint64_t seen = 0;
    for (std::size_t bin = bins; bin-- > 0;) {
        seen += counts_[bin];
        if (seen <= beyond) continue;
        // The bin's upper end, but at most the exact maximum.
        const auto doubling = static_cast<int>(bin / 8) + first_doubling;
        const double upper_ns = std::ldexp(1.0 + (static_cast<double>(bin % 8) + 1.0) / 8.0, doubling);
        return std::min(upper_ns, static_cast<double>(worst_ns_)) * 1.0e-3;
    }
    return 0.0;
}

double unevenness(const TaskTimes& times) {
    double largest_us = 0.0, sum_us = 0.0;
    int types = 0;
    for (const Durations& of_type : times.by_message) {
        if (of_type.count() == 0) continue;
        largest_us = std::max(largest_us, of_type.mean_us());
        sum_us += of_type.mean_us();
        ++types;
    }
    return types == 0 || sum_us == 0.0 ? 1.0 : largest_us / (sum_us / types);
}

}  // namespace aeolis::server
