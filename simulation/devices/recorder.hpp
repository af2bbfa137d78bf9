// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// Non-volatile memory of the vehicle: whole packets, append-only.
///
/// 512 MiB (our assumption: a week of late cruise is recorded in half of it); packets that do not fit are refused whole
/// and counted. A fork of the landing has its own copy.
class Recorder {
  public:
    static constexpr std::size_t capacity_octets = std::size_t{512} << 20;

    explicit Recorder(std::size_t capacity = capacity_octets) : capacity_octets_(capacity) {}

    /// Returns false and keeps nothing when the memory is full.
    bool append(std::span<const std::uint8_t> packets);
    /// What is kept: all of it, or since forget() the latest.
    std::span<const std::uint8_t> octets() const { return octets_; }
    std::size_t used_octets() const { return forgotten_octets_ + octets_.size(); }
    /// Drops what is kept. It still counts as used.
    void forget();
    std::uint64_t refused_octets() const { return refused_octets_; }

  private:
    std::size_t capacity_octets_;
    std::vector<std::uint8_t> octets_;
    std::size_t forgotten_octets_ = 0;
    std::uint64_t refused_octets_ = 0;
};

/// Takes the first whole packet off `octets`; empty when there is none or the octets are not a packet.
std::span<const std::uint8_t> take_packet(std::span<const std::uint8_t>& octets);

}  // namespace aeolis::simulation
