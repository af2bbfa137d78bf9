// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace aeolis::telemetry {

/// Splits contiguous whole space packets: a recording, the radiated octets of a cycle.
///
/// In       any octets; not copied, they must outlive this      Out   each packet's octets, CRC not yet checked
/// Faults   ends at an invalid primary header or a truncated packet: there is no mark to find the next packet by. The
///          rest is counted, never skipped in silence
class PacketStream {
  public:
    explicit PacketStream(std::span<const std::uint8_t> octets) : rest_(octets) {}

    /// The next packet; none at the end, or where reading cannot continue.
    std::optional<std::span<const std::uint8_t>> next();

    std::size_t packets() const { return packets_; }

    /// Octets left after next() returned none; 0 when all were read.
    std::size_t unreadable_octets() const { return rest_.size(); }

  private:
    std::span<const std::uint8_t> rest_;
    std::size_t packets_ = 0;
};

}  // namespace aeolis::telemetry
