// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// Non-volatile memory of the vehicle: whole packets, append-only.
///
/// 64 MiB (our assumption); packets that do not fit are refused whole and counted. A fork of the landing has its own
/// copy.
class Recorder {
  public:
    static constexpr std::size_t capacity_octets = std::size_t{64} << 20;

    /// Returns false and keeps nothing when the memory is full.
    bool append(std::span<const std::uint8_t> packets);
    std::span<const std::uint8_t> octets() const { return octets_; }
    std::uint64_t refused_octets() const { return refused_octets_; }

  private:
    std::vector<std::uint8_t> octets_;
    std::uint64_t refused_octets_ = 0;
};

/// Takes the first whole packet off `octets`; empty when there is none or the octets are no packet.
std::span<const std::uint8_t> take_packet(std::span<const std::uint8_t>& octets);

}  // namespace aeolis::simulation
