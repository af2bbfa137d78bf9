// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "telemetry/packet_source.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::server {

/// The format of a packet stream, as far as the user gives it.
struct PacketStreamFormat {
    std::string name = "packets";             ///< packets, tm, aos, cadu or pltu
    std::size_t skip = 0;                     ///< octets before each packet or bare frame
    std::optional<std::size_t> frame_octets;  ///< none: found by trying
};

/// Makes the packet source for a stream, from its format and its first octets. Fails on an unknown format, or when
/// `beginning` does not reveal the frame length.
Result<telemetry::PacketSource> packet_source(const PacketStreamFormat& format,
                                              std::span<const std::uint8_t> beginning);

/// Whether packet_source() uses the beginning at all.
bool needs_beginning(const PacketStreamFormat& format);

}  // namespace aeolis::server
