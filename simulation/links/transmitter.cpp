// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/transmitter.hpp"

#include "common/time.hpp"

#include <algorithm>

namespace aeolis::simulation {
namespace {

constexpr std::size_t waiting_octets_max = 65536;  // our assumption

}  // namespace

std::size_t Transmitter::offer(std::span<const std::uint8_t> octets) {
    const std::size_t taken = std::min(octets.size(), waiting_octets_max - waiting_.size());
    waiting_.insert(waiting_.end(), octets.begin(), octets.begin() + static_cast<std::ptrdiff_t>(taken));
    return octets.size() - taken;
}

std::span<const std::uint8_t> Transmitter::cycle() {
    credit_octets_ += rate_bps_ / 8.0 * seconds_per_tick;
    const auto leaving = static_cast<std::ptrdiff_t>(std::min(credit_octets_, static_cast<double>(waiting_.size())));
    // An idle transmitter saves nothing up.
    credit_octets_ =
        static_cast<std::size_t>(leaving) == waiting_.size() ? 0.0 : credit_octets_ - static_cast<double>(leaving);
    left_.assign(waiting_.begin(), waiting_.begin() + leaving);
    waiting_.erase(waiting_.begin(), waiting_.begin() + leaving);
    return left_;
}

}  // namespace aeolis::simulation
