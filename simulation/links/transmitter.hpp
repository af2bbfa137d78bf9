// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// A radio's transmitter: octets wait in it and leave at the link's rate, in order.
///
/// Memory   our assumption: 64 KiB of waiting octets; what finds no room is lost
class Transmitter {
  public:
    explicit Transmitter(double rate_bps) : rate_bps_(rate_bps) {}

    /// Takes octets at the start of a cycle; returns how many found no room.
    std::size_t offer(std::span<const std::uint8_t> octets);
    bool idle() const { return waiting_.empty(); }
    /// Runs one cycle of 1/64 s; returns the octets that leave, valid until the next call.
    std::span<const std::uint8_t> cycle();

  private:
    double rate_bps_;
    std::vector<std::uint8_t> waiting_, left_;
    double credit_octets_ = 0.0;
};

}  // namespace aeolis::simulation
