// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// Non-volatile memory of the vehicle: whole packets, one after another, only ever appended.
///
/// 64 MiB (ours); what does not fit is refused whole and counted. A fork of the landing has a copy of its own.
class Recorder {
  public:
    static constexpr std::size_t capacity_octets = std::size_t{64} << 20;

    /// False, and nothing kept, when the memory is full.
    bool append(std::span<const std::uint8_t> packets);
    std::span<const std::uint8_t> octets() const { return octets_; }
    std::uint64_t refused_octets() const { return refused_octets_; }

  private:
    std::vector<std::uint8_t> octets_;
    std::uint64_t refused_octets_ = 0;
};

/// Takes the first whole packet off `octets`; empty when there is none or what stands there is no packet.
std::span<const std::uint8_t> take_packet(std::span<const std::uint8_t>& octets);

}  // namespace aeolis::simulation
