// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "telemetry/packet_source.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::server {

/// The form of a packet stream, as far as the user gives it.
struct DownlinkForm {
    std::string name = "packets";             ///< packets, tm, aos, cadu or pltu
    std::size_t skip = 0;                     ///< octets before each packet or bare frame
    std::optional<std::size_t> frame_octets;  ///< none: found by trying
};

/// Makes the packet source for a stream, from its form and its first octets. Fails on an unknown format, or when
/// `beginning` does not reveal the frame length.
Result<telemetry::PacketSource> packet_source(const DownlinkForm& format, std::span<const std::uint8_t> beginning);

/// Whether packet_source() uses the beginning at all.
bool needs_beginning(const DownlinkForm& format);

}  // namespace aeolis::server
